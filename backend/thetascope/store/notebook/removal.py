"""Remove runs so that they can be brought back for some time, and erase them."""

import logging

from sqlalchemy import ColumnElement, Connection, delete, literal, select, update

from thetascope.store.tables import (
    COMPARISON_NOTES,
    LESSONS,
    OWNERS,
    PLANTS,
    RESULTS,
    RUN_FACTS,
    RUN_NOTES,
    RUNS,
    was_removed,
)

log = logging.getLogger(__name__)


def erase(connection: Connection, condition: ColumnElement[bool]) -> int:
    """Delete the runs that meet a condition, with specs, results, owners, facts and notes; return their number."""
    ids = select(RUNS.c.id).where(condition)
    for id in connection.execute(ids).scalars().all():
        together = literal(",") + COMPARISON_NOTES.c.runs + ","
        connection.execute(delete(COMPARISON_NOTES).where(together.contains(f",{id},", autoescape=True)))
    connection.execute(delete(RESULTS).where(RESULTS.c.id.in_(ids)))
    for table in (OWNERS, RUN_FACTS, RUN_NOTES):
        connection.execute(delete(table).where(table.c.run.in_(ids)))
    return connection.execute(delete(RUNS).where(condition)).rowcount


def show_hidden(connection: Connection) -> None:
    """Bring back the rows that no removal hides, but a value that is not a time: a damaged field."""
    for table in (RUNS, RUN_NOTES, PLANTS, LESSONS):
        removed = table.c.removed
        hidden = removed.is_not(None) & ~was_removed(removed)
        n = connection.execute(update(table).where(hidden).values(removed=None)).rowcount
        if n:
            log.error("%d rows of %s had a damaged time of removal, and are shown again", n, table.name)


def mark_removed(connection: Connection, id: str, at: float | None) -> bool:
    """Mark a run as removed at a time, or bring it back; return whether that changed anything."""
    other = RUNS.c.removed.is_(None) if at is not None else RUNS.c.removed.is_not(None)
    return connection.execute(update(RUNS).where((RUNS.c.id == id) & other).values(removed=at)).rowcount > 0
