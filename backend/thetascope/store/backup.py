"""Write a store to one file, also while a server uses it, and restore it from there.

A backup is an SQLite file, whatever the store is: `sqlite3`, verification and a server can open it.
"""

import os
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Table, Text, delete, func, insert, select

from thetascope.messages import Message
from thetascope.store.backends.sqlite import SQLite
from thetascope.store.database import Database, backend_of
from thetascope.store.errors import StoreError
from thetascope.store.record_store import has_record
from thetascope.store.tables import (
    COMPARISON_NOTES,
    LESSONS,
    OWNERS,
    PLANTS,
    RECORD_SHARES,
    RECORDS,
    RESULTS,
    RUN_FACTS,
    RUN_NOTES,
    RUNS,
    has_comparison_note,
    has_facts,
    has_note,
    has_owner,
    has_result,
    has_share,
    has_text,
    is_whole,
)
from thetascope.store.verification import Verification, verify

_WHOLE = {
    RUNS: is_whole,
    RESULTS: has_result,
    OWNERS: has_owner,
    RUN_FACTS: has_facts,
    RUN_NOTES: has_note,
    COMPARISON_NOTES: has_comparison_note,
    RECORDS: has_record,
    RECORD_SHARES: has_share,
    PLANTS: has_text,
    LESSONS: has_text,
}
_COMPANIONS = ("", "-wal", "-shm")
"""Endings of the files of an SQLite store."""


def backup(place: Path | str, file: Path, force: bool = False) -> Verification:
    """Write the store to a file, as it is at one moment, and return what the file contains.

    Raises StoreError if the file exists (unless `force`), or the store cannot be read.
    """
    if file.exists() and not force:
        raise StoreError(Message("store.backup-exists", file=str(file)))
    partial = file.with_name(file.name + ".partial")
    source = Database(place, read_only=True)
    try:
        with _explained(file):
            _remove(partial)
            os.close(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600))
            if isinstance(source.backend, SQLite):
                _copy_file(source.backend.path, partial)
            else:
                _copy_rows_to_file(source, partial)
            with opened(partial) as copy:
                found = verify(copy)
            with partial.open("rb") as written:
                os.fsync(written.fileno())
            os.replace(partial, file)
    finally:
        source.close()
        _remove(partial)
    return found


@dataclass(frozen=True)
class Restored:
    """What was restored: the backup's contents, and the file that keeps the store as it was before."""

    backup: Verification
    kept: Path | None


def restore(place: Path | str, file: Path, force: bool = False) -> Restored:
    """Replace the store by a backup of this or an earlier version.

    Raises StoreError if a server owns the store, if the backup cannot be read, and unless `force` if the store has runs
    or the backup is damaged. With `force` damaged rows are left out, and the file of the store is kept beside.
    """
    with opened(file) as source:
        found = verify(source)
        if found.defects and not force:
            raise StoreError(Message("store.backup-damaged", file=str(file), n=len(found.defects)))
        backend = backend_of(place, 10.0, False)
        if isinstance(backend, SQLite):
            return Restored(found, _restore_file(backend, source, force))
        database = Database.for_service(place, False)
        try:
            with database.writing() as connection:
                if connection.execute(select(func.count()).select_from(RUNS)).scalar_one() and not force:
                    raise StoreError(Message("store.used", path=database.place))
                for table in _WHOLE:
                    connection.execute(delete(table))
                _copy_rows(source, connection)
        finally:
            database.close()
        return Restored(found, None)


@contextmanager
def opened(file: Path) -> Iterator[Database]:
    """Open a backup for reading; one of an earlier version as an upgraded copy."""
    if not file.is_file():
        raise StoreError(Message("store.no-backup", file=str(file)))
    try:
        database = Database(file, read_only=True)
    except StoreError as error:
        if error.problem.code != "store.older":
            raise
    else:
        with closing(database):
            yield database
        return
    with tempfile.TemporaryDirectory(prefix="thetascope-") as folder:
        copy = Path(shutil.copyfile(file, Path(folder) / "runs.sqlite"))
        with closing(Database(copy)) as database:
            yield database


def _copy_file(source: Path, target: Path) -> None:
    """Copy an SQLite file that may be in use; writers are not kept waiting, since they write to the log."""
    with closing(sqlite3.connect(source)) as connection, closing(sqlite3.connect(target)) as copy:
        connection.backup(copy)
        copy.execute("PRAGMA journal_mode = DELETE")  # one file


def _copy_rows_to_file(source: Database, target: Path) -> None:
    with closing(Database(target)) as copy, copy.writing() as connection:
        _copy_rows(source, connection, all_rows=True)
    with closing(sqlite3.connect(target)) as connection:
        connection.execute("PRAGMA journal_mode = DELETE")


def _copy_rows(source: Database, target: Connection, all_rows: bool = False) -> None:
    """Copy the rows of all tables, one at a time, as they are at one moment; damaged ones only if `all_rows`."""
    with source.snapshot() as reading:
        for table, whole in _WHOLE.items():
            keys = list(table.primary_key)
            for place in reading.execute(select(*keys)).all():
                row = _row(reading, table, dict(zip(keys, place, strict=True)))
                if row is not None and (all_rows or whole(row)):
                    target.execute(insert(table), _accepted(table, row))


def _accepted(table: Table, row: Any) -> dict[str, Any]:
    """Return the values of a row that a store accepts: 0 or an empty text where damage left nothing."""
    empty = {column.name: "" if isinstance(column.type, Text) else 0 for column in table.columns if not column.nullable}
    return {name: empty.get(name) if value is None else value for name, value in row._mapping.items()}


def _row(reading: Connection, table: Table, key: dict):
    condition = [column == value for column, value in key.items()]
    return reading.execute(select(table).where(*condition)).one_or_none()


def _restore_file(backend: SQLite, source: Database, force: bool) -> Path | None:
    """Write the rows to a new file, then put it in the place of the store; return where the old one is kept."""
    path = backend.path
    with _explained(path):
        backend.prepare()
        owner = backend.own(None)
    if owner is not None:
        raise StoreError(Message("store.owned", path=str(path), owner=owner))
    try:
        used = _is_used(path)
        if used and not force:
            raise StoreError(Message("store.used", path=str(path)))
        fresh = path.with_name(path.name + ".restoring")
        _remove(fresh)
        try:
            with closing(Database(fresh)) as database, database.writing() as connection:
                _copy_rows(source, connection)
            with _explained(path):
                kept = path.with_name(path.name + ".replaced") if used else None
                _remove(path if kept is None else kept)
                if kept is not None:
                    for ending in reversed(_COMPANIONS):
                        with suppress(FileNotFoundError):
                            os.replace(f"{path}{ending}", f"{kept}{ending}")
                os.replace(fresh, path)
        finally:
            _remove(fresh)
    finally:
        backend.disown()
    return kept


def _is_used(path: Path) -> bool:
    """Return whether a file holds runs, or cannot be read."""
    if not path.exists():
        return False
    try:
        with opened(path) as database, database.reading() as connection:
            return connection.execute(select(func.count()).select_from(RUNS)).scalar_one() > 0
    except StoreError:
        return True


def _remove(file: Path) -> None:
    for ending in _COMPANIONS:
        with suppress(FileNotFoundError):
            os.unlink(f"{file}{ending}")


@contextmanager
def _explained(file: Path) -> Iterator[None]:
    """Turn errors of files into those of the store."""
    try:
        yield
    except OSError as error:
        detail = error.strerror or str(error)
        raise StoreError(Message("store.file", file=str(file), detail=detail)) from error
    except sqlite3.Error as error:
        raise StoreError(Message("store.file", file=str(file), detail=str(error))) from error
