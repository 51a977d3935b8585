"""Owners of runs in the store. A damaged row is an owner that nobody matches: it gives nobody a run."""

import logging
from collections.abc import Iterable, Sequence
from typing import Any

from sqlalchemy import Connection, delete, select, update
from sqlalchemy.dialects import postgresql, sqlite

from thetascope.store.tables import OWNERS, RUNS, UNKNOWN, as_text, has_owner, owner_sum

log = logging.getLogger(__name__)


def owners_of(connection: Connection, ids: Sequence[str]) -> dict[str, frozenset[str]]:
    """Return the owners of runs that have any."""
    owners: dict[str, set[str]] = {}
    for row in connection.execute(select(OWNERS).where(OWNERS.c.run.in_(ids))):
        owners.setdefault(row.run, set()).add(row.owner if has_owner(row) else UNKNOWN)
    for id, found in owners.items():
        if UNKNOWN in found:
            log.error("an owner of run %s is damaged", id)
    return {id: frozenset(names) for id, names in owners.items()}


def add_owners(connection: Connection, id: str, owners: Iterable[str]) -> None:
    """Write owners of a run; those that it has stay."""
    insert = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}[connection.dialect.name](OWNERS)
    changes = {"checksum": insert.excluded.checksum}
    for owner in owners:
        row = {"run": id, "owner": owner, "checksum": owner_sum(id, owner)}
        connection.execute(insert.on_conflict_do_update(index_elements=["run", "owner"], set_=changes), row)


def mend_owners(connection: Connection) -> None:
    """Restore damaged owners: run and owner for which the checksum fits are those that were written.

    Otherwise a run with two owners, of which one has lost its row, would belong to the other one alone.
    """
    damaged = [row for row in connection.execute(select(OWNERS)) if not has_owner(row)]
    if not damaged:
        return
    runs = list(connection.execute(select(RUNS.c.id)).scalars())
    owners = list(connection.execute(select(OWNERS.c.owner).distinct()).scalars())
    for row in damaged:
        pairs = [(run, row.owner) for run in runs] + [(row.run, owner) for owner in owners]
        written = next((pair for pair in pairs if owner_sum(*pair) == row.checksum), None)
        if written is None:
            log.error("an owner of run %s is damaged", as_text(row.run))
            continue
        _restore(connection, row, *written)
        log.error("an owner of run %s was damaged, and is restored", written[0])


def _restore(connection: Connection, damaged: Any, run: str, owner: str) -> None:
    """Write what a damaged row was. It is found by its checksum, as damaged text may be none that a query can hold."""
    place = OWNERS.c.checksum == damaged.checksum
    known = connection.execute(select(OWNERS.c.run).where((OWNERS.c.run == run) & (OWNERS.c.owner == owner)))
    if known.one_or_none() is None:
        connection.execute(update(OWNERS).where(place).values(run=run, owner=owner))
    else:
        connection.execute(delete(OWNERS).where(place & ~((OWNERS.c.run == run) & (OWNERS.c.owner == owner))))
        add_owners(connection, run, [owner])
