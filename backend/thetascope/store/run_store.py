"""Runs in the store: one row per spec, and its result while space permits."""

import json
import logging
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any, get_args

from sqlalchemy import Connection, Float, Row, Table, bindparam, cast, delete, desc, func, select, update
from sqlalchemy.dialects import postgresql, sqlite

from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope.store.damaged_rows import rows_one_by_one
from thetascope.store.database import Database
from thetascope.store.encoding import decode, encode
from thetascope.store.errors import Damaged, StoreError
from thetascope.store.notebook.facts import RunFacts, put_facts
from thetascope.store.notebook.owners import add_owners, owners_of
from thetascope.store.notebook.removal import erase, mark_removed
from thetascope.store.tables import (
    OWNERS,
    RESULTS,
    RUN_NOTES,
    RUNS,
    UNKNOWN,
    as_number,
    has_result,
    has_spec,
    is_time,
    is_whole,
    outcome_sum,
    result_sum,
    spec_sum,
)
from thetascope_schemas.service.run import Status

log = logging.getLogger(__name__)

#: A result's time of last use is written at most this often, so that reading does not become writing.
_TOUCH_SECONDS = 60.0
_BY_ID = RUNS.c.id == bindparam("id")
_RESULT = (RESULTS.c.id == bindparam("id")) & (RESULTS.c.engine == bindparam("engine"))
_THERE = RUNS.c.removed.is_(None)
_GET = select(RUNS).where(_BY_ID & _THERE)
_PAGE = (
    select(RUNS)
    .where(_THERE)
    .order_by(desc(RUNS.c.created), RUNS.c.id)
    .limit(bindparam("limit"))
    .offset(bindparam("offset"))
)
_GET_RESULT = select(RESULTS).where(_RESULT)
_HAS_RESULT = select(1).where(_RESULT)
_UNFINISHED = select(RUNS).where(RUNS.c.status.in_(("queued", "running"))).order_by(RUNS.c.created)
_COUNT = select(func.count()).select_from(RUNS).where(_THERE)
_SUM = func.coalesce(func.sum(cast(RESULTS.c.size, Float)), 0)  # damaged sizes do not exceed the range of a float
_SUMS = select(func.count(), _SUM)
_SIZE = func.length(RESULTS.c.head) + func.length(RESULTS.c.data)
_TRUE_SIZES = update(RESULTS).values(size=_SIZE).where(RESULTS.c.size != _SIZE)
_CANDIDATES = (
    select(RESULTS.c.id, RESULTS.c.engine, RESULTS.c.size)
    .select_from(RESULTS.outerjoin(RUNS, RUNS.c.id == RESULTS.c.id))
    .where(func.coalesce(RUNS.c.pinned, 0) == 0)
    .order_by(RESULTS.c.used)
)
_CHANGED = ("spec", "title", "status", "error", "summary", "engine", "spec_sum", "outcome_sum", "created", "removed")


def _upserts(table: Table, changed: Sequence[str]) -> dict[str, Any]:
    """Return for each kind of database the statement that inserts a row, or changes columns of the present one."""
    statements = {"sqlite": sqlite.insert(table), "postgresql": postgresql.insert(table)}
    return {
        kind: statement.on_conflict_do_update(
            index_elements=list(table.primary_key), set_={name: statement.excluded[name] for name in changed}
        )
        for kind, statement in statements.items()
    }


_PUT = _upserts(RUNS, _CHANGED)  # not the pin
_LIST_AGAIN = (
    update(RUN_NOTES)
    .where((RUN_NOTES.c.run == bindparam("id")) & (RUN_NOTES.c.owner == bindparam("by")))
    .values(removed=None)
)
_PUT_RESULT = _upserts(RESULTS, ("used", "size", "rows", "head", "data", "checksum"))


@dataclass(frozen=True)
class Record:
    """A stored run without its result. `spec` is the experiment as JSON text, empty in listings.

    `damaged`: a checksum does not fit. Only the fields that a listing shows are filled in then, and `spec`, if it is
    undamaged itself. `facts` are written with the run, and not read with it.
    """

    id: str
    spec: str
    title: str
    status: Status
    engine: str
    created: float
    error: dict[str, Any] | None = None
    summary: dict[str, Any] | None = None
    pinned: bool = False
    damaged: bool = False
    facts: RunFacts | None = None


class RunStore:
    """Reads and writes runs. A result belongs to a run and to the version of the engine that computed it.

    What is read has the checksum with which it was written. `limit` is the space for results in bytes: beyond it, the
    least recently used results of unpinned runs are deleted.
    """

    def __init__(self, database: Database, limit: int) -> None:
        self._database = database
        self._limit = limit
        self._lost: set[tuple[str, str]] = set()  # damaged results that could not be removed

    @property
    def database(self) -> Database:
        """Return the database that holds the runs."""
        return self._database

    @property
    def read_only(self) -> bool:
        """Whether nothing can be written."""
        return self._database.read_only

    def put(self, record: Record) -> None:
        """Insert or update a run; an existing one keeps its time of creation and its pin."""
        title = record.title.replace("\0", "\ufffd")  # PostgreSQL has no text with this character
        outcome = (record.status, _dump(record.error), _dump(record.summary), record.engine)
        with self._database.writing() as connection:
            known = connection.execute(select(RUNS).where(_BY_ID), {"id": record.id}).one_or_none()
            created = known.created if known is not None and has_spec(known) else float(record.created)
            row = {
                "id": record.id,
                "spec": record.spec,
                "title": title,
                **dict(zip(_CHANGED[2:6], outcome, strict=True)),
                "spec_sum": spec_sum(record.id, record.spec, title, created),
                "outcome_sum": outcome_sum(record.id, *outcome),
                "created": created,
                "pinned": int(record.pinned),
                "removed": None,
            }
            connection.execute(_PUT[connection.dialect.name], row)
            if record.facts is not None:
                put_facts(connection, record.id, record.facts)

    def get(self, id: str) -> Record | None:
        """Return a run with its spec, or None if there is no such run. Raises Damaged if its spec is damaged."""
        with _naming(id), self._database.reading() as connection:
            row = connection.execute(_GET, {"id": id}).one_or_none()
        if row is None:
            return None
        if not has_spec(row):
            raise Damaged(Message("store.spec-damaged", id=id[:64]))
        return _record(row)

    def page(self, limit: int = 100, offset: int = 0) -> list[Record]:
        """Return runs without their specs, summaries and errors, newest first. Damaged ones are marked as such."""
        try:
            with self._database.reading() as connection:
                rows = connection.execute(_PAGE, {"limit": limit, "offset": offset}).all()
        except StoreError as error:
            log.error("%s", error)
            rows = [row for row in rows_one_by_one(self._database, limit, offset) if row.removed is None]
        return [listed_record(row) for row in rows]

    def ids(self, prefix: str, limit: int = 3) -> list[str]:
        """Return ids that start with `prefix`, to suggest for a mistyped one."""
        begins = func.substr(RUNS.c.id, 1, len(prefix)) == prefix
        query = select(RUNS.c.id).where(begins & _THERE).order_by(desc(RUNS.c.created)).limit(limit)
        with self._database.reading() as connection:
            return list(connection.execute(query).scalars())

    def pin(self, id: str, pinned: bool) -> bool:
        """Keep the run's result, or allow its deletion again. Return False if the run does not exist."""
        with self._database.writing() as connection:
            change = update(RUNS).where(RUNS.c.id == id).values(pinned=int(pinned))
            return connection.execute(change).rowcount > 0

    def owners(self, id: str) -> frozenset[str]:
        """Return the owners of a run; none for one that was stored before there were owners.

        An owner whose row is damaged is one that no client matches.
        """
        with self._database.reading() as connection:
            return owners_of(connection, [id]).get(id, frozenset())

    def own(self, id: str, owners: Iterable[str]) -> None:
        """Add owners to a run, if it exists; those that it has stay."""
        with self._database.writing() as connection:
            if connection.execute(select(1).where(RUNS.c.id == id)).one_or_none() is not None:
                known = sorted(set(owners) - {UNKNOWN})
                add_owners(connection, id, known)
                for owner in known:
                    connection.execute(_LIST_AGAIN, {"id": id, "by": owner})

    def disown(self, id: str, owner: str) -> None:
        """Remove an owner of a run."""
        with self._database.writing() as connection:
            connection.execute(delete(OWNERS).where((OWNERS.c.run == id) & (OWNERS.c.owner == owner)))

    def delete(self, id: str) -> bool:
        """Erase the run with all that belongs to it. Return False if the run does not exist."""
        with self._database.writing() as connection:
            return erase(connection, RUNS.c.id == id) > 0

    def remove(self, id: str) -> bool:
        """Remove the run; until it is erased it can be brought back. Return False if the run does not exist."""
        with self._database.writing() as connection:
            return mark_removed(connection, id, time.time())

    def erase_removed(self, id: str) -> None:
        """Erase the run if it was removed: somebody asks for the same experiment."""
        removed = (RUNS.c.id == id) & RUNS.c.removed.is_not(None)
        with self._database.reading() as connection:
            if connection.execute(select(RUNS.c.id).where(removed)).one_or_none() is None:
                return
        with self._database.writing() as connection:
            erase(connection, removed)

    def unfinished(self) -> list[Record]:
        """Return the runs that a server accepted and did not finish, oldest first, without those that are damaged."""
        with self._database.reading() as connection:
            rows = connection.execute(_UNFINISHED).all()
        return [record for row in rows if has_spec(row) and not (record := _record(row)).damaged]

    def put_result(self, id: str, engine: str, result: Result) -> bool:
        """Store a result, deleting others if space is short. Return False, storing nothing, if it exceeds the limit."""
        head, array = encode(result)
        size, rows = len(head) + array.nbytes, result.data.shape[1]
        if size > self._limit:
            return False
        data = array.reshape(-1).view("u1").data
        row = {"used": time.time(), "size": size, "rows": rows, "head": head, "data": data}
        row["checksum"] = result_sum(id, engine, rows, head, data)
        with self._database.writing() as connection:
            connection.execute(_PUT_RESULT[connection.dialect.name], {"id": id, "engine": engine, **row})
            self._evict(connection)
        self._lost.discard((id, engine))
        return True

    def get_result(self, id: str, engine: str) -> Result | None:
        """Return the run's result, bit-identical to what this engine computed, or None if it is not stored.

        Raises Damaged for a result without its checksum, which is removed so that it is computed again.
        """
        if (id, engine) in self._lost:
            return None
        try:
            with _naming(id), self._database.reading() as connection:
                row = connection.execute(_GET_RESULT, {"id": id, "engine": engine}).one_or_none()
        except Damaged:
            self._drop(id, engine)
            raise
        if row is None:
            return None
        if not has_result(row):
            self._drop(id, engine)
            raise Damaged(Message("store.result-damaged", id=id[:64]))
        now = time.time()
        if not self.read_only and not (isinstance(row.used, float) and 0 <= now - row.used <= _TOUCH_SECONDS):
            with suppress(StoreError), self._database.writing() as connection:  # a full disk does not prevent reading
                connection.execute(update(RESULTS).where(_result(id, engine)).values(used=now))
        return decode(row.head, row.data, row.rows)

    def has_result(self, id: str, engine: str) -> bool:
        """Return whether the run has a result that this version of the engine computed."""
        if (id, engine) in self._lost:
            return False
        with _naming(id), self._database.reading() as connection:
            return connection.execute(_HAS_RESULT, {"id": id, "engine": engine}).one_or_none() is not None

    def usage(self) -> dict[str, int]:
        """Return the number of stored runs and results, and the bytes of the results with their limit.

        What a damaged store cannot count is -1.
        """
        runs = results = size = -1
        try:
            with self._database.reading() as connection:
                runs = connection.execute(_COUNT).scalar_one()
                results, size = connection.execute(_SUMS).one()
        except StoreError as error:
            if error.problem.code != "store.damaged":
                raise
            log.error("%s", error)
        return {"runs": runs, "results": results, "bytes": int(as_number(size)), "limit": self._limit}

    def _drop(self, id: str, engine: str) -> None:
        """Remove a damaged result; where the store cannot be written, count it as absent."""
        log.error("%s", Message("store.result-damaged", id=id))
        self._lost.add((id, engine))
        try:
            with self._database.writing() as connection:
                connection.execute(delete(RESULTS).where(_result(id, engine)))
            self._lost.discard((id, engine))
        except StoreError as error:
            log.error("%s", error)

    def _evict(self, connection: Connection) -> None:
        """Delete the least recently used results until the rest fits. Pinned ones stay even beyond the limit."""
        if connection.execute(select(_SUM)).scalar_one() <= self._limit:
            return
        # `size` is in no checksum: before something is deleted, the sizes are read from the results themselves
        connection.execute(_TRUE_SIZES)
        excess = connection.execute(select(_SUM)).scalar_one() - self._limit
        for id, engine, size in connection.execute(_CANDIDATES).all() if excess > 0 else ():
            if excess <= 0:
                break
            connection.execute(delete(RESULTS).where(_result(id, engine)))
            excess -= size


@contextmanager
def _naming(id: str) -> Iterator[None]:
    """Turn an error of a damaged file into one that names the run."""
    try:
        yield
    except StoreError as error:
        if error.problem.code != "store.damaged":
            raise
        raise Damaged(Message("store.run-unreadable", id=id[:64], **error.problem.args)) from error


def _result(id: str, engine: str):
    """Return the condition for the row of a result."""
    return (RESULTS.c.id == id) & (RESULTS.c.engine == engine)


def _dump(value: dict[str, Any] | None) -> str | None:
    return None if value is None else json.dumps(value)


def _record(row: Row) -> Record:
    """Return the record of a run whose spec is undamaged."""
    if not is_whole(row):
        return _damaged(row, row.spec)
    error, summary = (None if text is None else json.loads(text) for text in (row.error, row.summary))
    pinned = bool(row.pinned)
    return Record(row.id, row.spec, row.title, row.status, row.engine, row.created, error, summary, pinned)


def listed_record(row: Row) -> Record:
    """Return the record of a row as a list shows it, without spec, summary and error."""
    if not is_whole(row):
        return _damaged(row)
    return Record(row.id, "", row.title, row.status, row.engine, row.created, pinned=bool(row.pinned))


def _damaged(row: Row, spec: str = "") -> Record:
    """Return the fields of a damaged row that can be shown."""
    created = float(row.created) if is_time(row.created) else 0.0
    status = row.status if row.status in get_args(Status) else "failed"
    title = row.title if has_spec(row) else ""
    return Record(_shown(row.id), spec, title, status, "", created, pinned=bool(row.pinned), damaged=True)


def _shown(text: object) -> str:
    """Return a text of a damaged row as characters that can be sent."""
    return text.encode("utf-8", "replace").decode("utf-8") if isinstance(text, str) else ""
