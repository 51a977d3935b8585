"""Access one SQLite file from several threads and processes, and migrate it to the current schema."""

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thetascope.messages import Message
from thetascope.store.migrations import MIGRATIONS


class StoreError(RuntimeError):
    """The store cannot be used.

    Args:
        problem: why; its remedy is the message whose code is the problem's plus `.remedy`, with its arguments.
    """

    def __init__(self, problem: Message) -> None:
        super().__init__(problem)
        self.problem = problem

    def text(self, language: str = "en") -> str:
        """Return `problem; remedy` in a language."""
        remedy = Message(f"{self.problem.code}.remedy", **self.problem.args)
        return Message("refusal.sentence", problem=self.problem, remedy=remedy).text(language)

    def __str__(self) -> str:
        return self.text()


class Database:
    """Two connections to the file, one for writing and one for reading, each with its own lock.

    The write-ahead log lets reads continue while a large result is written, and lets other processes read and write
    (they wait for the lock up to `timeout` seconds). A crash loses at most the last transactions, never the file. Lost
    runs are recomputed from their specs.
    """

    def __init__(self, path: Path, timeout: float = 10.0) -> None:
        self.path = path
        self._timeout = timeout
        self._locks = {"read": threading.RLock(), "write": threading.RLock()}
        with self._explained():
            path.parent.mkdir(parents=True, exist_ok=True)
            write = self._connect()
            self._connections = {"write": write}
            migrate(write, path)
            self._connections["read"] = self._connect()

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """Yield the reading connection, for this thread alone while inside."""
        with self._locks["read"], self._explained():
            yield self._connections["read"]

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """Yield the connection in a write transaction; commit at the end, roll back on an error."""
        with self._locks["write"], self._explained():
            connection = self._connections["write"]
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
            except BaseException:
                connection.rollback()
                raise
            connection.commit()

    def close(self) -> None:
        """Close both connections; SQLite then merges the log into the file."""
        for name, connection in self._connections.items():
            with self._locks[name]:
                connection.close()

    def _connect(self) -> sqlite3.Connection:
        connection = sqlite3.connect(
            self.path, timeout=self._timeout, isolation_level=None, check_same_thread=False, cached_statements=64
        )
        connection.row_factory = sqlite3.Row
        connection.execute("PRAGMA page_size = 8192")  # applies to a new file; results are megabytes
        connection.execute("PRAGMA auto_vacuum = INCREMENTAL")
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
        return connection

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise StoreError(_explain(self.path, error)) from error
        except OSError as error:
            detail = error.strerror or str(error)
            raise StoreError(Message("store.folder", folder=str(self.path.parent), detail=detail)) from error


def migrate(connection: sqlite3.Connection, path: Path) -> None:
    """Apply the migrations that are new to the file; other processes may do so concurrently."""
    if _version(connection) == len(MIGRATIONS):
        return
    connection.execute("BEGIN IMMEDIATE")
    version = _version(connection)
    if version > len(MIGRATIONS):
        connection.rollback()
        raise StoreError(Message("store.newer", path=str(path), version=version, known=len(MIGRATIONS)))
    for statements in MIGRATIONS[version:]:
        for statement in statements:
            connection.execute(statement)
    connection.execute(f"PRAGMA user_version = {len(MIGRATIONS)}")
    connection.commit()


def _version(connection: sqlite3.Connection) -> int:
    return connection.execute("PRAGMA user_version").fetchone()[0]


def _explain(path: Path, error: sqlite3.Error) -> Message:
    """Return the reason for an SQLite error, derived from its text."""
    detail = str(error)
    args = {"path": str(path), "detail": detail}
    if "locked" in detail or "busy" in detail:
        return Message("store.locked", **args)
    if "unable to open" in detail or "readonly" in detail:
        return Message("store.read-only", **args)
    if "full" in detail:
        return Message("store.disk-full", **args)
    return Message("store.damaged", **args)
