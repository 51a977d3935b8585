"""Runs in the store: one row per spec, and its result while space permits."""

import json
import sqlite3
import time
from dataclasses import dataclass
from typing import Any

from thetascope.engine.model.result import Result
from thetascope.store.database import Database
from thetascope.store.encoding import decode, encode
from thetascope_schemas.service.run import Status

#: A result's time of last use is written at most this often, so that reading does not become writing.
_TOUCH_SECONDS = 60.0
_BRIEF = "id, title, status, error, summary, engine, created, pinned"


@dataclass(frozen=True)
class Record:
    """A stored run without its result. `spec` is the experiment as JSON text, empty in listings."""

    id: str
    spec: str
    title: str
    status: Status
    engine: str
    created: float
    error: dict[str, Any] | None = None
    summary: dict[str, Any] | None = None
    pinned: bool = False


class RunStore:
    """Reads and writes runs. A result belongs to a run and to the version of the engine that computed it.

    `limit` is the space for results in bytes: beyond it, the least recently used results of unpinned runs are deleted.
    """

    def __init__(self, database: Database, limit: int) -> None:
        self._database = database
        self._limit = limit

    def put(self, record: Record) -> None:
        """Insert or update a run; an existing one keeps its time of creation and its pin."""
        values = (
            record.id,
            record.spec,
            record.title,
            record.status,
            _dump(record.error),
            _dump(record.summary),
            record.engine,
            record.created,
            record.pinned,
        )
        with self._database.writing() as connection:
            connection.execute(
                """INSERT INTO runs (id, spec, title, status, error, summary, engine, created, pinned)
                VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET
                spec = excluded.spec, title = excluded.title, status = excluded.status, error = excluded.error,
                summary = excluded.summary, engine = excluded.engine""",
                values,
            )

    def get(self, id: str) -> Record | None:
        """Return a run with its spec, or None if there is no such run."""
        with self._database.reading() as connection:
            row = connection.execute(f"SELECT spec, {_BRIEF} FROM runs WHERE id = ?", (id,)).fetchone()
        return _record(row) if row else None

    def page(self, limit: int = 100, offset: int = 0) -> list[Record]:
        """Return runs without their specs, newest first."""
        query = f"SELECT '' AS spec, {_BRIEF} FROM runs ORDER BY created DESC, id LIMIT ? OFFSET ?"
        with self._database.reading() as connection:
            return [_record(row) for row in connection.execute(query, (limit, offset))]

    def ids(self, prefix: str, limit: int = 3) -> list[str]:
        """Return ids that start with `prefix`, to suggest for a mistyped one."""
        query = "SELECT id FROM runs WHERE substr(id, 1, ?) = ? ORDER BY created DESC LIMIT ?"
        with self._database.reading() as connection:
            return [row["id"] for row in connection.execute(query, (len(prefix), prefix, limit))]

    def pin(self, id: str, pinned: bool) -> bool:
        """Keep the run's result, or allow its deletion again. Return False if the run does not exist."""
        with self._database.writing() as connection:
            return connection.execute("UPDATE runs SET pinned = ? WHERE id = ?", (pinned, id)).rowcount > 0

    def delete(self, id: str) -> bool:
        """Remove the run, its spec and its results. Return False if the run does not exist."""
        with self._database.writing() as connection:
            connection.execute("DELETE FROM results WHERE id = ?", (id,))
            return connection.execute("DELETE FROM runs WHERE id = ?", (id,)).rowcount > 0

    def interrupted(self, error: dict[str, Any]) -> None:
        """Mark runs as failed that an earlier server accepted and did not finish."""
        with self._database.writing() as connection:
            connection.execute(
                "UPDATE runs SET status = 'failed', error = ? WHERE status IN ('queued', 'running')", (_dump(error),)
            )

    def put_result(self, id: str, engine: str, result: Result) -> bool:
        """Store a result, deleting others if space is short. Return False, storing nothing, if it exceeds the limit."""
        head, data = encode(result)
        size = len(head) + data.nbytes
        if size > self._limit:
            return False
        with self._database.writing() as connection:
            connection.execute(
                "INSERT OR REPLACE INTO results (id, engine, used, size, rows, head, data) VALUES (?,?,?,?,?,?,?)",
                (id, engine, time.time(), size, result.data.shape[1], head, data),
            )
            self._evict(connection)
        return True

    def get_result(self, id: str, engine: str) -> Result | None:
        """Return the run's result, bit-identical to what this engine computed, or None if it is not stored."""
        with self._database.reading() as connection:
            row = connection.execute(
                "SELECT head, rows, data, used FROM results WHERE id = ? AND engine = ?", (id, engine)
            ).fetchone()
        if row is None:
            return None
        now = time.time()
        if now - row["used"] > _TOUCH_SECONDS:
            with self._database.writing() as connection:
                connection.execute("UPDATE results SET used = ? WHERE id = ? AND engine = ?", (now, id, engine))
        return decode(row["head"], row["data"], row["rows"])

    def has_result(self, id: str, engine: str) -> bool:
        """Return whether the run has a result that this version of the engine computed."""
        with self._database.reading() as connection:
            query = "SELECT 1 FROM results WHERE id = ? AND engine = ?"
            return connection.execute(query, (id, engine)).fetchone() is not None

    def usage(self) -> dict[str, int]:
        """Return the number of stored runs and results, and the bytes of the results with their limit."""
        with self._database.reading() as connection:
            runs = connection.execute("SELECT count(*) FROM runs").fetchone()[0]
            results, size = connection.execute("SELECT count(*), coalesce(sum(size), 0) FROM results").fetchone()
        return {"runs": runs, "results": results, "bytes": size, "limit": self._limit}

    def _evict(self, connection: sqlite3.Connection) -> None:
        """Delete the least recently used results until the rest fits. Pinned ones stay even beyond the limit."""
        excess = connection.execute("SELECT coalesce(sum(size), 0) FROM results").fetchone()[0] - self._limit
        if excess <= 0:
            return
        candidates = connection.execute(
            """SELECT results.id, results.engine, results.size FROM results LEFT JOIN runs ON runs.id = results.id
            WHERE coalesce(runs.pinned, 0) = 0 ORDER BY results.used"""
        ).fetchall()
        for id, engine, size in candidates:
            if excess <= 0:
                break
            connection.execute("DELETE FROM results WHERE id = ? AND engine = ?", (id, engine))
            excess -= size


def _dump(value: dict[str, Any] | None) -> str | None:
    return None if value is None else json.dumps(value)


def _record(row: sqlite3.Row) -> Record:
    values = dict(row)
    for name in ("error", "summary"):
        values[name] = None if values[name] is None else json.loads(values[name])
    values["pinned"] = bool(values["pinned"])
    return Record(**values)
