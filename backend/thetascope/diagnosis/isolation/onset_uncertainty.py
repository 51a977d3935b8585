"""The intervals of a step's onset and of its size, both estimated from the same data.

An onset that is wrong by a row leaves an error of the state estimate that takes time to decay, and the fitted size
compensates it: both errors belong together. The energy E(τ) left after fitting all sizes with the onset at τ is, up to
a constant, minus twice the log-likelihood of a filter that allows for process noise. The data need not have this
process noise, and E is rough where a fault shows abruptly, so the 95 % level of E(τ₀) − min E at the true onset τ₀ is
not that of χ². It is simulated: to first order the innovations at onset τ are ν = a Ω(τ₀) + noise, and

    E(τ) = const − s(τ)²/J(τ, τ),   s(τ) = a J(τ, τ₀) + g(τ),   g ~ N(0, M),

where J(τ, τ') = Σ Ω(τ)ᵀΩ(τ') and M is the covariance of Σ Ωᵀν for the declared measurement noise alone
(engine/estimation/noise_response.py). Random g give the level. The interval of the onset contains all τ at which E,
evaluated by running the filter, is below its minimum plus this level.

An earlier onset goes with a smaller size, so the interval of the size follows from the same energies. With the size a
it is E(τ) + J(τ, τ) (a − s/J)², and random g give the 95 % level of its minimum over τ, for the true size, above the
minimum over τ and a. All sizes for which it is below that level belong to the interval, which need not be symmetric.

A fault that acts on the derivative of a state shows continuously: an onset between two rows is a smaller share of the
first row. A fault that acts on an output directly, or in discrete time, shows in whole rows; its interval begins one
row earlier, since a fault that begins between two rows shows in the second one.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.likelihood_fit import EQUAL, fit_sizes, pseudo_inverse
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.residuals.scores import LinearisedFilter, Scores
from thetascope.diagnosis.yield_points import Steps

_POINTS = 8  # onsets that are tried on either side of the best one at first
_ROUNDS = 10  # in which onsets are added, at most
_ADDED = 4  # onsets that are added at each end of the interval, until it is resolved,
_APART = 2.5  # or beyond the last one; their distance, in steps
_STEEP = 1.0  # in levels: the rise of E from the interval to the next onset above which more are needed
_FINEST = 1 / 64  # rows: the least distance of onsets that are tried
_REGULAR = 3.84  # the level of a regular likelihood, at which E is resolved before the level is simulated
_SAMPLES = 4000  # simulated errors
_JITTER = 1e-12  # added to their correlation, which is singular where the fault does not show at all
_CONFIDENCE = 0.95
_QUANTILE = 1.959964  # of a normal distribution


@dataclass(frozen=True)
class StepUncertainty:
    """The onset of a step and its interval in decisions, the step that begins there, and the interval of its size.

    Between two rows `step` rises within one row. The interval of the size is that of a normal distribution with a
    standard deviation around the size plus `skew`.
    """

    onset: float
    earliest: float
    latest: float
    step: Event
    deviation: float
    skew: float


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
    search = _Search(window, events, k)
    onsets = search.within(events[k].onset + search.first_step(width) * np.arange(-_POINTS, _POINTS))
    if len(onsets) < 2:
        return None
    profile = yield from search.evaluate(onsets, np.full(len(onsets), events[k].size))
    level, sizes, simulated = _REGULAR, (0.0, 0.0), 0
    for last in range(_ROUNDS - 1, -1, -1):
        added = search.within(_missing(profile, level, search)) if last else onsets[:0]
        if not len(added) and simulated < len(profile.onsets):
            scores = yield from search.scores(profile.onsets)
            if not scores.response[profile.best].any():
                return None
            yield
            errors = _Errors.of(scores, search.others)
            level, of_size = errors.levels(profile.best, float(profile.size[profile.best]))
            sizes = _size_interval(profile, errors.root, of_size)
            simulated = len(profile.onsets)
            added = search.within(_missing(profile, level, search)) if last else added
        if not len(added):
            break
        more = yield from search.evaluate(added, np.interp(added, profile.onsets, profile.size))
        profile = profile.joined(more)
    return _result(profile, profile.excess(level), sizes, search)


class _Search:
    """Evaluates steps that begin at any time in place of event `k`.

    Attributes:
        row: the length of a row in decisions.
        whole_rows: whether the fault shows in whole rows.
        others: scores of the other events, once `scores` was called; None without other events.
    """

    def __init__(self, window: ReplayWindow, events: tuple[Event, ...], k: int):
        self._window, self._events, self._k = window, events, k
        self.row = 1 / window.evidence.rows_per_decision
        self.whole_rows = bool(window.evidence.filter.acts_directly[events[k].channel])
        self.others: Scores | None = None
        self._filter: LinearisedFilter | None = None
        self._scored: tuple[np.ndarray, Scores] | None = None

    def first_step(self, width: float) -> float:
        """Return the distance of the onsets that are tried first; `width`: see `step_uncertainty`."""
        if self.whole_rows:
            return max(1, round(width / self.row / _POINTS)) * self.row
        return max(width / _POINTS, self.row / 4)

    def within(self, onsets: np.ndarray) -> np.ndarray:
        """Return the onsets at which a fault shows within the window."""
        return onsets[(onsets > self._window.begin + self.row) & (onsets < self._window.end - 1)]

    def evaluate(self, onsets: np.ndarray, sizes: np.ndarray) -> Steps["_Profile"]:
        """Return E and the fitted size at some onsets; `sizes`: (onsets,), first guesses."""
        before, after = self._events[: self._k], self._events[self._k + 1 :]
        steps = [self.step(float(o), float(size)) for o, size in zip(onsets, sizes, strict=True)]
        fits = yield from fit_sizes(self._window, [(*before, step, *after) for step in steps])
        return _Profile(onsets, fits.energy * self._window.noise_unit, fits.size[:, self._k])

    def step(self, onset: float, size: float) -> Event:
        """Return a step that begins at any time; between two rows it rises within one row."""
        channel = self._events[self._k].channel
        return Event(channel, onset, 0.0, size) if self.whole_rows else Event(channel, onset - self.row, self.row, size)

    def scores(self, onsets: np.ndarray) -> Steps[Scores]:
        """Return the scores of steps at some onsets, ascending, those of the last call among them."""
        times, events = self._window.times, self._events
        if self._filter is None:
            yield
            self._filter = self._window.linearised(events)
            rest = [e for i, e in enumerate(events) if i != self._k]
            if rest:
                courses = np.array([e.course(times) for e in rest])
                self.others = yield from self._filter.scores([e.channel for e in rest], courses)
        new = onsets if self._scored is None else onsets[~np.isin(onsets, self._scored[0])]
        since = times - new[:, None]
        courses = (since >= 0) * 1.0 if self.whole_rows else np.clip(since / self.row + 1.0, 0.0, 1.0)
        scores = yield from self._filter.scores([events[self._k].channel] * len(new), courses)
        if self._scored is not None:
            scores = self._scored[1].joined(scores).of(np.argsort(np.concatenate([self._scored[0], new])))
        self._scored = onsets, scores
        return scores


@dataclass(frozen=True)
class _Profile:
    """E and the fitted size at onsets (onsets,), ascending."""

    onsets: np.ndarray
    energy: np.ndarray
    size: np.ndarray

    @property
    def best(self) -> int:
        """The place of the least energy; of equal ones the last, since earlier the fault would not show."""
        return int(np.flatnonzero(self.energy <= self.energy.min() + EQUAL)[-1])

    def excess(self, level: float) -> np.ndarray:
        """Return E less its minimum and a level."""
        return self.energy - self.energy[self.best] - level

    def joined(self, other: "_Profile") -> "_Profile":
        """Return the profile at the onsets of both."""
        onsets = np.concatenate([self.onsets, other.onsets])
        order = np.argsort(onsets)
        energy, size = np.concatenate([self.energy, other.energy]), np.concatenate([self.size, other.size])
        return _Profile(onsets[order], energy[order], size[order])


def _missing(profile: _Profile, level: float, search: _Search) -> np.ndarray:
    """Return the onsets to add: where the interval does not end yet, and between its ends and the onsets next to it.

    Args:
        profile: E at the onsets tried.
        level: of E at the ends of the interval above its minimum.
        search: tells rows.
    """
    onsets, excess, row, whole_rows = profile.onsets, profile.excess(level), search.row, search.whole_rows
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


@dataclass(frozen=True)
class _Errors:
    """Simulated errors of steps at onsets.

    Attributes:
        response: (onsets, numbers), Ω along the rows, without the part that the other events explain.
        root: (onsets,), √J.
        noise: (onsets, samples), g/√J.
    """

    response: np.ndarray
    root: np.ndarray
    noise: np.ndarray

    @classmethod
    def of(cls, scores: Scores, others: Scores | None) -> "_Errors":
        """Return the errors by the scores of steps, and of the other events, whose sizes are fitted too."""
        response, noise = scores.response, scores.noise
        if others is not None:
            share = response @ others.response.T @ pseudo_inverse(others.response @ others.response.T)
            response, noise = response - share @ others.response, noise - share @ others.noise
        root = np.sqrt(np.maximum(np.einsum("ij,ij->i", response, response), 1e-300))
        scale = np.maximum(np.sqrt(np.einsum("ij,ij->i", noise, noise)), 1e-300)
        noise = noise / scale[:, None]
        correlation = noise @ noise.T + _JITTER * np.eye(len(root))
        return cls(response, root, (np.linalg.cholesky(correlation) * (scale / root)[:, None]) @ _normal(len(root)))

    def levels(self, true: int, size: float) -> tuple[float, float]:
        """Return the 95 % levels of E at a true step above its minimum: at the onset, and with the size."""
        scaled = self.noise + (size * (self.response @ self.response[true]) / self.root)[:, None]  # s/√J
        explained, reach = scaled**2, (size * self.root)[:, None]
        most, with_size = explained.max(axis=0), ((2 * reach) * scaled - reach**2).max(axis=0)
        of_onset, of_size = (np.quantile(most - e, _CONFIDENCE) for e in (explained[true], with_size))
        return float(of_onset), float(of_size)


@lru_cache(maxsize=64)
def _normal(count: int) -> np.ndarray:
    """Return standard normal numbers (count, samples), always the same."""
    return np.random.default_rng(count).standard_normal((_SAMPLES, count)).T.copy()


def _size_interval(profile: _Profile, root: np.ndarray, level: float) -> tuple[float, float]:
    """Return the least and the largest size that some onset allows.

    Args:
        profile: E and sizes at onsets.
        root: (onsets,), √J.
        level: of E with that size above its minimum.
    """
    allowed = -profile.excess(level)
    inside = allowed >= 0
    half, size = np.sqrt(allowed[inside]) / root[inside], profile.size[inside]
    return float((size - half).min()), float((size + half).max())


def _result(profile: _Profile, excess: np.ndarray, sizes: tuple[float, float], search: _Search) -> StepUncertainty:
    """Return the interval in which `excess` (onsets,) is not above zero, and the step of the best onset.

    `sizes`: the ends of the interval of the size.
    """
    onsets, best, row = profile.onsets, profile.best, search.row
    inside = np.flatnonzero(excess <= 0)
    first, last = int(inside[0]), int(inside[-1])
    if search.whole_rows:  # rows that were not tried may belong to it
        earliest = onsets[first - 1] if first else onsets[first] - row
        latest = max(onsets[last + 1] - row, onsets[last]) if last + 1 < len(onsets) else onsets[last]
        onset = float(onsets[best])
    else:
        earliest = _crossing(onsets, excess, first, first - 1, best)
        latest = _crossing(onsets, excess, last, last + 1, best)
        onset = min(max(_vertex(onsets, excess, best), earliest), latest)
    step = search.step(onset, float(np.interp(onset, onsets, profile.size)))
    deviation, middle = (sizes[1] - sizes[0]) / (2 * _QUANTILE), (sizes[0] + sizes[1]) / 2
    return StepUncertainty(onset, float(earliest), float(latest), step, deviation, middle - step.size)


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
