"""The variance that a rise's size gains because its beginning and its end are estimated too."""

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.likelihood_fit import FitBatch, fit_sizes
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

_PART = 12  # the ends are shifted by this part of the rise time at first
_CURVED = 30.0  # energy: a shift that changes it by more leaves the parabola, and a smaller one is tried
_ROUNDS = 4  # shifts that are tried, at most
_STENCIL = ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1))


def shape_variance(window: ReplayWindow, events: tuple[Event, ...], k: int) -> Steps[float]:
    """Return the variance of event `k`'s value at the end of a window due to its shape alone, for white noise.

    Event `k` is a ramp or an exponential. The energy E left after fitting all sizes, as a function of φ = (onset, end),
    is a parabola near its minimum. Since E is minus twice the log-likelihood, the covariance of φ is 2 (∂²E/∂φ²)⁻¹; the
    value at the end follows by its derivatives with respect to φ. Returns 0 where the data do not determine the
    parabola.
    """
    part, rounds = max(1, round(events[k].rise_time / _PART)), 0
    while True:
        rounds += 1
        hypotheses = _stencil(events, k, part)
        if not all(_fits_window(window, h[k]) for h in hypotheses):
            return 0.0
        fits = yield from fit_sizes(window, hypotheses)
        if rounds == _ROUNDS or part == 1 or max(fits.energy[1:5]) - fits.energy[0] < _CURVED:
            return _variance(window, fits, k)
        part = max(1, part // 3)


def _variance(window: ReplayWindow, fits: FitBatch, k: int) -> float:
    """Return the variance from the energies at the points of the stencil."""
    E = fits.energy
    values = np.array([s * h[k].unit_value(window.end) for s, h in zip(fits.size[:, k], fits.hypotheses, strict=True)])
    slopes = np.array([values[1] - values[2], values[3] - values[4]]) / 2
    mixed = (E[5] + E[6] - E[1:5].sum() + 2 * E[0]) / 2
    H = np.array([[E[1] + E[2] - 2 * E[0], mixed], [mixed, E[3] + E[4] - 2 * E[0]]])
    if not np.isfinite(H).all() or H[0, 0] <= 0 or np.linalg.det(H) <= 1e-6 * abs(H[0, 0] * H[1, 1]):
        return 0.0
    return float(2 * slopes @ np.linalg.solve(H, slopes))


def _stencil(events: tuple[Event, ...], k: int, part: int) -> list[tuple[Event, ...]]:
    """Return the events with the onset and the end of event `k` shifted by `part` decisions times the stencil."""
    return [tuple(_shifted(e, part * a, part * b) if i == k else e for i, e in enumerate(events)) for a, b in _STENCIL]


def _shifted(event: Event, begin: int, end: int) -> Event:
    """Return an event with its onset later by `begin` and its end (or its time constant) by `end` decisions."""
    rise_time = event.rise_time + (end if event.exponential else end - begin)
    return Event(event.channel, event.onset + begin, rise_time, event.size, event.exponential)


def _fits_window(window: ReplayWindow, event: Event) -> bool:
    end = event.onset + event.rise_time * event.is_ramp
    return window.begin <= event.onset_decision and event.rise_time >= 1 and end < window.end
