"""Numbers that are measured in the rows of a session or a run: times to settle, levels, rates, delays."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from thetascope_schemas.experiment.diagnosis import Alarm
from thetascope_schemas.service.learning.measures import (
    SKETCH,
    Counts,
    Crosses,
    Decays,
    Diverged,
    Found,
    GainNow,
    Level,
    Measure,
    Rises,
    Settles,
)

_SLACK = 1e-6
"""Seconds by which times of rows may miss a time in decimals."""


@dataclass(frozen=True)
class Readings:
    """The rows of a session between the mark of a step and its end, or those of a run.

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


def columns_read(measure: Measure) -> tuple[str, ...]:
    """Return the columns that a measure reads."""
    named = (getattr(measure, attribute, None) for attribute in ("column", "to", "minus"))
    return tuple(name for name in named if isinstance(name, str) and name != SKETCH)


def value_of(measure: Measure, readings: Readings) -> float | None:
    """Return the number of a measure; None: nothing was measured."""
    match measure:
        case Settles():
            value = _settling(measure, readings)
        case Level():
            value = _level(measure, readings)
        case Crosses():
            value = _crossing(measure, readings)
        case Counts():
            value = _count(measure, readings)
        case Decays():
            value = _decay(measure, readings)
        case Rises():
            value = _rises(measure, readings)
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
    rows = readings.rows(measure.since, measure.end)
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
    take = {
        "mean": np.mean,
        "std": np.std,
        "max": np.max,
        "min": np.min,
        "last": lambda all: all[-1],
        "rms": lambda all: np.sqrt(np.mean(all**2)),
    }
    return float(take[measure.take](values))


def _values(measure: Level | Crosses | Counts | Decays | Rises, readings: Readings) -> np.ndarray:
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


def _decay(measure: Decays, readings: Readings) -> float | None:
    rows = readings.rows(measure.start, measure.end)
    size = np.abs(_values(measure, readings)[rows])
    if size.size < 2 or not np.all(size > 0):
        return None
    t = readings.t[rows] - readings.t[rows].mean()
    return -float(t @ np.log(size) / (t @ t))  # the slope of the line of least squares


def _rises(measure: Rises, readings: Readings) -> float | None:
    values = _values(measure, readings)[readings.rows(measure.start, measure.end)]
    return float(np.mean(np.diff(values) > 0)) if values.size > 1 else None
