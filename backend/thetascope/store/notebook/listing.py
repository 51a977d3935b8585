"""Which runs a list has, and their order."""

import json
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from sqlalchemy import ColumnElement, Select, and_, func, select

from thetascope.store.tables import RUN_FACTS, RUN_NOTES, RUNS

Order = Literal["created", "name", "experiment", "rmse", "delay", "false_alarms"]
Group = Literal["none", "experiment", "tags"]

COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    ">=": operator.ge,
    "<=": operator.le,
    ">": operator.gt,
    "<": operator.lt,
    "=": operator.eq,
}


@dataclass(frozen=True)
class Condition:
    """A comparison of a setting or measure with a number, such as `lambda > 2`."""

    name: str
    comparison: str
    value: float

    def holds(self, values: Sequence[float]) -> bool:
        """Return whether one of the values meets it."""
        return any(COMPARISONS[self.comparison](value, self.value) for value in values)


@dataclass(frozen=True)
class RunQuery:
    """Which runs of an owner's list are returned, and in which order.

    Args:
        words: each is in the run's facts, name or tags, or begins its id.
        conditions: on settings, or on rmse, delay and alarms.
        kind, experiment, tag, since: only these runs; None: all. `since` is a time in s since 1970.
        pinned: only pinned runs.
        order, descending: what they are sorted by; runs without a value are last.
        group: runs of a group follow each other, the group with the newest run first.
    """

    words: tuple[str, ...] = ()
    conditions: tuple[Condition, ...] = ()
    kind: str | None = None
    experiment: str | None = None
    tag: str | None = None
    since: float | None = None
    pinned: bool = False
    order: Order = "created"
    descending: bool = True
    group: Group = "none"
    limit: int = 100
    offset: int = 0


@dataclass(frozen=True)
class Counts:
    """How many runs an owner's list has in all, by kind, and by tag; `found`: those of a query, by group."""

    all: int = 0
    pinned: int = 0
    kinds: dict[str, int] = field(default_factory=dict)
    tags: dict[str, int] = field(default_factory=dict)
    found: dict[str, int] = field(default_factory=dict)


MEASURES = {"rmse": RUN_FACTS.c.rmse, "delay": RUN_FACTS.c.delay, "alarms": RUN_FACTS.c.false_alarms}
_ORDERS: dict[str, ColumnElement[Any]] = {
    "created": RUNS.c.created,
    "name": func.coalesce(RUN_NOTES.c.name, ""),
    "experiment": RUN_FACTS.c.experiment,
    "rmse": RUN_FACTS.c.rmse,
    "delay": RUN_FACTS.c.delay,
    "false_alarms": RUN_FACTS.c.false_alarms,
}
GROUPS: dict[str, ColumnElement[str]] = {
    "experiment": func.coalesce(RUN_FACTS.c.experiment, ""),
    "tags": func.coalesce(RUN_NOTES.c.tags, "[]"),
}


def joined(owner: str, *columns: Any) -> Select[*tuple[Any, ...]]:
    """Return the query of columns of all runs that an owner's list has, with facts and the owner's notes."""
    mine = (RUN_NOTES.c.run == RUNS.c.id) & (RUN_NOTES.c.owner == owner)
    source = RUNS.outerjoin(RUN_FACTS, RUN_FACTS.c.run == RUNS.c.id).outerjoin(RUN_NOTES, mine)
    return select(*columns).select_from(source).where(RUNS.c.removed.is_(None) & RUN_NOTES.c.removed.is_(None))


def conditions(query: RunQuery) -> ColumnElement[bool]:
    """Return the part of a query that the database can answer."""
    terms: list[ColumnElement[bool]] = [RUNS.c.id == RUNS.c.id]
    for word in query.words:
        low = word.lower()
        named = [func.lower(column).contains(low, autoescape=True) for column in (RUN_NOTES.c.name, RUN_NOTES.c.tags)]
        terms.append(
            RUN_FACTS.c.words.contains(low, autoescape=True)
            | func.coalesce(named[0] | named[1], False)
            | RUNS.c.id.startswith(low, autoescape=True)
        )
    if query.kind is not None:
        terms.append(func.coalesce(RUN_FACTS.c.kind, "run") == query.kind)
    if query.experiment is not None:
        terms.append(GROUPS["experiment"] == query.experiment)
    if query.tag is not None:
        terms.append(RUN_NOTES.c.tags.contains(json.dumps(query.tag, ensure_ascii=False), autoescape=True))
    if query.since is not None:
        terms.append(RUNS.c.created >= query.since)
    if query.pinned:
        terms.append(RUNS.c.pinned != 0)
    measured = [one for one in query.conditions if one.name in MEASURES]
    terms += [COMPARISONS[one.comparison](MEASURES[one.name], one.value) for one in measured]
    return and_(*terms)


def ordered(selected: Select[*tuple[Any, ...]], query: RunQuery) -> Select[*tuple[Any, ...]]:
    """Return the query with its order: groups by their newest run, then by the column, then the newest first."""
    by = _ORDERS[query.order]
    direction = by.desc() if query.descending else by.asc()
    order: list[ColumnElement[Any]] = []
    if query.group != "none":
        group = GROUPS[query.group]
        order += [func.max(RUNS.c.created).over(partition_by=group).desc(), group]
    return selected.order_by(*order, by.is_(None), direction, RUNS.c.created.desc(), RUNS.c.id)
