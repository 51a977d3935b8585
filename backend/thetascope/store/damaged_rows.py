"""Read the rows of a store one by one, so that a page of a damaged file that cannot be read hides only its own rows."""

import logging
from collections.abc import Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

from sqlalchemy import select, text

from thetascope.store.backends.sqlite import SQLite
from thetascope.store.database import Database
from thetascope.store.errors import StoreError
from thetascope.store.tables import RUNS

log = logging.getLogger(__name__)

_LISTS = (
    "SELECT id, created FROM runs ORDER BY created DESC, id",
    "SELECT id, created FROM runs NOT INDEXED",
    "SELECT id, NULL FROM runs INDEXED BY sqlite_autoindex_runs_1",
)
"""Queries that find runs by different parts of the file."""


def rows_one_by_one(database: Database, limit: int | None = None, offset: int = 0) -> Iterator[Any]:
    """Yield rows of `runs`, newest first; one that cannot be read has its id and empty fields.

    Raises StoreError if no part of the file can be read.
    """
    created: dict[str, float] = {}
    failure: StoreError | None = None
    for query in _LISTS if isinstance(database.backend, SQLite) else _LISTS[:1]:
        try:
            with database.reading() as connection:
                for id, time in connection.execute(text(query)):
                    created[id] = max(created.get(id, 0.0), time if isinstance(time, float) else 0.0)
        except StoreError as error:
            failure = error
    if failure is not None and not created:
        raise failure
    order = sorted(created, key=lambda id: (-created[id], str(id)))
    for id in order[offset : None if limit is None else offset + limit]:
        yield _row(database, id, created[id])


def _row(database: Database, id: str, created: float) -> Any:
    with suppress(StoreError, UnicodeError), database.reading() as connection:
        row = connection.execute(select(RUNS).where(RUNS.c.id == id)).one_or_none()
        if row is not None:
            return row
    log.error("the row of run %s cannot be read", id)
    return SimpleNamespace(**dict.fromkeys(RUNS.c.keys()) | {"id": id, "created": created})
