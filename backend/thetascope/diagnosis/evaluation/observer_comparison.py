"""Observers compared on the same data: errors between fault events, settling, faults found and missed, cost.
Pure NumPy.

A fault *event* is the onset or the end of a fault, in a channel of the model or on a measurement. *Windows* lie between
consecutive events. An observer without a number in some row of a window has none for the window, because it was not
judged on the same data. Which faults an observer found, and which of its alarms were false, is defined in verdicts.py.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from thetascope.diagnosis.evaluation.instants import slack
from thetascope.diagnosis.evaluation.metrics import (
    Columns,
    FaultOverTime,
    Recorded,
    event_times,
    observers_of,
    settling,
    step_changes,
)
from thetascope.diagnosis.evaluation.verdicts import (
    COVERED,
    FALSE,
    FOUND,
    ISOLATION_ERROR,
    MISSED,
    AlarmLike,
    FaultVerdict,
    Judgement,
    Presence,
    judge,
    presences,
)

__all__ = ["COVERED", "FOUND", "MISSED", "Comparison", "FaultVerdict", "Row", "Step", "Window", "best", "compare"]

DETECTOR = "detector"
"""Label of the detector among the labels of the observers."""
MOST_WINDOWS = 64
GRACE = 0.05
"""Grace as a share of the run, used without a calibration:
then it is not known how long an observer takes to settle."""
BANDS = (0.1, 0.05)
"""Shares of a step's size within which an estimate counts as settled."""
_AS_GOOD = 0.01


class CalibrationLike(Protocol):
    """Where thresholds come from, as far as verdicts need it."""

    @property
    def from_time(self) -> float: ...


class FindingsLike(Protocol):
    """The findings of the detector or of one observer's tests: the schema's `ObserverDiagnosis` or the like."""

    @property
    def alarms(self) -> Sequence[AlarmLike]: ...

    @property
    def calibration(self) -> CalibrationLike | None: ...

    @property
    def note(self) -> object: ...


@dataclass(frozen=True)
class Window:
    """The time from one event to the next, in s."""

    start: float
    end: float


@dataclass(frozen=True)
class Step:
    """Seconds after a step of a channel's θ until an estimate stays within 10 % and 5 % of its size; None: never."""

    channel: str
    at: float
    size: float
    ten: float | None
    five: float | None


@dataclass(frozen=True)
class Row:
    """One observer. Errors by column name ("x.x1", "theta.theta1"), one number per window,
    None if a window has no value.

    `judgement` is None, and so are the counts, if no tests ran on the observer. `cost` is in processor seconds per
    simulated second.
    """

    label: str
    rmse: dict[str, tuple[float | None, ...]]
    peak: dict[str, tuple[float | None, ...]]
    steps: tuple[Step, ...]
    judgement: Judgement | None
    grace: float
    cost: float | None

    @property
    def verdicts(self) -> tuple[FaultVerdict, ...] | None:
        """Return the outcome for each fault, in order of time."""
        return None if self.judgement is None else self.judgement.faults

    def count(self, verdict: str) -> int | None:
        """Return how many faults were found, covered or missed, or how many alarms have this verdict."""
        return None if self.judgement is None else self.judgement.count(verdict)

    @property
    def false_alarms(self) -> int | None:
        """Return how many alarms were false."""
        return self.count(FALSE)

    @property
    def isolation_errors(self) -> int | None:
        """Return how many alarms named none of the faults that were present."""
        return self.count(ISOLATION_ERROR)

    @property
    def delay(self) -> float | None:
        """Return the median delay of the faults found, in s."""
        delays = [v.delay for v in self.verdicts or () if v.delay is not None]
        return float(np.median(delays)) if delays else None


@dataclass(frozen=True)
class Comparison:
    """All observers of a run, in the order of the spec."""

    windows: tuple[Window, ...]
    rows: tuple[Row, ...]


def compare(result: Recorded, faults: Iterable[FaultOverTime], findings: Mapping[str, FindingsLike]) -> Comparison:
    """Compare the observers of a result, and the detector if it ran.

    Args:
        result: the run's columns, its `observers` and `costs` (label → processor seconds per simulated second).
        faults: the experiment's.
        findings: label → findings of its tests; the detector's is DETECTOR.
    """
    faults = list(faults)
    costs = getattr(result, "costs", {})
    spans = windows(faults, result.column("t"))
    present = presences_in(result, faults)
    labels = (*observers_of(result), *([DETECTOR] if tested(findings.get(DETECTOR)) else []))
    rows = []
    for label in labels:
        rmse, peak = errors(result, label, spans)
        finding = findings.get(label)
        grace = grace_of(finding, float(result.column("t")[-1]))
        judgement = judged(result, faults, label, finding, present)
        rows.append(Row(label, rmse, peak, steps(result, label, faults), judgement, grace, costs.get(label)))
    return Comparison(spans, tuple(rows))


def judged(
    result: Columns,
    faults: Sequence[FaultOverTime],
    label: str,
    finding: FindingsLike | None,
    present: tuple[Presence, ...] | None = None,
) -> Judgement | None:
    """Return the verdicts on an observer, or on the detector; None if no tests ran on it.

    ``present``: `presences_in(result, faults)`, where that is known.
    """
    if finding is None or not tested(finding):
        return None
    present = presences_in(result, faults) if present is None else present
    grace = grace_of(finding, float(result.column("t")[-1]))
    return judge(finding.alarms, faults, present, _estimated(result, label), grace)


def _estimated(result: Columns, label: str) -> set[str]:
    """Return the channels that an observer estimates; the detector knows all."""
    prefix = "theta." if label == DETECTOR else f"{label}.theta."
    return {name.removeprefix(prefix) for name in result.names if name.startswith(prefix)}


def tested(finding: FindingsLike | None) -> bool:
    """Return whether tests ran on an observer: it has alarms or calibrated thresholds, or no note says why not."""
    if finding is None:
        return False
    return bool(finding.alarms) or finding.calibration is not None or not finding.note


def grace_of(finding: FindingsLike | None, horizon: float) -> float:
    """Return the seconds after a fault in which an alarm is not false: the time that estimates take to settle."""
    calibration = None if finding is None else finding.calibration
    return GRACE * horizon if calibration is None else max(float(calibration.from_time), 0.0)


def presences_in(result: Columns, faults: Sequence[FaultOverTime]) -> tuple[Presence, ...]:
    """Return when the faults of a run are present, by the columns of the true θ."""
    t = result.column("t")

    def nonzero(channel: str, start: float, end: float) -> bool:
        rows = slice(*np.searchsorted(t, [start - slack(t), end - slack(t)]))
        theta = result.column(f"theta.{channel}")[rows if end < t[-1] else slice(rows.start, None)]
        return bool(theta.any()) or not theta.size

    return presences(faults, float(t[-1]), nonzero)


# ---- errors ----------------------------------------------------------------------------------------------------------


def windows(faults: Sequence[FaultOverTime], t: np.ndarray) -> tuple[Window, ...]:
    """Return the windows of a run with times t (s, shape (rows,)); beyond MOST_WINDOWS the shortest are merged."""
    inside = [at for at in event_times(faults) if t[0] + slack(t) < at < t[-1] - slack(t)]
    edges = [float(t[0]), *map(float, inside), float(t[-1])]
    while len(edges) - 1 > MOST_WINDOWS:
        del edges[1 + int(np.argmin(np.diff(edges)[:-1]))]
    return tuple(Window(a, b) for a, b in pairwise(edges))


def errors(
    result: Columns, label: str, spans: Sequence[Window]
) -> tuple[dict[str, tuple[float | None, ...]], dict[str, tuple[float | None, ...]]]:
    """Return RMSE and peak of |estimate − truth| of every state and fault that the observer estimates.

    Both map a column name ("x.x1") to one number for each window, None where the observer has no value in some row.
    """
    t = result.column("t")
    cuts = np.searchsorted(t, [w.start - slack(t) for w in spans])
    cuts = [*map(int, cuts), t.size]
    rmse, peak = {}, {}
    for name in result.names:
        estimate = f"{label}.{name}"
        if name.startswith(("x.", "theta.")) and estimate in result.names:
            truth, value = result.column(name), result.column(estimate)
            pairs = [error(truth[a:b], value[a:b]) for a, b in pairwise(cuts)]
            rmse[name], peak[name] = (tuple(column) for column in zip(*pairs, strict=True))
    return rmse, peak


def error(truth: np.ndarray, estimate: np.ndarray) -> tuple[float | None, float | None]:
    """Return RMSE and peak over the rows with a finite truth;
    None, None without such rows or if an estimate is missing."""
    with np.errstate(over="ignore", invalid="ignore"):
        distance = np.abs(estimate - truth)[np.isfinite(truth)]
        mean = float(np.sqrt(np.mean(distance**2))) if distance.size else np.inf
    return (mean, float(distance.max())) if np.isfinite(mean) else (None, None)


def steps(result: Columns, label: str, faults: Sequence[FaultOverTime]) -> tuple[Step, ...]:
    """Return how the observer followed every step of a channel that it estimates, see `metrics.settling`."""
    horizon = float(result.column("t")[-1])
    changes, events = step_changes(faults, horizon), event_times(faults)
    ten, five = (settling(result, label, changes, events, share) for share in BANDS)
    return tuple(Step(a.channel, a.at, a.size, a.time, b.time) for a, b in zip(ten, five, strict=True) if a.size)


def best(values: Sequence[float | None]) -> frozenset[int]:
    """Return the places of the smallest value and of those within 1 % of it; none without a larger value to compare."""
    known = [v for v in values if v is not None]
    limit = min(known, default=0.0)
    limit += _AS_GOOD * abs(limit)
    if not known or max(known) <= limit:
        return frozenset()
    return frozenset(place for place, value in enumerate(values) if value is not None and value <= limit)
