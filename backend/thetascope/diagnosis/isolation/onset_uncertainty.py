"""The interval of a step's onset and the standard deviation of its size, both estimated from the same data.

An onset that is wrong by a row leaves an error of the state estimate that takes time to decay, and the fitted size
compensates it: both errors belong together. The energy E(τ) left after fitting all sizes with the onset at τ is, up to
a constant, minus twice the log-likelihood of a filter that allows for process noise. The data need not have this
process noise, and E is rough where a fault shows abruptly, so the 95 % level of E(τ₀) − min E at the true onset τ₀ is
not that of χ². It is simulated: to first order the innovations at onset τ are ν = a Ω(τ₀) + noise, and

    E(τ) = const − s(τ)²/J(τ, τ),   s(τ) = a J(τ, τ₀) + g(τ),   g ~ N(0, M),

where J(τ, τ') = Σ Ω(τ)ᵀΩ(τ') and M is the covariance of Σ Ωᵀν for the declared measurement noise alone
(engine/estimation/noise_response.py). Random g give the level, and the standard deviation of the size s/J at the best
onset. The interval of the onset contains all τ at which E, evaluated by running the filter, is below its minimum plus
this level.

A fault that acts on the derivative of a state shows continuously: an onset between two rows is a smaller share of the
first row. A fault that acts on an output directly, or in discrete time, shows in whole rows; its interval begins one
row earlier, since a fault that begins between two rows shows in the second one.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.likelihood_fit import EQUAL, fit_sizes, pseudo_inverse
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.residuals.score_noise import Scores
from thetascope.diagnosis.yield_points import Steps

_POINTS = 8  # onsets that are tried on either side of the best one at first
_ROUNDS = 10  # in which onsets are added, at most
_ADDED = 3  # onsets that are added at each end of the interval, until it is resolved,
_APART = 2.5  # or beyond the last one; their distance, in steps
_STEEP = 1.0  # in levels: the rise of E from the interval to the next onset above which more are needed
_FINEST = 1 / 64  # rows: the least distance of onsets that are tried
_SAMPLES = 4000  # simulated errors
_JITTER = 1e-12  # added to their correlation, which is singular where the fault does not show at all
_CONFIDENCE = 0.95


@dataclass(frozen=True)
class StepUncertainty:
    """The onset of a step and its interval in decisions, and the size less the fitted one, with its variance."""

    onset: float
    earliest: float
    latest: float
    shift: float
    variance: float


def step_uncertainty(
    window: ReplayWindow, events: tuple[Event, ...], k: int, width: float
) -> Steps[StepUncertainty | None]:
    """Return the uncertainty of event `k`, a step; None if it begins where tests begin or end, or does not show.

    Args:
        window: the data.
        events: the fitted events.
        k: the place of the event.
        width: the approximate width of the onset's interval, in decisions.
    """
    if window.is_initial(events[k].onset_decision, True):
        return None
    row = 1 / window.evidence.rows_per_decision
    whole_rows = bool(window.evidence.filter.acts_directly[events[k].channel])
    step = max(1, round(width / row / _POINTS)) * row if whole_rows else max(width / _POINTS, row / 4)
    onsets = _within(window, events[k].onset + step * np.arange(-_POINTS, _POINTS + 1))
    if len(onsets) < 2:
        return None
    others = None
    if len(events) > 1:
        others = yield from window.scores(events, [_course(window, e) for i, e in enumerate(events) if i != k])
    profile, rounds = (yield from _evaluate(window, events, k, onsets)), 0
    while True:
        rounds += 1
        best = profile.best
        if not profile.scores.response[best].any():
            return None
        level, variance = _simulated(profile.scores, others, best, float(profile.size[best]))
        excess = profile.energy - profile.energy[best] - level
        added = _within(window, _missing(profile.onsets, excess, level, row, whole_rows))
        if rounds == _ROUNDS or not len(added):
            return _result(profile, excess, events[k].size, variance, row, whole_rows)
        more = yield from _evaluate(window, events, k, added)
        profile = profile.joined(more)


def _within(window: ReplayWindow, onsets: np.ndarray) -> np.ndarray:
    """Return the onsets at which a fault shows within a window."""
    return onsets[(onsets > window.begin + 1 / window.evidence.rows_per_decision) & (onsets < window.end - 1)]


def _evaluate(window: ReplayWindow, events: tuple[Event, ...], k: int, onsets: np.ndarray) -> Steps["_Profile"]:
    """Return E and the size of event `k` at some onsets."""
    row = 1 / window.evidence.rows_per_decision
    whole_rows = bool(window.evidence.filter.acts_directly[events[k].channel])
    options = [_begun(events[k], float(o), row, whole_rows) for o in onsets]
    fits = yield from fit_sizes(window, [tuple(o if i == k else e for i, e in enumerate(events)) for o in options])
    scores = yield from window.scores(events, [_course(window, o) for o in options])
    return _Profile(onsets, fits.energy * window.noise_unit, fits.size[:, k], scores)


def _course(window: ReplayWindow, event: Event) -> tuple[int, np.ndarray]:
    return event.channel, event.course(window.times)


def _begun(event: Event, onset: float, row: float, whole_rows: bool) -> Event:
    """Return a step that begins at any time; between two rows it rises within one row."""
    return replace(event, onset=onset) if whole_rows else replace(event, onset=onset - row, rise_time=row)


@dataclass(frozen=True)
class _Profile:
    """E and the fitted size at onsets (onsets,), ascending, and the scores of steps at them."""

    onsets: np.ndarray
    energy: np.ndarray
    size: np.ndarray
    scores: Scores

    @property
    def best(self) -> int:
        """The place of the least energy; of equal ones the last, since earlier the fault would not show."""
        return int(np.flatnonzero(self.energy <= self.energy.min() + EQUAL)[-1])

    def joined(self, other: "_Profile") -> "_Profile":
        """Return the profile at the onsets of both."""
        order = np.argsort(np.concatenate([self.onsets, other.onsets]), kind="stable")
        onsets, energy, size = (
            np.concatenate([getattr(self, name), getattr(other, name)])[order] for name in ("onsets", "energy", "size")
        )
        return _Profile(onsets, energy, size, self.scores.joined(other.scores).of(order))


def _missing(onsets: np.ndarray, excess: np.ndarray, level: float, row: float, whole_rows: bool) -> np.ndarray:
    """Return the onsets to add: where the interval does not end yet, and between its ends and the onsets next to it.

    Args:
        onsets: (onsets,), those tried.
        excess: (onsets,), not above zero inside the interval.
        level: of E at the ends of the interval above its minimum.
        row, whole_rows: as in `_begun`.
    """
    inside, finest = np.flatnonzero(excess <= 0), row if whole_rows else row * _FINEST
    added: list[float] = []
    for here, side in ((int(inside[0]), -1), (int(inside[-1]), 1)):
        following = here + side
        if not 0 <= following < len(onsets):
            step = max(_APART * float(np.median(np.diff(onsets))), finest)
            step = np.ceil(step / row) * row if whole_rows else step
            added += [float(onsets[here] + side * step * j) for j in range(1, _ADDED + 1)]
        elif excess[following] - excess[here] > _STEEP * level:
            between = np.linspace(onsets[here], onsets[following], _ADDED + 2)[1:-1]
            between = np.unique(np.round(between / row) * row) if whole_rows else between
            if abs(onsets[following] - onsets[here]) > 1.5 * finest:
                added += [float(o) for o in between if np.abs(onsets - o).min() > 0.5 * finest]
    return np.array(sorted(added))


def _simulated(scores: Scores, others: Scores | None, true: int, size: float) -> tuple[float, float]:
    """Return the 95 % level of E at the true onset above its minimum, and the mean squared error of the size.

    Args:
        scores: of steps at the onsets that are tried.
        others: of the other events, whose sizes are fitted too; None without other events.
        true, size: the place of the true onset, and the true size.
    """
    response, noise = scores.response, scores.noise
    if others is not None:
        share = response @ others.response.T @ pseudo_inverse(others.response @ others.response.T)
        response, noise = response - share @ others.response, noise - share @ others.noise
    D = np.maximum(np.einsum("ij,ij->i", response, response), 1e-300)
    scale = np.maximum(np.sqrt(np.einsum("ij,ij->i", noise, noise)), 1e-300)
    noise = noise / scale[:, None]
    correlation = noise @ noise.T + _JITTER * np.eye(len(D))
    errors = _normal(len(D)) @ np.linalg.cholesky(correlation).T * scale
    s = size * (response @ response[true]) + errors
    explained = s**2 / D
    best = explained.argmax(axis=1)
    above = explained.max(axis=1) - explained[:, true]
    fitted = np.take_along_axis(s, best[:, None], axis=1)[:, 0] / D[best]
    return float(np.quantile(above, _CONFIDENCE)), float(np.mean((fitted - size) ** 2))


@lru_cache(maxsize=64)
def _normal(count: int) -> np.ndarray:
    """Return standard normal numbers (samples, count), always the same."""
    return np.random.default_rng(count).standard_normal((_SAMPLES, count))


def _result(
    profile: _Profile, excess: np.ndarray, fitted: float, variance: float, row: float, whole_rows: bool
) -> StepUncertainty:
    """Return the interval in which `excess` (onsets,) is not above zero, and the best onset with its size."""
    onsets, best = profile.onsets, profile.best
    inside = np.flatnonzero(excess <= 0)
    first, last = int(inside[0]), int(inside[-1])
    if whole_rows:  # rows that were not tried may belong to it
        earliest = onsets[first - 1] if first else onsets[first] - row
        latest = max(onsets[last + 1] - row, onsets[last]) if last + 1 < len(onsets) else onsets[last]
        shift = float(profile.size[best]) - fitted
        return StepUncertainty(float(onsets[best]), float(earliest), float(latest), shift, variance)
    earliest = _crossing(onsets, excess, first, first - 1, best)
    latest = _crossing(onsets, excess, last, last + 1, best)
    onset = min(max(_vertex(onsets, excess, best), earliest), latest)
    return StepUncertainty(onset, earliest, latest, float(np.interp(onset, onsets, profile.size)) - fitted, variance)


def _vertex(x: np.ndarray, y: np.ndarray, best: int) -> float:
    """Return the vertex of a parabola through the least of some values and its neighbours, between these."""
    if not 0 < best < len(y) - 1:
        return float(x[best])
    left, right = x[best] - x[best - 1], x[best + 1] - x[best]
    before, after = (y[best - 1] - y[best]) / left, (y[best + 1] - y[best]) / right
    shift = (before * right - after * left) / (2 * max(before + after, 1e-300))
    return float(x[best] + min(max(shift, -left), right))


def _crossing(onsets: np.ndarray, excess: np.ndarray, inside: int, outside: int, best: int) -> float:
    """Return where `excess` crosses zero between two neighbours; the first if the second was not tried.

    Its root above the best onset is nearly linear.
    """
    if not 0 <= outside < len(onsets):
        return float(onsets[inside])
    least = excess[best]
    near, level, far = (np.sqrt(max(e - least, 0.0)) for e in (excess[inside], 0.0, excess[outside]))
    return float(onsets[inside] + (level - near) / (far - near) * (onsets[outside] - onsets[inside]))
