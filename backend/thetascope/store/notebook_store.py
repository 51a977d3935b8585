"""The notebook of runs in the store: lists, names and tags, removal and its undoing."""

import json
import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Row, case, delete, func, insert, select, update

from thetascope.messages import Message
from thetascope.store.database import Database
from thetascope.store.errors import Damaged
from thetascope.store.notebook.facts import KINDS, RunFacts, facts_of_row, put_facts, set_kind
from thetascope.store.notebook.listing import GROUPS, MEASURES, Counts, RunQuery, conditions, joined, ordered
from thetascope.store.notebook.owners import mend_owners, owners_of
from thetascope.store.notebook.removal import erase, mark_removed, show_hidden
from thetascope.store.run_store import Record, listed_record
from thetascope.store.tables import (
    COMPARISON_NOTES,
    RUN_FACTS,
    RUN_NOTES,
    RUNS,
    as_json,
    as_text,
    comparison_sum,
    has_comparison_note,
    has_note,
    note_sum,
    was_removed,
)

log = logging.getLogger(__name__)

_NOTE = [RUN_NOTES.c.name, RUN_NOTES.c.tags, RUN_NOTES.c.owner, RUN_NOTES.c.checksum.label("note_sum")]
_SHOWN = [RUNS, *(column for column in RUN_FACTS.c if column.name != "run"), *_NOTE]
_MANY = 200


@dataclass(frozen=True)
class Line:
    """A run in a list: its record without spec and summary, its facts, and the owner's name and tags for it.

    `note_damaged`: name and tags are not what was written, and empty.
    """

    record: Record
    facts: RunFacts | None
    name: str = ""
    tags: tuple[str, ...] = ()
    owners: frozenset[str] = frozenset()
    note_damaged: bool = False


class NotebookStore:
    """Reads and writes what lists of runs need."""

    def __init__(self, database: Database) -> None:
        self._database = database

    @property
    def read_only(self) -> bool:
        """Whether nothing can be written."""
        return self._database.read_only

    def page(self, owner: str, query: RunQuery) -> tuple[list[Line], Counts]:
        """Return a page of an owner's list, and what the list has in all. Raises StoreError for a damaged file."""
        where = conditions(query)
        beyond = [one for one in query.conditions if one.name not in MEASURES]
        group = GROUPS.get(query.group, GROUPS["experiment"]).label("group")
        with self._database.reading() as connection:
            ids = ordered(joined(owner, RUNS.c.id, RUN_FACTS.c.numbers, group).where(where), query)
            if beyond:
                rows = [row for row in connection.execute(ids) if _meets(row.numbers, beyond)]
                found = Counter(as_text(row.group) for row in rows)
                page = [row.id for row in rows[query.offset : query.offset + query.limit]]
            else:
                counted = joined(owner, group, func.count().label("n")).where(where).group_by(group)
                found = Counter()
                for row in connection.execute(counted):
                    found[as_text(row.group)] += row.n
                page = [row.id for row in connection.execute(ids.limit(query.limit).offset(query.offset))]
            lines = {row.id: row for row in connection.execute(joined(owner, *_SHOWN).where(RUNS.c.id.in_(page)))}
            owners = owners_of(connection, page)
            counts = self._counts(connection, owner, dict(found))
        return [_line(lines[id], owners.get(id, frozenset())) for id in page if id in lines], counts

    def line(self, owner: str, id: str) -> Line | None:
        """Return the line of a run in an owner's list, or None if it is not there."""
        with self._database.reading() as connection:
            row = connection.execute(joined(owner, *_SHOWN).where(RUNS.c.id == id)).one_or_none()
            return None if row is None else _line(row, owners_of(connection, [id]).get(id, frozenset()))

    def without_facts(self) -> list[str]:
        """Return ids of stored runs that have no facts, the newest first: an earlier version wrote them."""
        known = select(RUN_FACTS.c.run).where(RUN_FACTS.c.run == RUNS.c.id).exists()
        missing = select(RUNS.c.id).where(~known & RUNS.c.id.is_not(None) & RUNS.c.removed.is_(None))
        with self._database.reading() as connection:
            return list(connection.execute(missing.order_by(RUNS.c.created.desc()).limit(_MANY)).scalars())

    def put_facts(self, facts: dict[str, RunFacts]) -> None:
        """Write the facts of runs."""
        with self._database.writing() as connection:
            for id, one in facts.items():
                put_facts(connection, id, one)

    def set_kind(self, id: str, kind: str) -> None:
        """Write the kind of a run."""
        with self._database.writing() as connection:
            set_kind(connection, id, kind)

    def note(self, id: str, owner: str, name: str | None = None, tags: tuple[str, ...] | None = None) -> None:
        """Write what an owner calls a run, its tags, or both."""
        texts = {"name": name, "tags": None if tags is None else json.dumps(tags, ensure_ascii=False)}
        self._put_note(id, owner, {key: value for key, value in texts.items() if value is not None})

    def comparison_notes(self, ids: Sequence[str], owner: str) -> str:
        """Return what an owner notes about the comparison of runs, "" if nothing. Raises Damaged."""
        here = (COMPARISON_NOTES.c.runs == _together(ids)) & (COMPARISON_NOTES.c.owner == owner)
        with self._database.reading() as connection:
            row = connection.execute(select(COMPARISON_NOTES).where(here)).one_or_none()
        if row is not None and not has_comparison_note(row):
            raise Damaged(Message("store.notes-damaged"))
        return "" if row is None else row.text

    def note_comparison(self, ids: Sequence[str], owner: str, text: str) -> None:
        """Write what an owner notes about the comparison of runs; an empty text removes it."""
        row = {"runs": _together(ids), "owner": owner, "text": text.replace("\0", "\ufffd")}
        row["checksum"] = comparison_sum(*row.values())
        here = (COMPARISON_NOTES.c.runs == row["runs"]) & (COMPARISON_NOTES.c.owner == owner)
        with self._database.writing() as connection:
            connection.execute(delete(COMPARISON_NOTES).where(here))
            if text:
                connection.execute(insert(COMPARISON_NOTES), row)

    def give_up(self, id: str, owner: str, at: float | None) -> None:
        """Leave a run that others own out of an owner's list; with None for the time, take it back."""
        self._put_note(id, owner, {"removed": at})

    def given_up(self, id: str, owner: str) -> bool:
        """Return whether an owner has removed a run that others own."""
        mine = (RUN_NOTES.c.run == id) & (RUN_NOTES.c.owner == owner) & RUN_NOTES.c.removed.is_not(None)
        with self._database.reading() as connection:
            return connection.execute(select(RUN_NOTES.c.run).where(mine)).one_or_none() is not None

    def restore(self, id: str) -> bool:
        """Bring back a run that was removed; return False if it is unknown."""
        with self._database.writing() as connection:
            return mark_removed(connection, id, None)

    def erase(self, before: float) -> int:
        """Erase the runs that were removed before a time, and show those that damage hides; return how many went."""
        with self._database.writing() as connection:
            show_hidden(connection)
            return erase(connection, was_removed(RUNS.c.removed, before))

    def mend(self) -> None:
        """Restore damaged owners of runs as far as their checksums allow, and log all damaged ones."""
        with self._database.writing() as connection:
            mend_owners(connection)

    def _put_note(self, id: str, owner: str, changes: dict[str, Any]) -> None:
        with self._database.writing() as connection:
            here = (RUN_NOTES.c.run == id) & (RUN_NOTES.c.owner == owner)
            old = connection.execute(select(RUN_NOTES).where(here)).one_or_none()
            row = {"run": id, "owner": owner, "name": "", "tags": "[]", "removed": None}
            if old is not None:
                row |= {"removed": old.removed} | ({"name": old.name, "tags": old.tags} if has_note(old) else {})
            row |= changes
            if old is None or has_note(old) or changes.keys() & {"name", "tags"}:  # else the damage is still reported
                row["checksum"] = note_sum(id, owner, row["name"], row["tags"])
            else:
                row = changes
            if old is None:
                connection.execute(insert(RUN_NOTES), row)
            else:
                connection.execute(update(RUN_NOTES).where(here).values(**row))

    @staticmethod
    def _counts(connection: Any, owner: str, found: dict[str, int]) -> Counts:
        kind = func.coalesce(RUN_FACTS.c.kind, "run")
        pins = func.sum(case((RUNS.c.pinned == 1, 1), else_=0)).label("pins")
        rows = connection.execute(
            joined(
                owner,
                kind.label("kind"),
                func.count().label("n"),
                pins,
            ).group_by(kind)
        ).all()
        tags: Counter[str] = Counter()
        for row in connection.execute(joined(owner, RUNS.c.id, *_NOTE).where(RUN_NOTES.c.tags.is_not(None))):
            tags.update(_note(row)[1])
        kinds: Counter[str] = Counter()
        for row in rows:
            kinds[row.kind if row.kind in KINDS else KINDS[0]] += row.n
        return Counts(kinds.total(), sum(int(row.pins) for row in rows), dict(kinds), dict(tags), found)


def _meets(numbers: str | None, conditions: list[Any]) -> bool:
    """Return whether the settings of a run meet conditions."""
    try:
        values = json.loads(numbers or "{}")
        return all(one.holds(values.get(one.name, ())) for one in conditions)
    except (ValueError, TypeError, AttributeError, RecursionError):
        return False


def _line(row: Row, owners: frozenset[str]) -> Line:
    name, tags, whole = _note(row)
    return Line(listed_record(row), facts_of_row(row), name, tags, owners, note_damaged=not whole)


def _note(row: Row) -> tuple[str, tuple[str, ...], bool]:
    """Return the name and the tags in a row that joins runs and notes, and whether they are what was written."""
    if row.owner is None:
        return "", (), True
    if row.note_sum != note_sum(row.id, row.owner, row.name, row.tags):
        log.error("the name and the tags of run %s are damaged", row.id)
        return "", (), False
    return as_text(row.name), tags_of(row.tags), True


def _together(ids: Sequence[str]) -> str:
    """Return the key of a comparison, whichever the order of its runs."""
    return ",".join(sorted(ids))


def tags_of(text: str | None) -> tuple[str, ...]:
    """Return the tags that a list in JSON holds; none if it cannot be read."""
    try:
        return tuple(str(tag) for tag in as_json(text) or ())
    except (ValueError, TypeError, RecursionError):
        log.error("the tags of a run cannot be read")
        return ()
