"""What could explain the data since some decision: one change of θ, two at once, or an output that cannot be trusted.

What is worth it (screening.py) is held against the data in full: the filter is run as if the explanation were true, and
sizes are corrected until they fit (Gauss–Newton). The innovations of a true explanation are white again, however large the
fault; the energy that is left decides between explanations, as twice the log of their likelihoods does.

An output that cannot be trusted (stuck, delayed, noisy, …) is tried by not heeding it: its prediction by the others is then
compared with what it shows, as noise of a variance to be estimated: N (1 + log(q/N)) in place of q, for N numbers.
"""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from backend.diagnosis.scene import Scene, within
from backend.diagnosis.screening import Case, asked
from backend.diagnosis.standing import Event

CLEAR = 9.0  # lead in twice the log of a likelihood that makes one explanation the answer: odds of 90 to 1
AS_WELL = 6.0  # an explanation within this is as good: odds below 20 to 1
ROUGHLY = 0.1  # of the energy explained: what first-order answers may be wrong by
_HELD = 4.0  # what a new fault has to explain more than a change of one that is on
_TRIED = 4  # explanations that are held against the data in full
_VAGUE = 3  # changes of θ that a distrusted output counts for
_BACK = 100  # decisions over which an output is compared with the others
_MOVES = 8  # of an onset, to each side
_EQUAL = 1e-3  # of costs
_ROUNDS = 3  # of Gauss–Newton


@dataclass(frozen=True)
class Explained:
    """An explanation with its sizes; ``left``: what it leaves since its onset, in standard deviations of the noise's."""

    events: tuple[Event, ...]
    output: int | None
    onset: int
    energy: float  # from the beginning of the scene, in units of noise
    cost: float
    left: float
    share: float  # of the excess energy since the onset that it explains
    covariance: np.ndarray
    state: np.ndarray
    statistic: float = 0.0
    early: np.ndarray | None = None  # events: share of what is known of them that comes while the answer takes its form
    passed: np.ndarray | None = None  # events × p: by how much sizes are off if what is known of another channel is


def fitted(scene: Scene, events: tuple[Event, ...]) -> Explained:
    """The sizes of the events (each of another channel) that leave least, and what they leave."""
    channels = [e.channel for e in events]
    onset = min(e.first for e in events)
    bounds = within(scene)
    reach = np.array([float(e.course(np.array(float(scene.at)))) for e in events])
    low, high = bounds.low[channels] / np.maximum(reach, 1.0), bounds.high[channels] / np.maximum(reach, 1.0)
    size = np.clip(np.array([e.size for e in events]), low, high)
    p = len(scene.base.level)

    def profile(d):
        courses = np.ones((len(d), p))  # of other channels: errors of what is known
        for e in events:
            courses[:, e.channel] = e.course(d)
        return courses

    for _ in range(_ROUNDS):
        seen = scene.run(onset, sized(events, size), profile, abrupt=not any(e.rise for e in events))
        J, s = seen.J[np.ix_(channels, channels)], seen.s[channels]
        inverse = _inverse(J)
        step = np.clip(size + inverse @ s, low, high) - size
        gain = float(2 * s @ step - step @ J @ step)
        size = size + step
        if gain < 0.5:
            break
    left = float(seen.energy[-1]) - max(gain, 0.0)
    passed = inverse @ seen.J[channels]
    passed[:, channels] = 0.0
    state = scene.look.moved(seen.states[-1], _spread(step, channels, p))
    fit = _told(scene, sized(events, size), None, onset, left, len(events), inverse, state, seen.heed)
    early = seen.early[channels] / np.maximum(seen.J[channels, channels], 1e-300)
    return replace(fit, passed=passed, early=early)


def sized(events: tuple[Event, ...], size: np.ndarray) -> tuple[Event, ...]:
    return tuple(Event(e.channel, e.onset, e.rise, float(v)) for e, v in zip(events, size, strict=True))


def _spread(step: np.ndarray, channels: list[int], p: int) -> np.ndarray:
    full = np.zeros(p)
    full[channels] = step
    return full


def _inverse(J: np.ndarray) -> np.ndarray:
    if len(J) == 1:
        return 1.0 / np.maximum(J, 1e-300)
    scale = np.sqrt(np.maximum(np.diag(J), 1e-300))
    return np.linalg.pinv(J / np.outer(scale, scale), rcond=1e-9, hermitian=True) / np.outer(scale, scale)


def _told(scene: Scene, events, output, onset, left, count, covariance, state, heed, more=0.0) -> Explained:
    length = scene.at - onset
    mean, deviation = scene.expected(length, heed)
    unit = scene.unit(scene.at - scene.begin)
    excess = float(scene.track.energy[-1]) - scene.spent(onset) - scene.expected(length)[0]
    energy = (scene.spent(onset) + left) / unit + more
    cost = energy + CLEAR * count + float(sum(asked(e.rise) for e in events))
    share = 1.0 - (left - mean) / excess if excess > 0 else 1.0
    return Explained(events, output, onset, energy, cost, (left - mean) / deviation if deviation else 0.0, share, covariance, state)


def distrusted(scene: Scene) -> list[Explained]:
    """For each output what not heeding it explains, from where it parts from what the filter makes of the others."""
    answers = []
    for k in np.flatnonzero(scene.heed):
        heed = scene.heed.copy()
        heed[k] = 0.0
        begin = max(scene.begin, scene.at - _BACK)
        one = scene.expected(scene.at - begin, np.eye(len(heed))[k])[0] / (scene.at - begin)  # in a decision
        shown = scene.run(begin, (), None, heed).q[:, k]
        left = (scene.at - begin) - np.arange(scene.at - begin)
        after = shown[-1] - shown[:-1]
        onset = begin + int(np.argmin(shown[:-1] + _vague(after, one * left)))
        seen = scene.run(onset, (), None, heed)
        more = float(_vague(seen.q[-1, k], one * (scene.at - onset))) / scene.unit(scene.at - scene.begin)
        answers.append(_told(scene, (), int(k), onset, float(seen.energy[-1]), _VAGUE, np.zeros((0, 0)), seen.states[-1], heed, more))
    return answers


def _vague(q: np.ndarray, expected: np.ndarray | float) -> np.ndarray:
    """Energy of numbers whose variance is estimated, at least one: instead of q, ``expected`` being its mean."""
    return np.minimum(q, expected) + expected * np.log(np.maximum(q / expected, 1.0))


def singles(scene: Scene, seen: Case, memory: float, held: set[int], options: tuple[Event, ...] = ()) -> list[Explained]:
    """One change of one channel: those that may be it, held against the data in full; the best first.

    ``options`` are tried whatever the first order says of them.
    """
    noise = scene.look.calibrated.noise
    best = seen.energy.max(axis=0)
    order = np.argsort(-best)[:_TRIED]
    least = best[order[0]] * (1 - ROUGHLY) - AS_WELL - CLEAR
    tried = [o for o in options if o.first >= scene.begin]
    for place, c in enumerate(order):
        for entry in seen.kinds(int(c)):
            if place > 1 and seen.energy[entry, c] < least:
                continue
            onset, rise = int(seen.onsets[entry]), float(seen.rises[entry])
            size = float(seen.s[entry, c] / max(seen.J[entry, c, c], 1e-300))
            tried.append(Event(int(c), onset, rise, size))
    fits = sorted((fitted(scene, (event,)) for event in tried), key=lambda f: f.cost)
    answers, length = [], scene.at - scene.begin
    for k, fit in enumerate(fits):
        if k < 2 or fit.cost < fits[0].cost + 2 * CLEAR:
            fit = _polished(scene, fit)
        c, since = fit.events[0].channel, scene.at - fit.onset
        taken = float(scene.track.energy[-1]) / scene.unit(length) - fit.energy
        statistic = taken / float(noise.v[int(noise.nearest(since)), c]) / (1.0 + since / memory)
        bonus = _HELD if c in held else 0.0  # a fault that changes is likelier than a new one
        answers.append(replace(fit, cost=fit.cost - bonus, statistic=statistic))
    answers.sort(key=lambda e: e.cost)
    return [e for i, e in enumerate(answers) if e.events[0].channel not in {o.events[0].channel for o in answers[:i]}]


def _polished(scene: Scene, fit: Explained) -> Explained:
    """The same with the onset moved to where less is left: by decisions, since first order is not that exact, and by rows."""
    rows = scene.look.rows
    parts, moves = [rows], _MOVES
    while parts[-1] > 1 and not any(e.rise for e in fit.events):
        parts.append(parts[-1] // 2)
    for part in parts:
        for way in (-part, part):
            for _ in range(moves):
                moved = tuple(replace(e, onset=round(e.onset * rows + way) / rows) for e in fit.events)
                if not all(scene.begin <= e.onset < scene.at - 1 for e in moved):
                    break
                other = fitted(scene, moved)
                if other.cost >= fit.cost + _EQUAL * (way > 0):  # later by ties: where a fault would not show it need not be
                    break
                fit = other
        moves = 1
    return fit


def pairs(scene: Scene, seen: Case, memory: float) -> list[Explained]:
    """Two changes at one instant, of those that explain most to first order; the best first."""
    p = seen.energy.shape[1]
    tried = []
    steps = np.flatnonzero(seen.rises == 0)
    for i, j in combinations(range(p), 2):
        J, s = seen.J[steps][:, [i, j]][:, :, [i, j]], seen.s[steps][:, [i, j]]
        D = np.maximum(np.einsum("dii->di", J), 1e-300)
        det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] ** 2
        apart = det > 1e-6 * D[:, 0] * D[:, 1]
        energy = np.where(apart, (J[:, 1, 1] * s[:, 0] ** 2 - 2 * J[:, 0, 1] * s[:, 0] * s[:, 1] + J[:, 0, 0] * s[:, 1] ** 2)
                          / np.where(apart, det, 1.0), 0.0)  # fmt: skip
        k = int(energy.argmax())
        tried.append((float(energy[k]), int(steps[k]), (i, j)))
    answers = []
    for k, (energy, entry, (i, j)) in enumerate(sorted(tried, reverse=True)[:_TRIED]):
        onset = int(seen.onsets[entry])
        size = _inverse(seen.J[entry][np.ix_([i, j], [i, j])]) @ seen.s[entry, [i, j]]
        fit = fitted(scene, (Event(i, onset, 0.0, float(size[0])), Event(j, onset, 0.0, float(size[1]))))
        fit = _polished(scene, fit) if k == 0 else fit
        answers.append(replace(fit, statistic=energy / (1.0 + (scene.at - onset) / memory)))
    return sorted(answers, key=lambda e: e.cost)
