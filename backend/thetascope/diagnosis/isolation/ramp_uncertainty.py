"""How much less is known of what a rise has reached since its beginning and its end are estimated as well."""

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.likelihood_fit import fit_sizes
from thetascope.diagnosis.isolation.replay import ReplayWindow

_PART = 12  # of a rise, by which its ends are moved first
_CURVED = 30.0  # of energy: moved by so much less is looked at, since more is no parabola
_ROUNDS = 4
_STENCIL = ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1))


def shape_variance(window: ReplayWindow, events: tuple[Event, ...], k: int) -> float:
    """Variance of what event ``k`` (a rise that ends, or bends to its end) has reached at the end of a scene, by its shape alone, were
    noise white; 0 if the data do not say.

    The energy E that is left, as a function of onset and end φ with all sizes fitted anew, is a parabola near its least value; the
    variance of φ is 2 (∂²E/∂φ²)⁻¹, E being twice the log of a likelihood, and what is reached follows by its slopes over φ.
    """
    part = max(1, round(events[k].rise_time / _PART))
    for _ in range(_ROUNDS):
        tries = [
            tuple(_moved(e, part * a, part * b) if i == k else e for i, e in enumerate(events)) for a, b in _STENCIL
        ]
        if not all(
            window.begin <= t[k].onset_decision
            and t[k].rise_time >= 1
            and t[k].onset + t[k].rise_time * t[k].is_ramp < window.end
            for t in tries
        ):
            return 0.0
        fits = fit_sizes(window, tries)
        E = fits.energy
        if part == 1 or max(E[1:5]) - E[0] < _CURVED:
            break
        part = max(1, part // 3)
    reached = np.array([s * t[k].unit_value(window.end) for s, t in zip(fits.size[:, k], tries, strict=True)])
    slopes = np.array([reached[1] - reached[2], reached[3] - reached[4]]) / 2
    mixed = (E[5] + E[6] - E[1:5].sum() + 2 * E[0]) / 2
    H = np.array([[E[1] + E[2] - 2 * E[0], mixed], [mixed, E[3] + E[4] - 2 * E[0]]])
    if not np.isfinite(H).all() or H[0, 0] <= 0 or np.linalg.det(H) <= 1e-6 * abs(H[0, 0] * H[1, 1]):
        return 0.0
    return float(2 * slopes @ np.linalg.solve(H, slopes))


def _moved(event: Event, begin: int, end: int) -> Event:
    """With its onset later by ``begin`` and its end (or its time constant) by ``end`` decisions."""
    rise = event.rise_time + (end if event.exponential else end - begin)
    return Event(event.channel, event.onset + begin, rise, event.size, event.exponential)
