"""A store in a PostgreSQL database."""

import hashlib
import re

from sqlalchemy import URL, Connection, Engine, create_engine, text
from sqlalchemy.exc import DBAPIError

from thetascope.messages import Message
from thetascope.store.backends.owner_file import identity

_TYPES = {"REAL": "DOUBLE PRECISION", "BLOB": "BYTEA", "INTEGER": "BIGINT"}
_MIGRATING = 0x7468657461  # key of the lock that is held during a migration
_HOLDER = """SELECT application_name FROM pg_locks JOIN pg_stat_activity USING (pid)
WHERE locktype = 'advisory' AND granted AND ((classid::bigint << 32) | objid::bigint) = :key
AND database = (SELECT oid FROM pg_database WHERE datname = current_database())"""


class PostgreSQL:
    """How a database is reached, and what its errors mean."""

    #: Readers have connections of their own, from a pool.
    shared_reading = True

    def __init__(self, url: URL, timeout: float, read_only: bool) -> None:
        self._url = url.set(drivername="postgresql+psycopg")
        self.place = self._url.set(drivername="postgresql").render_as_string(hide_password=True)
        self._timeout, self._read_only = timeout, read_only

    def prepare(self) -> None:
        """Do nothing: the database exists."""

    def engine(self, writing: bool) -> Engine:
        """Return an engine. Statements wait for a lock no longer than the store's time-out."""
        own = self._url.query.get("options", "")
        options = f"{own if isinstance(own, str) else ' '.join(own)} -c lock_timeout={int(self._timeout * 1000)}"
        if self._read_only:
            options += " -c default_transaction_read_only=on"
        arguments = {
            "application_name": identity()[:63],
            "connect_timeout": 10,
            "options": options,
        }
        return create_engine(self._url, connect_args=arguments, pool_pre_ping=True, hide_parameters=True)

    def snapshot(self, connection: Connection) -> Connection:
        """Return a connection whose reads all see the database at one moment, until it is rolled back."""
        return connection.execution_options(isolation_level="REPEATABLE READ")

    def defects(self, connection: Connection) -> list[str]:
        """Return no defects: the server checks its own pages."""
        return []

    def own(self, connection: Connection) -> str | None:
        """Become the owner and return None, or return who is. The lock ends with the connection."""
        schema = connection.execute(text("SELECT current_schema()")).scalar_one()
        key = {"key": int.from_bytes(hashlib.sha256(f"thetascope {schema}".encode()).digest()[:8], "big") >> 1}
        if connection.execute(text("SELECT pg_try_advisory_lock(:key)"), key).scalar_one():
            return None
        return connection.execute(text(_HOLDER), key).scalar() or "another process"

    def disown(self) -> None:
        """Do nothing: the lock ends with the connection."""

    def alive(self, connection: Connection) -> bool:
        """Return whether the server still answers on a connection."""
        try:
            connection.exec_driver_sql("SELECT 1")
            connection.rollback()
        except DBAPIError:
            return False
        return True

    def version(self, connection: Connection) -> int:
        """Return the version of the schema, 0 for an empty database."""
        if connection.execute(text("SELECT to_regclass('thetascope_schema')")).scalar_one() is None:
            return 0
        return connection.execute(text("SELECT version FROM thetascope_schema")).scalar_one()

    def set_version(self, connection: Connection, version: int) -> None:
        """Record the version of the schema."""
        connection.execute(text("CREATE TABLE IF NOT EXISTS thetascope_schema (version BIGINT NOT NULL)"))
        connection.execute(text("DELETE FROM thetascope_schema"))
        connection.execute(text("INSERT INTO thetascope_schema VALUES (:version)"), {"version": version})

    def translated(self, statement: str) -> str:
        """Return a statement of a migration in the database's own types."""
        return re.sub(r"\b(REAL|BLOB|INTEGER)\b", lambda found: _TYPES[found[0]], statement)

    def lock_schema(self, connection: Connection) -> None:
        """Let no other process migrate until the transaction ends."""
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _MIGRATING})

    def explain(self, error: DBAPIError | OSError) -> Message:
        """Return the reason for an error, derived from its class and text."""
        detail = str(error.orig if isinstance(error, DBAPIError) else error).strip().partition("\n")[0]
        args = {"path": self.place, "detail": detail}
        code = getattr(getattr(error, "orig", None), "sqlstate", None) or ""
        if code.startswith("55P03"):
            return Message("store.locked", **args)
        if code.startswith("53"):
            return Message("store.disk-full", **args)
        if code in ("25006", "42501"):
            return Message("store.read-only", **args)
        if code.startswith(("XX", "22", "42")):
            return Message("store.damaged", **args)
        return Message("store.unreachable", **args)
