"""Access a store from several threads and processes, and migrate it to the current schema."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError, SQLAlchemyError

from thetascope.messages import Message
from thetascope.store.backends.postgresql import PostgreSQL
from thetascope.store.backends.sqlite import SQLite
from thetascope.store.errors import StoreError
from thetascope.store.migrations import MIGRATIONS

Backend = SQLite | PostgreSQL


class Database:
    """A store: one connection for writing with a lock, and connections for reading.

    Args:
        place: path of an SQLite file, or a URL (`postgresql://…`, `sqlite:///…`).
        timeout: how long to wait for another process that writes, in seconds.
        read_only: change nothing; the store must have the current schema.

    Lost runs are recomputed from their specs.
    """

    def __init__(self, place: Path | str, timeout: float = 10.0, read_only: bool = False) -> None:
        self.backend = backend_of(place, timeout, read_only)
        self.read_only = read_only
        self._locks = {"read": threading.RLock(), "write": threading.RLock()}
        self._engines = {name: self.backend.engine(name == "write") for name in ("read", "write")}
        self._held: dict[str, Connection] = {}
        self._owned = False
        try:
            with self._explained():
                self.backend.prepare()
            self._migrate()
        except BaseException:
            self.close()
            raise

    @classmethod
    def for_service(cls, place: Path | str, read_only: bool) -> "Database":
        """Open a store as its owner, or for reading only. Raises StoreError, also if another process owns it."""
        database = cls(place, read_only=read_only)
        try:
            if not read_only:
                database.own()
        except StoreError:
            database.close()
            raise
        return database

    def own(self) -> None:
        """Become the owner of the store until it is closed. Others still read, and write runs of their own.

        Raises StoreError with the name of the process that is the owner.
        """
        with self._locks["write"], self._explained(), self._connection("write") as connection:
            self._take(connection)
            self._owned = True

    @property
    def place(self) -> str:
        """The path or address of the store, without a password."""
        return self.backend.place

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Yield a connection for reading, for this thread alone while inside."""
        if self.backend.shared_reading:
            with self._explained(), self._engines["read"].connect() as connection:
                yield connection
        else:
            with self._locks["read"], self._explained(), self._connection("read") as connection:
                yield connection

    @contextmanager
    def snapshot(self) -> Iterator[Connection]:
        """Yield a connection whose reads all see the store at one moment."""
        with self._explained(), self._engines["read"].connect() as connection:
            yield self.backend.snapshot(connection)
            connection.rollback()

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """Yield the connection in a write transaction; commit at the end, roll back on an error."""
        if self.read_only:
            raise StoreError(Message("store.joined", path=self.place))
        with self._locks["write"], self._explained(), self._connection("write") as connection:
            yield connection

    def close(self) -> None:
        """Close the connections; SQLite then merges the log into the file."""
        for name, engine in self._engines.items():
            with self._locks[name]:
                connection = self._held.pop(name, None)
                if connection is not None:
                    connection.close()
                engine.dispose()
        self.backend.disown()

    @contextmanager
    def _connection(self, name: str) -> Iterator[Connection]:
        """Yield the connection that is held for a purpose, in a transaction; connect again if it was lost."""
        connection = self._held.get(name)
        if connection is None or connection.invalidated or not self.backend.alive(connection):
            connection = self._held[name] = self._connect(name)
        with connection.begin():
            yield connection

    def _connect(self, name: str) -> Connection:
        """Return a new connection for a purpose; the one for writing is again that of the owner."""
        lost = self._held.pop(name, None)
        if lost is not None:
            lost.close()
        connection = self._engines[name].connect()
        try:
            if name == "write" and self._owned:
                self._take(connection)
                connection.rollback()
        except BaseException:
            connection.close()
            raise
        return connection

    def _take(self, connection: Connection) -> None:
        owner = self.backend.own(connection)
        if owner is not None:
            raise StoreError(Message("store.owned", path=self.place, owner=owner))

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except (DBAPIError, OSError) as error:
            raise StoreError(self.backend.explain(error)) from error
        except SQLAlchemyError as error:
            raise StoreError(Message("store.damaged", path=self.place, detail=str(error))) from error

    def _migrate(self) -> None:
        """Apply the migrations that are new to the store; other processes may do so concurrently."""
        backend = self.backend
        with self.reading() as connection:
            version = backend.version(connection)
        if version == len(MIGRATIONS):
            return
        if version > len(MIGRATIONS):
            raise StoreError(Message("store.newer", path=self.place, version=version, known=len(MIGRATIONS)))
        if self.read_only:
            raise StoreError(Message("store.older", path=self.place, version=version, known=len(MIGRATIONS)))
        with self.writing() as connection:
            backend.lock_schema(connection)
            for steps in MIGRATIONS[backend.version(connection) :]:
                for step in steps:
                    if callable(step):
                        step(connection)
                    else:
                        connection.exec_driver_sql(backend.translated(step))
            backend.set_version(connection, len(MIGRATIONS))


def backend_of(place: Path | str, timeout: float, read_only: bool) -> Backend:
    """Return the kind of database that a path or URL names. Raises StoreError for other kinds."""
    if isinstance(place, Path) or "://" not in place:
        return SQLite(Path(place).expanduser(), timeout, read_only)
    try:
        url = make_url(place)
    except (ArgumentError, ValueError):
        raise StoreError(Message("store.address", path=place.rpartition("@")[2])) from None
    kind = url.drivername.partition("+")[0]
    if kind in ("postgresql", "postgres"):
        return PostgreSQL(url, timeout, read_only)
    if kind == "sqlite" and url.database:
        return SQLite(Path(url.database), timeout, read_only)
    raise StoreError(Message("store.address", path=url.render_as_string(hide_password=True)))
