"""Find the column of times and its unit, and turn it into seconds."""

from dataclasses import dataclass, replace

import numpy as np

from thetascope.messages import Message
from thetascope.records.columns.names import is_time_name, split_unit
from thetascope.records.columns.units import conversion
from thetascope.records.table import Column, Table
from thetascope.records.text.moments import NONE
from thetascope_schemas.experiment.measurement import TimeMapping, TimeUnit

_DAY = 86_400.0
_FACTORS: dict[TimeUnit, float] = {
    **{"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": _DAY},
    **{"epoch-s": 1.0, "epoch-ms": 1e-3, "epoch-us": 1e-6, "epoch-ns": 1e-9, "spreadsheet-days": _DAY},
}
_EPOCHS: dict[TimeUnit, float] = {"epoch-s": 1.0, "epoch-ms": 1e3, "epoch-us": 1e6, "epoch-ns": 1e9}
_YEARS = (5e8, 6e9)  # seconds since 1970 that are taken for dates
_DAYS = (25_000.0, 75_000.0)  # days since 1899 that are taken for dates
_SPREADSHEET = 25_569.0  # days from 1899-12-30 to 1970-01-01
_LATEST = 1e19  # s
_FORWARD = 0.9  # share of rows whose time is later than that of the row before
_LENGTHS: tuple[TimeUnit, ...] = ("ns", "us", "ms", "s", "min", "h", "d")
_ZONES = ("utc", "gmt", "local", "iso", "iso8601")
_WRITTEN: dict[str, str] = {"sec": "s", "epoch": "epoch-s", "unix": "epoch-s", "posix": "epoch-s"}


@dataclass(frozen=True)
class TimeChoice:
    """The column of times: its name, its unit, whether both are certain, and why. Without a column, the period."""

    column: str | None
    unit: TimeUnit | None
    period: float | None
    reason: Message
    certain: bool = True
    written: bool = False


def guess_time(table: Table) -> TimeChoice:
    """Return the column that most probably holds the times, or none."""
    scored = [(_score(column, place, table), -place, column) for place, column in enumerate(table.columns)]
    best, _, column = max(scored, key=lambda item: item[:2])
    if best < 2:
        return TimeChoice(None, None, None, Message("record.reason.no-time"), certain=False)
    unit, written = unit_of_time(column)
    named = column.kind == "datetime" or table.named and is_time_name(column.name)
    code = "dates" if column.kind == "datetime" else "time-name" if named else "time-increases"
    return TimeChoice(column.name, unit, None, Message(f"record.reason.{code}"), named, written)


def _score(column: Column, place: int, table: Table) -> float:
    """Return how probable it is that a column holds the times; below 2: it is another one."""
    if column.kind == "datetime":
        return 5.0 + (column.epoch == "date") + 0.5 * is_time_name(column.name)
    if column.kind != "number":
        return 0.0
    forward = _forward(column.values)
    steady = max(forward, _forward(-column.values)) >= _FORWARD
    if table.named and is_time_name(column.name):
        bare, unit = split_unit(column.name)
        unit = unit or column.unit
        fits = not unit or conversion(unit, "s") is not None or unit.lower() in _WRITTEN
        return (4.0 if steady else 2.0) + (0.5 if bare.lower() in ("t", "time") else 0.0) if fits else 0.0
    unit = split_unit(column.name)[1] or column.unit
    if steady and unit and conversion(unit, "s") is not None:
        return 3.0
    unnamed = not table.named or column.name == f"col{place + 1}"
    counts = table.named and is_index(column.values)
    return 2.5 if steady and forward == 1.0 and place < 2 and unnamed and not counts else 0.0


def _forward(values: np.ndarray) -> float:
    steps = np.diff(values[~np.isnan(values)])
    return float((steps > 0).mean()) if len(steps) else 0.0


def is_index(values: np.ndarray) -> bool:
    """Return whether numbers count the rows."""
    return len(values) > 1 and bool((np.diff(values) == 1).all()) and values[0] in (0, 1)


def unit_of_time(column: Column) -> tuple[TimeUnit, bool]:
    """Return the unit of a column of times, and whether the file writes it."""
    if column.kind == "datetime":
        return ("datetime" if column.epoch == "date" else "clock"), True
    text = split_unit(column.name)[1] or column.unit
    written = "" if text.lower() in _ZONES else _WRITTEN.get(text.lower(), text)
    values = column.values[~np.isnan(column.values)]
    first, last = (float(q) for q in np.quantile(values, (0.03, 0.97))) if len(values) else (0.0, 0.0)
    if written in ("", "s", "ms", "us", "ns", "epoch-s"):
        for unit, factor in _EPOCHS.items():
            if _YEARS[0] * factor <= first and last <= _YEARS[1] * factor and unit.startswith(f"epoch-{written}"):
                return unit, True
    close = len(values) > 1 and (np.abs(np.diff(values)) < 1).mean() > _FORWARD and (values % 1 != 0).any()
    if written == "" and _DAYS[0] <= first and last <= _DAYS[1] and close:
        return "spreadsheet-days", True
    for unit in _FACTORS:
        if unit == written:
            return unit, True
    pair = conversion(written, "s") if written else None
    if pair is not None:
        return min(_LENGTHS, key=lambda u: abs(np.log(_FACTORS[u] / pair[0]))), True
    return "s", False


@dataclass(frozen=True)
class Seconds:
    """Times in s from the first row on, NaN where one is missing, and the date of the first row if there are dates."""

    t: np.ndarray
    begin: str | None


def seconds_of(table: Table, choice: TimeChoice) -> Seconds:
    """Return the times of the rows as they are in the file, not sorted; NaN for numbers that no clock shows."""
    seconds = _seconds_of(table, choice)
    return replace(seconds, t=np.where(np.abs(seconds.t) < _LATEST, seconds.t, np.nan))


def _seconds_of(table: Table, choice: TimeChoice) -> Seconds:
    if choice.column is None:
        return Seconds(np.arange(len(table)) * (choice.period or 1.0), None)
    column = table.named_as(choice.column)
    if column is None:
        raise KeyError(choice.column)
    if column.kind == "datetime":
        ticks, epoch = _ticks(column, table)
        return _of_ticks(ticks, epoch)
    unit = choice.unit or "s"
    values = column.values
    good = values[~np.isnan(values)]
    first = float(good[0]) if len(good) else 0.0
    if unit.startswith("epoch"):
        return Seconds((values - first) * _FACTORS[unit], _date(first * _FACTORS[unit]))
    if unit == "spreadsheet-days":
        return Seconds(np.round((values - first) * _DAY, 6), _date((first - _SPREADSHEET) * _DAY))
    factor = _FACTORS.get(unit, 1.0)
    return Seconds(values * factor if factor != 1e-9 else (values - first) * factor, None)


def _ticks(column: Column, table: Table) -> tuple[np.ndarray, str]:
    """Return nanoseconds and their kind; a column of days is completed by one of times of day."""
    ticks = np.asarray(column.values, dtype="i8")
    days = int(_DAY) * 10**9
    some = ticks != NONE
    if column.epoch == "date" and (ticks[some] % days == 0).all():
        clock = next((c for c in table.columns if c.epoch == "clock"), None)
        if clock is not None:
            own = np.asarray(clock.values, dtype="i8")
            return np.where(some & (own != NONE), ticks + own, NONE), "date"
    return ticks, column.epoch


def _of_ticks(ticks: np.ndarray, epoch: str) -> Seconds:
    some = ticks != NONE
    if not some.any():
        return Seconds(np.full(len(ticks), np.nan), None)
    first = int(ticks[some][0])
    t = np.where(some, (ticks - first) * 1e-9, np.nan)
    if epoch == "clock":
        known = np.flatnonzero(some)
        steps = np.diff(t[known])
        t[known[1:]] += _DAY * np.cumsum(steps < -_DAY / 2)
        return Seconds(t, None)
    return Seconds(t, _date(first * 1e-9))


def _date(seconds: float) -> str | None:
    if not abs(seconds) < 9e9:
        return None
    return str(np.datetime64(int(round(seconds * 1e3)), "ms")) + "Z"


def changed(choice: TimeChoice, asked: TimeMapping, table: Table) -> TimeChoice:
    """Return the choice with what a user has set. Raises KeyError for an unknown column."""
    column, unit, period = asked.column, asked.unit, asked.period
    if period is not None and column is None:
        return TimeChoice(None, None, period, Message("record.reason.chosen"))
    if column is not None and column != choice.column:
        found = table.named_as(column)
        if found is None:
            raise KeyError(column)
        own, written = unit_of_time(found)
        choice = TimeChoice(column, own, None, Message("record.reason.chosen"), True, written)
    if unit is not None:
        choice = replace(choice, unit=unit, written=True, certain=True)
    return choice
