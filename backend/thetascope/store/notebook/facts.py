"""Facts of a run, which are written with it."""

import json
import logging
import math
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

from sqlalchemy import Connection, select, update
from sqlalchemy.dialects import postgresql, sqlite

from thetascope.messages import Message
from thetascope.store.tables import RUN_FACTS, as_json, as_number, as_text, facts_sum, has_facts

log = logging.getLogger(__name__)

KINDS = ("run", "session", "record")
"""A run that was asked for, a live session that was saved, and observers on a record."""


@dataclass(frozen=True)
class RunFacts:
    """Facts of a run that its line in a list shows, and by which lists are sought and sorted.

    Args:
        experiment: id of the library's experiment that the run follows; empty: it follows none.
        kind: one of `KINDS`.
        rmse, delay, false_alarms: of the observer that `shown` names; None: unknown.
        words: all words by which the run is sought, in lower case.
        numbers: the values of its settings by name; a gain of several observers has several.
        changes: the differences from the experiment: path, label (a message as data), from, to.
        shown: what else the line shows: observer, state, and the curve of the first fault.
        compared: whether `changes` are those from another run of the plant, as no experiment is followed; not stored.
    """

    experiment: str
    kind: str = "run"
    rmse: float | None = None
    delay: float | None = None
    false_alarms: int | None = None
    words: str = ""
    numbers: dict[str, list[float]] = field(default_factory=dict)
    changes: list[dict[str, Any]] = field(default_factory=list)
    shown: dict[str, Any] = field(default_factory=dict)
    compared: bool = False


_MEASURES = ("rmse", "delay", "false_alarms")
_CHANGED = ("experiment", *_MEASURES, "words", "numbers", "changes", "shown", "checksum")  # not the kind
_JSON = {"numbers": dict, "changes": list, "shown": dict}


def put_facts(connection: Connection, id: str, facts: RunFacts) -> None:
    """Write the facts of a run in a transaction. Its kind stays, and its curve if there is no other."""
    if "curve" not in facts.shown:
        old = connection.execute(select(RUN_FACTS).where(RUN_FACTS.c.run == id)).one_or_none()
        if old is not None and has_facts(old):
            facts = replace(facts, shown={"curve": as_json(old.shown).get("curve"), **facts.shown})
    row = {"run": id, **vars(facts), "rmse": _measured(facts.rmse), "delay": _measured(facts.delay)}
    row |= {name: json.dumps(row[name], ensure_ascii=False) for name in _JSON}
    row["words"] = facts.words.replace("\0", " ")
    row["checksum"] = facts_sum(id, SimpleNamespace(**row))
    statement = {"sqlite": sqlite, "postgresql": postgresql}[connection.dialect.name].insert(RUN_FACTS)
    changed = {name: statement.excluded[name] for name in _CHANGED}
    connection.execute(statement.on_conflict_do_update(index_elements=["run"], set_=changed), row)


def set_kind(connection: Connection, id: str, kind: str) -> None:
    """Write the kind of a run that has facts."""
    connection.execute(update(RUN_FACTS).where(RUN_FACTS.c.run == id).values(kind=kind))


def facts_of_row(row: Any) -> RunFacts | None:
    """Return the facts in a row that joins runs and facts; None if there are none, or they are not what was written."""
    measures = (row.rmse, row.delay, row.false_alarms)
    if row.kind is not None and row.checksum != facts_sum(row.id, row):
        log.error("the facts of run %s are damaged, and are found again", row.id)
        return None
    if row.kind not in KINDS or not all(map(_is_measure, measures)):
        return None
    try:
        data = {name: as_json(getattr(row, name)) for name in _JSON}
    except (TypeError, ValueError, RecursionError):
        return None
    well_formed = all(isinstance(data[name], kind) for name, kind in _JSON.items())
    if not well_formed or not all(map(_is_change, data["changes"])):
        return None
    return RunFacts(as_text(row.experiment), row.kind, *measures, as_text(row.words), **data)


def _measured(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _is_measure(value: object) -> bool:
    return value is None or (isinstance(value, int | float) and as_number(value) == value)


def _is_change(value: object) -> bool:
    """Return whether it is a change with a label that can be rendered."""
    if not isinstance(value, dict) or not isinstance(label := value.get("label"), dict):
        return False
    try:
        return bool(Message.from_data(label).text("en"))
    except (KeyError, TypeError, ValueError, AttributeError):
        return False
