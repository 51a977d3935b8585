"""Explanations by faults held against the data in full, side by side.

The filter is run as if an explanation were true, and its sizes are corrected until they fit (Gauss–Newton). The innovations of a
true explanation are white again, however large the fault; the energy that is left decides between explanations, as twice
the log of their likelihoods does.
"""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.first_order import shape_penalty
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.residuals.filter_bank import LOST

CLEAR = 9.0  # lead in twice the log of a likelihood that makes one explanation the answer: odds of 90 to 1
_ROUNDS = 3  # of Gauss–Newton, at most
_GAINED = 0.5  # of energy by a round: below it there is no further one
_STEPS = (-2, -1, 1, 2)  # by which onsets and the ends of rises are moved at once,
_MOVES = 4  # times at most, by as much
_FRACTIONS = (12, 48)  # of a rise: by so much it is moved
_EQUAL = 1e-3  # of costs


@dataclass(frozen=True)
class Explanation:
    """An explanation with its sizes; ``left``: what it leaves since its onset, in standard deviations of the noise's."""

    events: tuple[Event, ...]
    output: int | None
    onset: int
    energy: float  # from the beginning of the scene, in units of noise
    cost: float
    left: float
    share: float  # of the excess energy since the onset that it explains
    covariance: np.ndarray
    statistic: float = 0.0
    early: np.ndarray | None = None  # events: share of what is known of them that comes while the answer takes its form
    passed: np.ndarray | None = None  # events × p: by how much sizes are off if what is known of another channel is


@dataclass(frozen=True)
class FitBatch:
    """Explanations by as many faults each, all of other channels: what comes of each (the first axis)."""

    window: ReplayWindow
    tries: list[tuple[Event, ...]]
    size: np.ndarray
    onset: np.ndarray
    left: np.ndarray
    energy: np.ndarray
    cost: np.ndarray
    inverse: np.ndarray
    J: np.ndarray
    early: np.ndarray

    def explained(self, k: int) -> Explanation:
        events, onset, window = self.events(k), int(self.onset[k]), self.window
        channels = [e.channel for e in events]
        passed = self.inverse[k] @ self.J[k][channels]
        passed[:, channels] = 0.0
        early = self.early[k][channels] / np.maximum(self.J[k][channels, channels], 1e-300)
        return Explanation(
            events,
            None,
            onset,
            float(self.energy[k]),
            float(self.cost[k]),
            *residual_score(window, onset, float(self.left[k]), window.trusted_outputs),
            self.inverse[k],
            early=early,
            passed=passed,
        )

    def events(self, k: int) -> tuple[Event, ...]:
        return tuple(
            Event(e.channel, e.onset, e.rise_time, float(v), e.exponential)
            for e, v in zip(self.tries[k], self.size[k], strict=True)
        )


def residual_score(window: ReplayWindow, onset: int, left: float, trusted_outputs: np.ndarray) -> tuple[float, float]:
    """Energy ``left`` since an onset, in standard deviations of the noise's; and the share of the excess that is explained."""
    mean, deviation = window.expected_energy(window.end - onset, trusted_outputs)
    excess = (
        float(window.energy[-1])
        - float(window.energy[onset - window.begin])
        - window.expected_energy(window.end - onset, window.trusted_outputs)[0]
    )
    return (left - mean) / deviation if deviation else 0.0, 1.0 - (left - mean) / excess if excess > 0 else 1.0


def fit_sizes(window: ReplayWindow, tries: list[tuple[Event, ...]]) -> FitBatch:
    """For each try (as many events each, all of another channel) the sizes that leave least, and what they leave."""
    channels = np.array([[e.channel for e in events] for events in tries])
    reach = np.array([[e.unit_value(window.end) for e in events] for events in tries])
    low, high = (bound[channels] / np.maximum(reach, 1.0) for bound in (window.bounds.low, window.bounds.high))
    size = np.clip(np.array([[e.size for e in events] for events in tries]), low, high)
    (count, k), p = size.shape, len(window.base.level)
    left, inverse, J, early = np.empty(count), np.empty((count, k, k)), np.empty((count, p, p)), np.empty((count, p))
    rest = np.arange(count)
    for more in range(_ROUNDS - 1, -1, -1):
        seen, c, one = (
            window.run_bank([tries[i] for i in rest], size[rest]),
            channels[rest],
            np.arange(len(rest))[:, None],
        )
        s, own = seen.s[:, -1][one, c], seen.J[:, -1][one[:, :, None], c[:, :, None], c[:, None, :]]
        back = pseudo_inverse(own)
        new = np.clip(size[rest] + np.einsum("kij,kj->ki", back, s), low[rest], high[rest])
        step = new - size[rest]
        gain = 2 * (s * step).sum(axis=1) - np.einsum("ki,kij,kj->k", step, own, step)
        size[rest] = new
        done = (gain < _GAINED) | (more == 0)
        at = rest[done]
        left[at] = seen.q[done, -1] @ window.trusted_outputs - np.maximum(gain[done], 0.0)
        inverse[at], J[at], early[at] = back[done], seen.J[done, -1], seen.early[done, -1]
        rest = rest[~done]
        if not len(rest):
            break
    onset = np.array([min(e.onset_decision for e in events) for events in tries])
    energy = np.nan_to_num((window.energy[onset - window.begin] + left) / window.noise_unit, nan=LOST)
    cost = energy + np.array([sum(event_penalty(e) for e in events) for events in tries])
    return FitBatch(window, tries, size, onset, left, energy, cost, inverse, J, early)


def event_penalty(event: Event) -> float:
    """What an event has to explain, in twice the log of a likelihood."""
    return CLEAR + shape_penalty(event.rise_time)


def pseudo_inverse(J: np.ndarray) -> np.ndarray:
    """Of each matrix (the last two axes)."""
    if J.shape[-1] == 1:
        return 1.0 / np.maximum(J, 1e-300)
    scale = np.sqrt(np.maximum(np.einsum("...ii->...i", J), 1e-300))
    scale = scale[..., :, None] * scale[..., None, :]
    with np.errstate(over="ignore"):  # where nothing is seen of a change its variance has no bound
        return np.linalg.pinv(J / scale, rcond=1e-9, hermitian=True) / scale


# ---- onsets --------------------------------------------------------------------------------------------------------------


def refine_onsets(fits: FitBatch, which: list[int]) -> list[Explanation]:
    """Those of the fits with onsets moved to where less is left: by decisions, since first order is not that exact, and by rows.

    All are moved side by side, each by what it has met itself.
    """
    window, best = fits.window, {k: (fits, k) for k in which}
    plans = {k: _plan(window, fits.tries[k][0]) for k in which}
    moves = dict.fromkeys(which, 0)
    while plans:
        tries = [
            (k, moved) for k, plan in plans.items() for moved in _moves(window, best[k][0].events(best[k][1]), plan[0])
        ]
        found = fit_sizes(window, [moved for _, moved in tries]) if tries else None
        for k in list(plans):
            new = _best(best[k], found, [i for i, (owner, _) in enumerate(tries) if owner == k])
            moved, best[k] = new is not best[k], new
            moves[k] += 1
            if not (moved and moves[k] < _MOVES):
                plans[k], moves[k] = plans[k][1:], 0
        plans = {k: plan for k, plan in plans.items() if plan}
    return [found.explained(i) for found, i in best.values()]


def _plan(window: ReplayWindow, event: Event) -> list[int]:
    """By how many rows an event is moved, coarsely and then finely."""
    rows = window.evidence.rows_per_decision
    if 0 < event.rise_time < np.inf:
        return list(dict.fromkeys(rows * max(1, int(event.rise_time) // f) for f in _FRACTIONS))
    parts = [rows]
    while parts[-1] > 1 and not event.rise_time:
        parts.append(max(1, parts[-1] // 4))
    return parts


def _moves(window: ReplayWindow, events: tuple[Event, ...], part: int) -> list[tuple[Event, ...]]:
    ends = (False, True) if 0 < events[0].rise_time < np.inf else (False,)
    tries = (
        tuple(_moved(e, part * step, window.evidence.rows_per_decision, end) for e in events)
        for end in ends
        for step in _STEPS
    )
    return [moved for moved in tries if all(_inside(window, e) for e in moved)]


def _moved(event: Event, way: int, rows: int, end: bool) -> Event:
    """With its onset moved by rows, or the end of its rise: the other stays."""
    c, onset, rise, whole = event.channel, event.onset, event.rise_time, round(way / rows)
    if end:
        return Event(c, onset, rise + whole, event.size, event.exponential)
    if event.is_ramp:
        return Event(c, onset + whole, rise - whole, event.size)
    return Event(c, round(onset * rows + way) / rows, rise, event.size, event.exponential)


def _inside(window: ReplayWindow, event: Event) -> bool:
    if (
        not window.begin <= event.onset < window.end - 1
        or event.rise_time < 0
        or (event.exponential and event.rise_time < 1)
    ):
        return False
    return not event.is_ramp or event.onset + event.rise_time < window.end


def _best(now: tuple[FitBatch, int], found: FitBatch | None, mine: list[int]) -> tuple[FitBatch, int]:
    """The one that costs least, the latest of those that cost as much: where a fault would not show it need not be."""
    all_ = [now, *((found, i) for i in mine)]
    least = min(f.cost[i] for f, i in all_)
    return max((c for c in all_ if c[0].cost[c[1]] <= least + _EQUAL), key=lambda c: c[0].tries[c[1]][0].onset)
