"""How good were the estimates? Numbers from a `Result` alone: pure NumPy, no web, no schema.

Conventions: an error is estimate − truth; rows that are not finite (an observer after it diverged) are left out of a
mean, and a measure that has no finite row is `None`, never a made-up number.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

LAST = 0.1
"""The share of a run, at its end, over which the final mean and scatter are taken."""
SETTLE = 0.1
"""An estimate has settled when it stays within this fraction of the step it follows."""
_SAME_INSTANT = 1e-9


@dataclass(frozen=True)
class Settling:
    """How an estimate followed one step of one fault. Times in seconds."""

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


def observers_of(result) -> list[str]:
    """The labels of the result's observers, in the order of the spec."""
    return [report.label for report in result.observers]


def names_after(result, prefix: str) -> list[str]:
    """What follows `prefix` in the columns that begin with it: names_after(result, "x.") lists the states."""
    return [name[len(prefix) :] for name in result.names if name.startswith(prefix)]


def _number(value) -> float | None:
    return float(value) if np.isfinite(value) else None


def rmse(estimate: np.ndarray, truth: np.ndarray) -> float | None:
    """Root mean square of estimate − truth over the rows where both are finite; None if there is none."""
    with np.errstate(over="ignore", invalid="ignore"):
        square = (estimate - truth) ** 2
    square = square[np.isfinite(square)]
    return _number(np.sqrt(square.mean())) if square.size else None


def settling_time(t: np.ndarray, error: np.ndarray, start: float, until: float, within: float) -> float | None:
    """Seconds from `start` until |error| ≤ within for every later row before `until`; None if that never comes.

    t, error: shape (rows,). The rows at `until` and later belong to the next event and are not looked at. An estimate that
    noise still throws out of the band in the last tenth of the time has not settled, whatever its very last rows are.
    """
    rows = _between(t, start, until)
    if rows.size == 0:
        return None
    outside = np.flatnonzero(~(np.abs(error[rows]) <= within))  # "not ≤": NaN counts as outside
    if outside.size == 0:
        return 0.0
    first = outside[-1] + 1
    return float(t[rows[first]] - start) if first < 0.9 * rows.size else None


def reaching_time(t: np.ndarray, error: np.ndarray, start: float, until: float, within: float) -> float | None:
    """Seconds from `start` until |error| ≤ within for the first time; None if that never happens before `until`."""
    rows = _between(t, start, until)
    inside = np.flatnonzero(np.abs(error[rows]) <= within)
    return float(t[rows[inside[0]]] - start) if inside.size else None


def _between(t: np.ndarray, start: float, until: float) -> np.ndarray:
    """The rows at `start` or later, before `until`."""
    return np.arange(*np.searchsorted(t, (start - _SAME_INSTANT, until - _SAME_INSTANT)))


def step_changes(faults: Iterable, horizon: float) -> list[tuple[str, float]]:
    """(channel, time) of every jump that a step fault makes: its onset, and its end where it has one.

    `faults` are the experiment's; a fault on a measurement is not a step of θ and is passed over.
    """
    found = set()
    for fault in faults:
        if fault.site.kind != "channel" or fault.shape != "step":
            continue
        found.update((fault.site.name, at) for at in (fault.onset, fault.end) if at is not None and 0 < at < horizon)
    return sorted(found, key=lambda event: event[1])


def event_times(faults: Iterable) -> list[float]:
    """Every time at which any fault begins or ends, in order."""
    return sorted({at for fault in faults for at in (fault.onset, fault.end) if at is not None})


def settling(
    result, label: str, steps: Sequence[tuple[str, float]], events: Sequence[float], fraction: float = SETTLE
) -> list[Settling]:
    """How observer `label` followed each step (channel, time) of `steps`; channels that it does not estimate are left out.

    The band is `fraction` of the step's size around the true θ. Each step is judged until the next of `events`, because
    after it the estimate is being disturbed by something else.
    """
    t, answer = result.column("t"), []
    for channel, at in steps:
        estimate = f"{label}.theta.{channel}"
        if estimate not in result.names:
            continue
        truth = result.column(f"theta.{channel}")
        row = int(np.searchsorted(t, at - _SAME_INSTANT))
        if row == 0 or row >= t.size:
            continue
        size = float(truth[row] - truth[row - 1])
        until = min((e for e in events if e > at + _SAME_INSTANT), default=np.inf)
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


def final_values(result, label: str, last: float = LAST) -> dict[str, dict[str, float | None]]:
    """Per channel: truth, estimate and error at the last row; mean and std of the error over the last share of the run."""
    t, answer = result.column("t"), {}
    rows = t >= t[-1] - last * (t[-1] - t[0])
    for channel in names_after(result, f"{label}.theta."):
        if f"theta.{channel}" not in result.names:
            continue
        truth, estimate = result.column(f"theta.{channel}"), result.column(f"{label}.theta.{channel}")
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


def state_rmse(result, label: str, last: float | None = None) -> dict[str, float | None]:
    """RMSE of every state that observer `label` estimates, over the whole run or (last=0.1) its last share."""
    t = result.column("t")
    rows = slice(None) if last is None else t >= t[-1] - last * (t[-1] - t[0])
    states = [s for s in names_after(result, "x.") if f"{label}.x.{s}" in result.names]
    return {s: rmse(result.column(f"{label}.x.{s}")[rows], result.column(f"x.{s}")[rows]) for s in states}


def summary(result, faults: Iterable) -> dict[str, dict]:
    """The comparison table, ready for JSON: observer label → its measures, assumptions and divergence.

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
            "title": report.title,
            "diverged": None if lost is None else {"time": lost.time, "cause": lost.cause},
            "rmse": state_rmse(result, report.label),
            "rmse_end": state_rmse(result, report.label, LAST),
            "theta": final_values(result, report.label),
            "settling": [vars(s) for s in settling(result, report.label, steps, events)],
            "checks": [
                {**vars(check), "value": _finite(check.value), "threshold": _finite(check.threshold)}
                for check in report.checks
            ],
        }
    return answer


def _finite(value: float | None) -> float | None:
    """JSON has no infinity."""
    return None if value is None else _number(value)
