"""Observers compared over one window of a session: error, noise and time to settle, with the measures that runs use."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from thetascope.diagnosis.evaluation.instants import slack
from thetascope.diagnosis.evaluation.metrics import (
    Columns,
    FaultOverTime,
    event_times,
    settling,
    straight_line_noise,
    too_noisy,
)
from thetascope.diagnosis.evaluation.observer_comparison import error

NOISE_SHARE = 0.25
"""The share of the window, at its end, over which noise is measured."""
FEWEST = 3  # rows from which on settling is judged

Settled = Literal["settled", "not-yet", "too-noisy", "unknown"]


@dataclass(frozen=True)
class Samples:
    """Columns of rows, some after each other: data has the shape (columns, rows)."""

    names: tuple[str, ...]
    data: np.ndarray

    def column(self, name: str, /) -> np.ndarray:
        """Return a column, shape (rows,)."""
        return self.data[self.names.index(name)]


@dataclass(frozen=True)
class ObserverWindow:
    """The figures of one observer over a window.

    Attributes:
        rmse: of the state; None if the observer has no value in some row, since it was not judged on the same data.
        noise: standard deviation of θ̂ about its straight line, over the last quarter.
        settled: seconds from the step of the newest fault until θ̂ stays within 10 % of its size.
        outcome: settled; not yet; too noisy to stay in the band; unknown without a step or an estimate.
    """

    label: str
    rmse: float | None
    noise: float | None
    settled: float | None = None
    outcome: Settled = "unknown"


def window_figures(window: Columns, label: str, state: str, channel: str | None) -> ObserverWindow:
    """Return RMSE and noise of an observer over the rows of a window; `t` is one of the columns."""
    rmse = None
    if f"x.{state}" in window.names and f"{label}.x.{state}" in window.names:
        rmse = error(window.column(f"x.{state}"), window.column(f"{label}.x.{state}"))[0]
    noise = None
    if channel is not None and f"{label}.theta.{channel}" in window.names:
        noise = late_noise(window, f"{label}.theta.{channel}")
    return ObserverWindow(label, rmse, noise)


def late_noise(window: Columns, name: str) -> float | None:
    """Return the standard deviation of a column about its straight line, over the last quarter of the window."""
    t = window.column("t")
    if t.size == 0:
        return None
    late = t >= t[-1] - NOISE_SHARE * (t[-1] - t[0]) - slack(t)
    return straight_line_noise(t[late], window.column(name)[late])


def settling_of_step(
    rows: Columns, label: str, channel: str, fault: FaultOverTime, faults: Sequence[FaultOverTime]
) -> tuple[float | None, Settled]:
    """Return how an observer has followed the step of a fault so far.

    rows: from the row before the onset up to now, or to the next event.
    """
    name = f"{label}.theta.{channel}"
    if fault.shape != "step" or name not in rows.names:
        return None, "unknown"
    steps = settling(rows, label, [(channel, fault.onset)], event_times(faults))
    t = rows.column("t")
    after = t >= fault.onset - slack(t)
    distance = (rows.column(name) - rows.column(f"theta.{channel}"))[after]
    if not steps or after.sum() < FEWEST or not np.isfinite(distance).any():
        return None, "unknown"
    if steps[0].time is not None:
        return steps[0].time, "settled"
    return None, "too-noisy" if too_noisy(t[after], distance, steps[0].within) else "not-yet"
