"""A store in one SQLite file."""

import sqlite3
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.exc import DBAPIError
from sqlalchemy.pool import NullPool

from thetascope.messages import Message
from thetascope.store.backends.owner_file import OwnerFile
from thetascope.store.errors import StoreError

_SETTINGS = (
    "page_size = 8192",  # applies to a new file; results are megabytes
    "auto_vacuum = INCREMENTAL",
    "journal_mode = WAL",
    "synchronous = NORMAL",
)


class SQLite:
    """How a file is opened, and what its errors mean.

    The write-ahead log lets reads continue while a large result is written, and lets other processes read and write
    (they wait for the lock up to `timeout` seconds). A crash loses at most the last transactions, never the file.
    """

    #: One connection for all readers: they take turns.
    shared_reading = False

    def __init__(self, path: Path, timeout: float, read_only: bool) -> None:
        self.path, self.place, self._timeout, self._read_only = path, str(path), timeout, read_only
        self._owner = OwnerFile(path.resolve())

    def prepare(self) -> None:
        """Create the folder of the file. Raises OSError, or StoreError for a file that should be there."""
        if not self._read_only:
            self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        elif not self.path.is_file():
            raise StoreError(Message("store.absent", path=self.place))

    def snapshot(self, connection: Connection) -> Connection:
        """Return a connection whose reads all see the file at one moment, until it is rolled back."""
        connection.exec_driver_sql("BEGIN")
        return connection

    def defects(self, connection: Connection) -> list[str]:
        """Return the defects in the structure of the file, at most twenty."""
        found = connection.exec_driver_sql("PRAGMA integrity_check(20)").scalars().all()
        return [] if found == ["ok"] else list(found)

    def own(self, connection: Connection | None) -> str | None:
        """Become the owner and return None, or return who is. The lock ends with the process."""
        return self._owner.take()

    def disown(self) -> None:
        """Be no longer the owner."""
        self._owner.release()

    def alive(self, connection: Connection) -> bool:
        """Return whether a connection can be used: one to a file can."""
        return True

    def engine(self, writing: bool) -> Engine:
        """Return an engine whose transactions lock the file from their beginning if they are for writing."""
        engine = create_engine("sqlite://", creator=self._connect, poolclass=NullPool)
        if writing:
            event.listen(engine, "begin", lambda connection: connection.exec_driver_sql("BEGIN IMMEDIATE"))
        return engine

    def version(self, connection: Connection) -> int:
        """Return the version of the schema, 0 for an empty file."""
        return connection.exec_driver_sql("PRAGMA user_version").scalar_one()

    def set_version(self, connection: Connection, version: int) -> None:
        """Record the version of the schema."""
        connection.exec_driver_sql(f"PRAGMA user_version = {version}")

    def translated(self, statement: str) -> str:
        """Return a statement of a migration in the database's own types."""
        return statement

    def lock_schema(self, connection: Connection) -> None:
        """Let no other process migrate: the transaction holds the file already."""

    def explain(self, error: DBAPIError | OSError) -> Message:
        """Return the reason for an error, derived from its text."""
        if isinstance(error, OSError):
            return Message("store.folder", folder=str(self.path.parent), detail=error.strerror or str(error))
        detail = str(error.orig)
        args = {"path": self.place, "detail": detail}
        if "locked" in detail or "busy" in detail:
            return Message("store.locked", **args)
        if "unable to open" in detail or "readonly" in detail:
            return Message("store.read-only", **args)
        if "full" in detail:
            return Message("store.disk-full", **args)
        if "disk I/O error" in detail:
            return Message("store.disk-error", **args)
        return Message("store.damaged", **args)

    def _connect(self) -> sqlite3.Connection:
        uri = f"{self.path.absolute().as_uri()}?mode={'ro' if self._read_only else 'rwc'}"
        connection = sqlite3.connect(
            uri, timeout=self._timeout, isolation_level=None, check_same_thread=False, cached_statements=64, uri=True
        )
        connection.text_factory = _text
        try:
            for setting in () if self._read_only else _SETTINGS:
                connection.execute(f"PRAGMA {setting}")
        except BaseException:
            connection.close()
            raise
        return connection


def _text(raw: bytes) -> str:
    """Return a text that can be sent; bytes that are not UTF-8 in a damaged row do not hide the others."""
    return raw.decode("utf-8", "replace")
