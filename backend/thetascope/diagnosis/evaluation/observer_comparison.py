"""Observers compared on the same data: errors between fault events, settling, faults found and missed, cost. Pure NumPy.

Terms. A fault *event* is the onset or the end of a fault, in a channel of the model or on a measurement. *Windows* lie
between consecutive events; an observer without a number in some row of a window has none for the window, because it was
not judged on the same data. A channel's fault *is there* between two events of that channel if the true θ is not zero
everywhere between them; a fault on a measurement is there from onset to end.

How an alarm is judged, at the time t at which it was raised:

- It *names* a fault if its channel or one of its alternatives is the fault's channel. A fault that the observer has no
  channel for, one on a measurement above all, is named by an alarm "not explained by the model" whose output is the
  fault's, or that names no output.
- A fault is *found* by the first alarm that names it from its onset on and before the next event of its channel or
  output; the *delay* is counted from the onset. If there is none, but one that names it as its first choice was on at
  the onset, so that none could be raised, the fault is *covered*, neither found nor missed. Otherwise it is *missed*.
- An alarm is *false* if no fault is there and none was within the grace before t: the estimates need that long to come
  back after a fault. It is an *isolation error* if there is or was one and it names none of these.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.evaluation.metrics import event_times, observers_of, settling, step_changes

DETECTOR = "detector"
"""Stands for the detector among the observers' labels."""
MOST_WINDOWS = 64
GRACE = 0.05
"""Grace as a share of the run, where no calibration says how long an observer takes to settle."""
BANDS = (0.1, 0.05)
"""Shares of a step's size within which an estimate is taken to have settled."""
FOUND, COVERED, MISSED = "found", "covered", "missed"
_SAME_INSTANT = 1e-9
_AS_GOOD = 0.01


@dataclass(frozen=True)
class Window:
    """From one event to the next, in s."""

    start: float
    end: float


@dataclass(frozen=True)
class Step:
    """How long after a step of a channel's θ an estimate stays within 10 % and 5 % of its size; None: it does not."""

    channel: str
    at: float
    size: float
    ten: float | None
    five: float | None


@dataclass(frozen=True)
class Verdict:
    """What became of one fault. ``delay`` in s where it was found; ``alternative``: only among an alarm's alternatives."""

    kind: str  # channel or output
    name: str
    onset: float
    until: float | None  # None: the end of the run
    outcome: str  # FOUND, COVERED, MISSED
    delay: float | None = None
    alternative: bool = False


@dataclass(frozen=True)
class Row:
    """One observer. Errors by column name ("x.x1", "theta.theta1"), a number a window, None where it has none.

    The counts, and ``verdicts``, are None where no tests watched the observer.
    """

    label: str
    rmse: dict[str, tuple[float | None, ...]]
    peak: dict[str, tuple[float | None, ...]]
    steps: tuple[Step, ...]
    verdicts: tuple[Verdict, ...] | None
    false_alarms: int | None
    isolation_errors: int | None
    grace: float
    cost: float | None  # processor seconds per simulated second

    def count(self, outcome: str) -> int | None:
        """How many faults were found, covered or missed; None where nothing watched."""
        return None if self.verdicts is None else sum(v.outcome == outcome for v in self.verdicts)

    @property
    def delay(self) -> float | None:
        """Median delay of the faults found, in s."""
        delays = [v.delay for v in self.verdicts or () if v.delay is not None]
        return float(np.median(delays)) if delays else None


@dataclass(frozen=True)
class Comparison:
    """All observers of a run, in the order of the spec."""

    windows: tuple[Window, ...]
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Presence:
    """When a fault is there: in [onset, until), infinite where it stays, and what stands in an alarm that names it."""

    kind: str
    name: str
    onset: float
    until: float


def compare(result, faults: Iterable, findings: Mapping[str, object]) -> Comparison:
    """Compare the observers of a result, and the detector where it watched.

    result: the run's columns, ``observers`` and ``costs`` (label → processor seconds per simulated second).
    faults: the experiment's, with ``onset``, ``end``, ``shape`` and ``channel`` or ``output``.
    findings: label → what its tests said, with ``alarms``, ``calibration`` and ``note``; the detector's is DETECTOR.
    """
    faults = list(faults)
    costs = getattr(result, "costs", {})
    spans = windows(faults, result.column("t"))
    there = presences(result, faults)
    horizon = float(result.column("t")[-1])
    return Comparison(
        spans,
        tuple(
            _row(result, label, faults, spans, there, findings.get(label), costs.get(label), horizon)
            for label in (*observers_of(result), *([DETECTOR] if watched(findings.get(DETECTOR)) else []))
        ),
    )


def _row(result, label: str, faults: list, spans, there, finding, cost, horizon: float) -> Row:
    rmse, peak = errors(result, label, spans)
    calibration = getattr(finding, "calibration", None)
    grace = GRACE * horizon if calibration is None else max(float(calibration.from_time), 0.0)
    verdicts = false = wrong = None
    if watched(finding):
        alarms = sorted(finding.alarms, key=lambda alarm: alarm.t)
        mine = "theta." if label == DETECTOR else f"{label}.theta."
        own = {name.removeprefix(mine) for name in result.names if name.startswith(mine)}
        verdicts = tuple(found(alarms, fault, own) for fault in onsets(faults, there))
        false, wrong = mistakes(alarms, there, own, grace)
    return Row(label, rmse, peak, steps(result, label, faults), verdicts, false, wrong, grace, cost)


def watched(finding) -> bool:
    """Whether tests watched an observer: it has alarms or calibrated thresholds, or says nothing against it."""
    if finding is None:
        return False
    return bool(finding.alarms) or getattr(finding, "calibration", None) is not None or not getattr(finding, "note", "")


# ---- errors -----------------------------------------------------------------------------------------------------------


def windows(faults: Sequence, t: np.ndarray) -> tuple[Window, ...]:
    """The windows of a run; of more than MOST_WINDOWS the shortest are joined to those after them."""
    inside = [at for at in event_times(faults) if t[0] + _SAME_INSTANT < at < t[-1] - _SAME_INSTANT]
    edges = [float(t[0]), *map(float, inside), float(t[-1])]
    while len(edges) - 1 > MOST_WINDOWS:
        del edges[1 + int(np.argmin(np.diff(edges)[:-1]))]
    return tuple(Window(a, b) for a, b in pairwise(edges))


def errors(result, label: str, spans: Sequence[Window]) -> tuple[dict, dict]:
    """RMSE and largest |estimate − truth| of every state and fault that the observer estimates, by column and window."""
    t = result.column("t")
    cuts = np.searchsorted(t, [w.start - _SAME_INSTANT for w in spans])
    cuts = [*map(int, cuts), t.size]
    rmse, peak = {}, {}
    for name in result.names:
        estimate = f"{label}.{name}"
        if name.startswith(("x.", "theta.")) and estimate in result.names:
            truth, value = result.column(name), result.column(estimate)
            pairs = [_error(truth[a:b], value[a:b]) for a, b in pairwise(cuts)]
            rmse[name], peak[name] = (tuple(column) for column in zip(*pairs, strict=True))
    return rmse, peak


def _error(truth: np.ndarray, estimate: np.ndarray) -> tuple[float | None, float | None]:
    """RMSE and peak over the rows that have a truth; None, None if there are none or an estimate is missing."""
    with np.errstate(over="ignore", invalid="ignore"):
        error = np.abs(estimate - truth)[np.isfinite(truth)]
        mean = float(np.sqrt(np.mean(error**2))) if error.size else np.inf
    return (mean, float(error.max())) if np.isfinite(mean) else (None, None)


def steps(result, label: str, faults: Sequence) -> tuple[Step, ...]:
    """How the observer followed every step of a channel that it estimates, see `metrics.settling`."""
    horizon = float(result.column("t")[-1])
    changes, events = step_changes(faults, horizon), event_times(faults)
    ten, five = (settling(result, label, changes, events, share) for share in BANDS)
    return tuple(Step(a.channel, a.at, a.size, a.time, b.time) for a, b in zip(ten, five, strict=True) if a.size)


# ---- alarms -----------------------------------------------------------------------------------------------------------


def presences(result, faults: Sequence) -> tuple[Presence, ...]:
    """When which fault is there, in order of time, within the run."""
    t = result.column("t")
    horizon = float(t[-1])
    outputs = [Presence(*f.site, f.onset, _end(f, horizon)) for f in faults if f.site.kind == "output"]
    channels = []
    for name in sorted({f.site.name for f in faults if f.site.kind == "channel"}):
        mine = [f for f in faults if f.site == ("channel", name)]
        edges = [at for at in event_times(mine) if at < horizon] + [np.inf]
        theta = result.column(f"theta.{name}")
        for start, end in pairwise(edges):
            covered = any(f.onset <= start < _end(f, horizon) for f in mine)
            rows = theta[slice(*np.searchsorted(t, [start - _SAME_INSTANT, end - _SAME_INSTANT]))]
            if covered and (rows.any() or not rows.size):
                channels.append(Presence("channel", name, float(start), float(end)))
    return tuple(
        sorted((p for p in (*channels, *outputs) if p.onset < horizon), key=lambda p: (p.onset, p.kind, p.name))
    )


def _end(fault, horizon: float) -> float:
    return np.inf if fault.end is None or fault.end >= horizon else float(fault.end)


def onsets(faults: Sequence, there: Sequence[Presence]) -> list[Presence]:
    """Of the presences, those that begin with a fault's onset: the faults to be found, each once.

    A fault on an output is to be found before the next one on that output begins.
    """
    begun = {(*f.site, f.onset) for f in faults}
    one = {}
    for p in there:
        if (p.kind, p.name, p.onset) in begun:
            later = [o for kind, name, o in begun if (kind, name) == (p.kind, p.name) and o > p.onset]
            one[p.kind, p.name, p.onset] = Presence(p.kind, p.name, p.onset, min([p.until, *later]))
    return list(one.values())


def names(alarm, fault: Presence, own: set[str]) -> str:
    """How an alarm names a fault: "first" choice, "alternative", or "" not at all. ``own``: channels of the observer."""
    if fault.kind == "channel" and fault.name in own:
        if alarm.channel == fault.name:
            return "first"
        return "alternative" if fault.name in alarm.alternatives else ""
    if alarm.kind != "unexplained":
        return ""
    return "first" if fault.kind == "channel" or alarm.output in ("", fault.name) else ""


def found(alarms: Sequence, fault: Presence, own: set[str]) -> Verdict:
    """What the observer's alarms (in order of time) made of a fault."""
    verdict = (fault.kind, fault.name, fault.onset, fault.until if np.isfinite(fault.until) else None)
    covered = False
    for alarm in alarms:
        how = names(alarm, fault, own)
        if alarm.t < fault.onset - _SAME_INSTANT:
            covered |= how == "first" and (alarm.cleared is None or alarm.cleared > fault.onset)
        elif how and alarm.t < fault.until - _SAME_INSTANT:
            return Verdict(*verdict, FOUND, max(0.0, float(alarm.t - fault.onset)), how == "alternative")
    return Verdict(*verdict, COVERED if covered else MISSED)


def mistakes(alarms: Sequence, there: Sequence[Presence], own: set[str], grace: float) -> tuple[int, int]:
    """How many alarms were false, and how many named none of the faults that were there."""
    false = wrong = 0
    for alarm in alarms:
        near = [p for p in there if p.onset - _SAME_INSTANT <= alarm.t <= p.until + grace + _SAME_INSTANT]
        false += not near
        wrong += bool(near) and not any(names(alarm, p, own) for p in near)
    return false, wrong


def best(values: Sequence[float | None]) -> frozenset[int]:
    """Places of the smallest value and of those within 1 % of it; none where there is no other value to be better than."""
    known = [v for v in values if v is not None]
    limit = min(known, default=0.0)
    limit += _AS_GOOD * abs(limit)
    if not known or max(known) <= limit:
        return frozenset()
    return frozenset(place for place, value in enumerate(values) if value is not None and value <= limit)
