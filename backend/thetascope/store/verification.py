"""Check a store while it is used: the structure of its file, and the checksums of all rows."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Table, select

from thetascope.messages import Message
from thetascope.store.damaged_rows import rows_one_by_one
from thetascope.store.database import Database
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
    has_comparison_note,
    has_facts,
    has_note,
    has_owner,
    has_result,
    has_share,
    has_spec,
    has_text,
    is_whole,
)


@dataclass(frozen=True)
class Verification:
    """The numbers of runs and results that were read, and the defects that were found."""

    runs: int
    results: int
    defects: tuple[Message, ...]


def verify(database: Database) -> Verification:
    """Read everything in a store, and return the defects. Raises StoreError if nothing can be read."""
    defects = [Message("store.defect.file", detail=line) for line in _structure(database)]
    runs = results = 0
    for row in rows_one_by_one(database):
        runs += 1
        if not has_spec(row):
            defects.append(Message("store.defect.spec", id=_shown(row.id)))
        elif not is_whole(row):
            defects.append(Message("store.defect.outcome", id=_shown(row.id)))
    try:
        with database.reading() as connection:
            places = connection.execute(select(RESULTS.c.id, RESULTS.c.engine)).all()
    except StoreError as error:
        places = []
        defects.append(error.problem)
    for id, engine in places:
        results += 1
        if not _is_readable(database, id, engine):
            defects.append(Message("store.defect.result", id=_shown(id)))
    wrong = [id for id in _records(database, defects) if not _is_record(database, id)]
    defects += [Message("store.defect.record", id=_shown(id)) for id in wrong]
    defects += _damaged_rows(database)
    return Verification(runs, results, tuple(defects))


_DEFECTS: dict[Table, tuple[Callable[[Any], bool], Callable[[Any], Message]]] = {
    PLANTS: (has_text, lambda row: Message("store.defect.plant", id=_shown(row.id), version=row.version or 0)),
    LESSONS: (has_text, lambda row: Message("store.defect.lesson", id=_shown(row.id), version=row.version or 0)),
    OWNERS: (has_owner, lambda row: Message("store.defect.owner", id=_shown(row.run))),
    RUN_FACTS: (has_facts, lambda row: Message("store.defect.facts", id=_shown(row.run))),
    RUN_NOTES: (has_note, lambda row: Message("store.defect.note", id=_shown(row.run))),
    COMPARISON_NOTES: (has_comparison_note, lambda row: Message("store.defect.comparison-note", ids=_shown(row.runs))),
    RECORD_SHARES: (has_share, lambda row: Message("store.defect.share", id=_shown(row.record))),
}
"""For tables of small rows: whether a row is what was written, and the defect that it is not."""


def _damaged_rows(database: Database) -> list[Message]:
    """Return a defect for each row of the small tables that is not what was written."""
    defects = []
    for table, (whole, defect) in _DEFECTS.items():
        try:
            with database.reading() as connection:
                defects += [defect(row) for row in connection.execute(select(table)) if not whole(row)]
        except StoreError as error:
            defects.append(error.problem)
    return defects


def _records(database: Database, defects: list[Message]) -> list[str]:
    """Return the ids of all uploaded records; add the defect if they cannot be listed."""
    try:
        with database.reading() as connection:
            return list(connection.execute(select(RECORDS.c.id)).scalars())
    except StoreError as error:
        defects.append(error.problem)
        return []


def _is_record(database: Database, id: str) -> bool:
    """Return whether a record has the bytes that its id says."""
    try:
        with database.reading() as connection:
            row = connection.execute(select(RECORDS).where(RECORDS.c.id == id)).one_or_none()
    except StoreError:
        return False
    return _is_plain(id) if row is None else has_record(row)  # None: it was removed meanwhile


def _structure(database: Database) -> list[str]:
    """Return the defects that the database itself finds in its file."""
    try:
        with database.reading() as connection:
            return database.backend.defects(connection)
    except StoreError as error:
        return [str(error.problem)]


def _is_readable(database: Database, id: str, engine: str) -> bool:
    """Return whether a result has its checksum."""
    query = select(RESULTS).where((RESULTS.c.id == id) & (RESULTS.c.engine == engine))
    try:
        with database.reading() as connection:
            row = connection.execute(query).one_or_none()
    except StoreError:
        return False
    return _is_plain(id, engine) if row is None else has_result(row)  # None: it was removed meanwhile


def _is_plain(*key: object) -> bool:
    """Return whether a key is not damaged so that its row cannot be found by it."""
    return all(isinstance(part, str) and part.isascii() for part in key)


def _shown(id: object) -> str:
    return str(id)[:64].encode("utf-8", "replace").decode("utf-8")
