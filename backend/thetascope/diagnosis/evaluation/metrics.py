"""Errors, settling and noise of estimates, from columns of samples: pure NumPy, no web, no schema.

Conventions: an error is estimate − truth; rows that are not finite (an observer after it diverged) are left out of a
mean, and a measure without a finite row is `None`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from thetascope.diagnosis.evaluation.instants import slack
from thetascope.engine.model.result import ObserverReport

LAST = 0.1
"""The share of a run, at its end, over which the final mean and scatter are taken."""
SETTLE = 0.1
"""An estimate has settled when it stays within this fraction of the step it follows."""
REACH = 4.0
"""Standard deviations that noise may move an estimate."""
_LATEST = 0.9  # share of the rows by which an estimate must have settled


class Columns(Protocol):
    """Columns of samples by name, all of shape (rows,); `t` is the time in s."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        ...

    def column(self, name: str, /) -> np.ndarray:
        """Return one column by name, shape (rows,). Raises KeyError."""
        ...


class Recorded(Columns, Protocol):
    """Columns with the reports of their observers: a `Result`."""

    @property
    def observers(self) -> tuple[ObserverReport, ...]:
        """The reports of the observers."""
        ...


class Site(Protocol):
    """The place where a fault acts: kind "channel" or "output", and its name."""

    @property
    def kind(self) -> str:
        """ "channel" or "output"."""
        ...

    @property
    def name(self) -> str:
        """Name of the channel or the output."""
        ...


class FaultOverTime(Protocol):
    """A fault of a spec: site, shape, onset and end in s."""

    @property
    def site(self) -> Site:
        """The place where it acts."""
        ...

    @property
    def shape(self) -> str:
        """Its shape over time, for example "step"."""
        ...

    @property
    def onset(self) -> float:
        """Time in s at which it appears."""
        ...

    @property
    def end(self) -> float | None:
        """Time in s at which it disappears; None: it stays."""
        ...


@dataclass(frozen=True)
class Settling:
    """How an estimate followed one step of one fault. Times in s."""

    channel: str
    at: float
    size: float
    """New value minus old value, in the channel's unit."""
    within: float
    """The tolerance: half-width of the band around the truth, in the channel's unit."""
    reached: float | None
    """From the step until the estimate is first in the band; None: it never is, before `until`."""
    time: float | None
    """From the step until the estimate stays in the band up to `until`; None: it does not (see `settling_time`)."""
    until: float
    """The next change of any fault, or the end of the run."""


def observers_of(result: Recorded) -> list[str]:
    """Return the labels of the result's observers, in the order of the spec."""
    return [report.label for report in result.observers]


def names_after(result: Columns, prefix: str) -> list[str]:
    """Return the rest of every column name that begins with `prefix`: names_after(result, "x.") lists the states."""
    return [name[len(prefix) :] for name in result.names if name.startswith(prefix)]


def _number(value) -> float | None:
    return float(value) if np.isfinite(value) else None


def rmse(estimate: np.ndarray, truth: np.ndarray) -> float | None:
    """Return the root mean square of estimate − truth over the rows where both are finite; None without such rows."""
    with np.errstate(over="ignore", invalid="ignore"):
        square = (estimate - truth) ** 2
    square = square[np.isfinite(square)]
    return _number(np.sqrt(square.mean())) if square.size else None


def settling_time(t: np.ndarray, error: np.ndarray, start: float, until: float, within: float) -> float | None:
    """Return the seconds from `start` until |error| ≤ within for every later row before `until`;
    None if that never comes.

    t, error: shape (rows,). Rows at `until` and later belong to the next event and are ignored. An estimate that
    leaves the band in the last tenth of the rows has not settled.
    """
    rows = _between(t, start, until)
    if rows.size == 0:
        return None
    outside = np.flatnonzero(~(np.abs(error[rows]) <= within))  # "not ≤": NaN counts as outside
    if outside.size == 0:
        return 0.0
    first = outside[-1] + 1
    return float(t[rows[first]] - start) if first < _LATEST * rows.size else None


def reaching_time(t: np.ndarray, error: np.ndarray, start: float, until: float, within: float) -> float | None:
    """Return the seconds from `start` until |error| ≤ within for the first time;
    None if that never happens before `until`."""
    rows = _between(t, start, until)
    inside = np.flatnonzero(np.abs(error[rows]) <= within)
    return float(t[rows[inside[0]]] - start) if inside.size else None


def _between(t: np.ndarray, start: float, until: float) -> np.ndarray:
    """Return the rows at `start` or later, before `until`."""
    return np.arange(*np.searchsorted(t, (start - slack(t), until - slack(t))))


def straight_line_noise(t: np.ndarray, values: np.ndarray) -> float | None:
    """Return the standard deviation of values about their least-squares line over t; None with fewer than 3 of them.

    t, values: shape (rows,); rows that are not finite are left out.
    """
    rows = np.isfinite(values)
    if rows.sum() < 3:
        return None
    x, v = t[rows] - t[rows].mean(), values[rows] - values[rows].mean()
    spread = float(x @ x)
    rest = v - (float(x @ v) / spread if spread > 0 else 0.0) * x
    return _number(np.sqrt(np.mean(rest**2)))


def too_noisy(t: np.ndarray, error: np.ndarray, within: float) -> bool:
    """Return whether an estimate has reached the truth, but its noise alone keeps leaving the band ± within.

    t, error: shape (rows,). In the later half the mean is inside the band, single values are not, and REACH standard
    deviations exceed the band.
    """
    half = slice(t.size // 2, None)
    late = error[half]
    if late.size == 0 or not np.isfinite(late).all():
        return False
    spread = straight_line_noise(t[half], late)
    outside = bool((np.abs(late) > within).any())
    return outside and abs(float(late.mean())) < within / 2 and spread is not None and REACH * spread > within


def step_changes(faults: Iterable[FaultOverTime], horizon: float) -> list[tuple[str, float]]:
    """Return (channel, time) of every jump that a step fault makes: its onset, and its end if it has one.

    `faults` are the experiment's; a fault on a measurement is not a step of θ and is skipped.
    """
    found: set[tuple[str, float]] = set()
    for fault in faults:
        if fault.site.kind != "channel" or fault.shape != "step":
            continue
        found.update((fault.site.name, at) for at in (fault.onset, fault.end) if at is not None and 0 < at < horizon)
    return sorted(found, key=lambda event: event[1])


def event_times(faults: Iterable[FaultOverTime]) -> list[float]:
    """Return every time at which any fault begins or ends, in order."""
    return sorted({at for fault in faults for at in (fault.onset, fault.end) if at is not None})


def settling(
    result: Columns, label: str, steps: Sequence[tuple[str, float]], events: Sequence[float], fraction: float = SETTLE
) -> list[Settling]:
    """Return how observer `label` followed each step (channel, time); channels that it does not estimate are left out.

    The band is `fraction` of the step's size around the true θ. Each step is judged until the next of `events`, which
    disturbs the estimate too.
    """
    t, answer = result.column("t"), []
    for channel, at in steps:
        estimate = f"{label}.theta.{channel}"
        if estimate not in result.names:
            continue
        truth = result.column(f"theta.{channel}")
        row = int(np.searchsorted(t, at - slack(t)))
        if row == 0 or row >= t.size:
            continue
        size = float(truth[row] - truth[row - 1])
        until = min((e for e in events if e > at + slack(t)), default=np.inf)
        end = float(t[-1])
        error = result.column(estimate) - truth
        window = (at, until if until < end else np.inf, fraction * abs(size))
        answer.append(
            Settling(
                channel,
                float(at),
                size,
                window[2],
                reaching_time(t, error, *window),
                settling_time(t, error, *window),
                min(until, end),
            )
        )
    return answer


def final_values(result: Columns, label: str, last: float = LAST) -> dict[str, dict[str, float | None]]:
    """Return by channel truth, estimate and error at the last row; mean and std of the error over the last share.

    Of a record, whose truth is not known, the estimate, and its own std over the last share.
    """
    t, answer = result.column("t"), {}
    rows = t >= t[-1] - last * (t[-1] - t[0])
    for channel in names_after(result, f"{label}.theta."):
        estimate = result.column(f"{label}.theta.{channel}")
        if f"theta.{channel}" not in result.names:  # a record
            spread = _number(estimate[rows].std())
            ending = {"truth": None, "estimate": _number(estimate[-1]), "error": None}
            answer[channel] = ending | {"mean_error": None, "std": spread}
            continue
        truth = result.column(f"theta.{channel}")
        with np.errstate(over="ignore", invalid="ignore"):
            tail = (estimate - truth)[rows]
            mean, std = tail.mean(), tail.std()
        answer[channel] = {
            "truth": _number(truth[-1]),
            "estimate": _number(estimate[-1]),
            "error": _number(estimate[-1] - truth[-1]),
            "mean_error": _number(mean),
            "std": _number(std),
        }
    return answer


def state_rmse(result: Columns, label: str, last: float | None = None) -> dict[str, float | None]:
    """Return the RMSE of every state that observer `label` estimates,
    over the whole run or (last=0.1) its last share."""
    t = result.column("t")
    rows = slice(None) if last is None else t >= t[-1] - last * (t[-1] - t[0])
    states = [s for s in names_after(result, "x.") if f"{label}.x.{s}" in result.names]
    return {s: rmse(result.column(f"{label}.x.{s}")[rows], result.column(f"x.{s}")[rows]) for s in states}


def summary(result: Recorded, faults: Iterable[FaultOverTime]) -> dict[str, dict[str, Any]]:
    """Return the comparison table, ready for JSON: observer label → its measures, assumptions and divergence.

    Keys of each: kind, title, diverged (None or {time, cause}), rmse and rmse_end (per state; the latter over the last
    tenth of the run), theta (`final_values`), settling (one entry per step of a fault), checks.
    """
    faults = list(faults)
    horizon = float(result.column("t")[-1])
    steps, events = step_changes(faults, horizon), event_times(faults)
    answer = {}
    for report in result.observers:
        lost = report.diverged
        answer[report.label] = {
            "kind": report.kind,
            "title": str(report.title),
            "diverged": None if lost is None else {"time": lost.time, "cause": str(lost.cause)},
            "rmse": state_rmse(result, report.label),
            "rmse_end": state_rmse(result, report.label, LAST),
            "theta": final_values(result, report.label),
            "settling": [vars(s) for s in settling(result, report.label, steps, events)],
            "checks": [
                {
                    **vars(check),
                    "name": str(check.name),
                    "text": str(check.text),
                    "value": _finite(check.value),
                    "threshold": _finite(check.threshold),
                }
                for check in report.checks
            ],
        }
    return answer


def _finite(value: float | None) -> float | None:
    """Return a number, or None for infinity, which JSON does not have."""
    return None if value is None else _number(value)
