"""The interval of a step's onset, and the variance that its size gains because the onset is estimated too.

An onset that is wrong by a row leaves an error of the state estimate that takes time to decay, and the fitted size
compensates it. The energy E left after fitting all sizes with the onset at a row is, up to a constant, minus twice the
log-likelihood of that row. With weights exp(−E/2) over the rows around the best one,

    interval of the onset: the central 95 % of the weights, and up to one row earlier, since a fault that begins between
    two rows shows in the second one;
    size: the mean Σ weight size, and its variance given the onset plus Σ weight (size − mean)².
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.likelihood_fit import fit_sizes
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

_POINTS = 8  # onsets that are tried on either side of the best one
_ROUNDS = 5  # grids that are tried, at most: wider ones until the weights end inside, then one that just contains them
_OUTSIDE = 1e-3  # weight at an end of the grid above which it is too narrow
_TAIL = 0.025


@dataclass(frozen=True)
class OnsetUncertainty:
    """The interval (earliest, latest) of an onset in decisions; the mean size less the fitted one, and its variance."""

    earliest: float
    latest: float
    shift: float
    variance: float


def onset_uncertainty(
    window: ReplayWindow, events: tuple[Event, ...], k: int, width: float
) -> Steps[OnsetUncertainty | None]:
    """Return the uncertainty of the onset of event `k`, a step; None if it begins where tests begin or end.

    Args:
        window: the data.
        events: the fitted events.
        k: the place of the event.
        width: the approximate width of the onset's interval, in decisions.
    """
    if window.is_initial(events[k].onset_decision, True):
        return None
    rows = window.evidence.rows_per_decision
    step = max(1, round(width * rows / _POINTS))
    rounds = 0
    while True:
        rounds += 1
        onsets = _grid(window, events[k], step)
        if not len(onsets):
            return None
        hypotheses = [tuple(replace(e, onset=o) if i == k else e for i, e in enumerate(events)) for o in onsets]
        fits = yield from fit_sizes(window, hypotheses)
        weight = np.exp(-(fits.energy - fits.energy.min()) / 2)
        weight = weight / weight.sum()
        inside = np.abs(onsets[weight > _OUTSIDE] - events[k].onset).max() * rows  # the reach of the weights, in rows
        fitting = max(1, math.ceil((inside + step) / _POINTS))
        if rounds == _ROUNDS or fitting == step:
            break
        step = fitting if inside < (_POINTS - 1) * step else 4 * step
    cumulative = np.cumsum(weight)
    first, last = (int(np.searchsorted(cumulative, level)) for level in (_TAIL, 1 - _TAIL))
    mean = float(weight @ fits.size[:, k])
    variance = float(weight @ (fits.size[:, k] - mean) ** 2)
    margin = (step - 1) / rows
    earliest = max(onsets[first] - margin - 1 / rows, float(window.begin))
    latest = onsets[min(last, len(onsets) - 1)] + margin
    onset = events[k].onset
    return OnsetUncertainty(min(float(earliest), onset), max(float(latest), onset), mean - events[k].size, variance)


def _grid(window: ReplayWindow, event: Event, step: int) -> np.ndarray:
    """Return onsets around that of an event, in decisions; `step` rows apart."""
    rows = window.evidence.rows_per_decision
    onsets = (round(event.onset * rows) + step * np.arange(-_POINTS, _POINTS + 1)) / rows
    return onsets[(onsets > window.begin) & (onsets < window.end - 1)]
