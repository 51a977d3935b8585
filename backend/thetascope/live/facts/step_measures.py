"""Numbers that a step of a lesson measures in a session: times to settle, levels, delays of the detector."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from thetascope_schemas.experiment.diagnosis import Alarm
from thetascope_schemas.service.learning.course import CourseStep
from thetascope_schemas.service.learning.judged import Judged
from thetascope_schemas.service.learning.measures import (
    SKETCH,
    Condition,
    Counts,
    Crosses,
    Diverged,
    Found,
    GainNow,
    Level,
    Measure,
    Settles,
)

_SLACK = 1e-6
"""Seconds by which times of rows may miss a time in decimals."""


@dataclass(frozen=True)
class Readings:
    """A session between the mark of a step and its end.

    Args:
        t: times of the rows in s, increasing.
        read: returns a column of the session's rows by name, of the shape of t.
        mark: time in s at which the step was started; times of measures count from it.
        alarms: of the detector, with the times at which they were raised.
        diverged: time in s of each observer that has diverged, by label.
        gains: the present gains by label and name.
        dial: the level that the student has set, None where the step has no such dial.
        sketch: the values that the student has drawn, at equal times from the mark to `seconds` after it.
        seconds: the time that the step lets pass.
    """

    t: np.ndarray
    read: Callable[[str], np.ndarray]
    mark: float
    alarms: Sequence[Alarm] = ()
    diverged: Mapping[str, float] = field(default_factory=dict)
    gains: Mapping[str, Mapping[str, object]] = field(default_factory=dict)
    dial: float | None = None
    sketch: Sequence[float] | None = None
    seconds: float = 0.0

    def column(self, name: str) -> np.ndarray:
        """Return a column of the session, or what was drawn, straight between its values; NaN where nothing was."""
        if name != SKETCH:
            return self.read(name)
        if self.sketch is None:
            return np.full(self.t.shape, np.nan)
        knots = self.mark + np.linspace(0.0, self.seconds, len(self.sketch))
        return np.interp(self.t, knots, self.sketch)

    def rows(self, start: float, end: float | None) -> slice:
        """Return the rows from `start` to `end`, in s after the mark."""
        first = int(np.searchsorted(self.t, self.mark + start - _SLACK))
        last = self.t.size if end is None else int(np.searchsorted(self.t, self.mark + end + _SLACK))
        return slice(first, max(first, last))


def columns_of(step: CourseStep) -> tuple[str, ...]:
    """Return the columns of a session that the measures of a step read."""
    names: dict[str, None] = {}
    for measure in step.measures.values():
        for attribute in ("column", "to", "minus"):
            if isinstance(name := getattr(measure, attribute, None), str) and name != SKETCH:
                names[name] = None
    return tuple(names)


def earliest(step: CourseStep) -> float:
    """Return the time in s after the mark from which the measures of a step read rows: 0, or before the mark."""
    starts = [getattr(one, "start", getattr(one, "since", 0.0)) for one in step.measures.values()]
    return min([0.0, *starts])


def measured(step: CourseStep, readings: Readings) -> dict[str, float | None]:
    """Return the number of every measure of a step; None: nothing was measured."""
    return {name: _value(measure, readings) for name, measure in step.measures.items()}


def judge(step: CourseStep, readings: Readings) -> Judged:
    """Return what readings of a session show about a step."""
    values = measured(step, readings)
    return Judged(
        values=values,
        right=tuple(holds(answer.right_if, values) for answer in step.answers),
        met=holds(step.right_if, values),
        saw=next((place for place, saw in enumerate(step.saw) if holds(saw.when, values)), None),
    )


def holds(conditions: Sequence[Condition], values: Mapping[str, float | None]) -> bool:
    """Return whether all conditions hold for the measured numbers."""
    return all(condition.holds(values[condition.measure]) for condition in conditions)


def _value(measure: Measure, readings: Readings) -> float | None:
    match measure:
        case Settles():
            value = _settling(measure, readings)
        case Level():
            value = _level(measure, readings)
        case Crosses():
            value = _crossing(measure, readings)
        case Counts():
            value = _count(measure, readings)
        case Found():
            value = _delay(measure, readings)
        case Diverged():
            value = readings.diverged.get(measure.observer)
            value = None if value is None else value - readings.mark
        case GainNow():
            gain = readings.gains.get(measure.observer, {}).get(measure.gain)
            value = float(gain) if isinstance(gain, int | float) else None
    return None if value is None or not math.isfinite(value) else value


def _settling(measure: Settles, readings: Readings) -> float | None:
    rows = readings.rows(measure.since, None)
    to = readings.column(measure.to)[rows] if isinstance(measure.to, str) else measure.to
    outside = ~(np.abs(readings.column(measure.column)[rows] - to) <= measure.within)
    if not outside.size or outside[-1]:
        return None
    first = int(np.flatnonzero(outside)[-1]) + 1 if outside.any() else 0
    return float(readings.t[rows][first] - readings.mark - measure.since)


def _level(measure: Level, readings: Readings) -> float | None:
    values = _values(measure, readings)[readings.rows(measure.start, measure.end)]
    if not values.size:
        return None
    take = {"mean": np.mean, "std": np.std, "max": np.max, "min": np.min, "last": lambda all: all[-1]}
    return float(take[measure.take](values))


def _values(measure: Level | Crosses | Counts, readings: Readings) -> np.ndarray:
    """Return a column, or the difference of two."""
    values = readings.column(measure.column)
    return values if measure.minus is None else values - readings.column(measure.minus)


def _crossing(measure: Crosses, readings: Readings) -> float | None:
    rows = readings.rows(measure.since, None)
    level = readings.dial if measure.level == "dial" else measure.level
    if level is None:
        return None
    values = _values(measure, readings)[rows]
    beyond = {"above": values > level, "below": values < level, "beyond": np.abs(values) > level}[measure.side]
    if not beyond.any():
        return None
    return float(readings.t[rows][int(np.argmax(beyond))] - readings.mark - measure.since)


def _count(measure: Counts, readings: Readings) -> float | None:
    level = readings.dial if measure.level == "dial" else measure.level
    if level is None:
        return None
    beyond = np.abs(_values(measure, readings)[readings.rows(measure.start, measure.end)]) > level
    return float(np.count_nonzero(np.diff(beyond.astype(np.int8), prepend=0) > 0))


def _delay(measure: Found, readings: Readings) -> float | None:
    since = readings.mark + measure.since
    times = [
        alarm.t
        for alarm in readings.alarms
        if not alarm.observer and alarm.t >= since and measure.channel in (None, alarm.channel)
    ]
    return min(times) - since if times else None
