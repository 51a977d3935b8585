"""Maximum-likelihood fits of fault hypotheses, side by side in the filter bank.

The filter is run as if a hypothesis were true, and its sizes are corrected until they fit (Gauss–Newton). The
innovations of a true hypothesis are white again, however large the fault is. The energy that is left is, up to a
constant, minus twice the log-likelihood, by which hypotheses are compared.
"""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.first_order import shape_penalty
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.residuals.filter_bank import LOST
from thetascope.diagnosis.yield_points import Steps

CLEAR = 9.0  # lead in twice the log-likelihood that decides between hypotheses: odds of 90 to 1
_ROUNDS = 3  # of Gauss–Newton, at most
_GAINED = 0.5  # energy: a round that gains less is the last one
_STEPS = (-2, -1, 1, 2)  # multiples of a step by which onsets and ends of rises are shifted in one round,
_MOVES = 4  # and the largest number of rounds with one step
_FRACTIONS = (12, 48)  # of a rise time: the steps of ramps and exponentials, coarse and fine
EQUAL = 1e-3  # difference of costs that counts as none


@dataclass(frozen=True)
class Explanation:
    """A fitted hypothesis.

    Attributes:
        events: the events with their sizes; empty if an output is at fault.
        output: index of the faulty output, or None.
        onset: the first onset, a decision.
        energy: energy left from the beginning of the window, in units of noise.
        cost: energy plus penalties: what hypotheses are ranked by.
        left: energy left since the onset, less its mean, in standard deviations of noise.
        share: share of the excess energy since the onset that it explains.
        covariance: (events, events), of the sizes for white noise of variance one.
        statistic: GLR of the events.
        early: (events,), share of their information that comes while the response is settling.
        passed: (events, p), change of the sizes per unit of error in a channel's known fault.
    """

    events: tuple[Event, ...]
    output: int | None
    onset: int
    energy: float
    cost: float
    left: float
    share: float
    covariance: np.ndarray
    statistic: float
    early: np.ndarray
    passed: np.ndarray


@dataclass(frozen=True)
class FitBatch:
    """Fits of several hypotheses (the first axis) with equally many events each, all of different channels.

    Attributes:
        window: the data.
        hypotheses: the events before the fit.
        size: (hypotheses, events), fitted sizes.
        onset: (hypotheses,), first onset.
        left: (hypotheses,), energy of the trusted outputs since the onset.
        energy, cost: (hypotheses,), as in `Explanation`.
        inverse: (hypotheses, events, events), inverse of the information matrix of the events.
        J: (hypotheses, p, p), information matrix of all channels.
        early: (hypotheses, p), the part of J's diagonal that comes while the response is settling.
    """

    window: ReplayWindow
    hypotheses: list[tuple[Event, ...]]
    size: np.ndarray
    onset: np.ndarray
    left: np.ndarray
    energy: np.ndarray
    cost: np.ndarray
    inverse: np.ndarray
    J: np.ndarray
    early: np.ndarray

    def explanation(self, k: int) -> Explanation:
        """Return fit `k`; its statistic is left at 0."""
        events, onset, window = self.events(k), int(self.onset[k]), self.window
        channels = [e.channel for e in events]
        passed = self.inverse[k] @ self.J[k][channels]
        passed[:, channels] = 0.0
        early = self.early[k][channels] / np.maximum(self.J[k][channels, channels], 1e-300)
        left, share = residual_score(window, onset, float(self.left[k]), window.trusted_outputs)
        energy, cost = float(self.energy[k]), float(self.cost[k])
        return Explanation(events, None, onset, energy, cost, left, share, self.inverse[k], 0.0, early, passed)

    def events(self, k: int) -> tuple[Event, ...]:
        """Return the events of hypothesis `k` with their fitted sizes."""
        return tuple(
            Event(e.channel, e.onset, e.rise_time, float(size), e.exponential)
            for e, size in zip(self.hypotheses[k], self.size[k], strict=True)
        )


def residual_score(window: ReplayWindow, onset: int, left: float, trusted_outputs: np.ndarray) -> tuple[float, float]:
    """Return (score, share) of the energy `left` by a hypothesis since its onset.

    The score is that energy less the mean of noise, in standard deviations of noise; the share is the part of the
    excess energy that the hypothesis explains.
    """
    length = window.end - onset
    mean, deviation = window.expected_energy(length, trusted_outputs)
    without = float(window.energy[-1]) - float(window.energy[onset - window.begin])
    excess = without - window.expected_energy(length, window.trusted_outputs)[0]
    return (left - mean) / deviation if deviation else 0.0, 1.0 - (left - mean) / excess if excess > 0 else 1.0


def fit_sizes(window: ReplayWindow, hypotheses: list[tuple[Event, ...]]) -> Steps[FitBatch]:
    """Return the sizes of each hypothesis that leave least energy, and that energy.

    Every hypothesis has equally many events, all of different channels.
    """
    channels = np.array([[e.channel for e in events] for events in hypotheses])
    reach = np.array([[e.unit_value(window.end) for e in events] for events in hypotheses])
    low, high = (bound[channels] / np.maximum(reach, 1.0) for bound in (window.bounds.low, window.bounds.high))
    size = np.clip(np.array([[e.size for e in events] for events in hypotheses]), low, high)
    (count, k), p = size.shape, len(window.base.level)
    left, inverse, J, early = np.empty(count), np.empty((count, k, k)), np.empty((count, p, p)), np.empty((count, p))
    active = np.arange(count)
    for rounds_left in range(_ROUNDS - 1, -1, -1):
        yield
        bank = window.run_bank([hypotheses[i] for i in active], size[active])
        c, row = channels[active], np.arange(len(active))[:, None]
        s = bank.s[:, -1][row, c]
        information = bank.J[:, -1][row[:, :, None], c[:, :, None], c[:, None, :]]
        covariance = pseudo_inverse(information)
        fitted = np.clip(size[active] + np.einsum("kij,kj->ki", covariance, s), low[active], high[active])
        step = fitted - size[active]
        gain = 2 * (s * step).sum(axis=1) - np.einsum("ki,kij,kj->k", step, information, step)
        size[active] = fitted
        done = (gain < _GAINED) | (rounds_left == 0)
        at = active[done]
        left[at] = bank.q[done, -1] @ window.trusted_outputs - np.maximum(gain[done], 0.0)
        inverse[at], J[at], early[at] = covariance[done], bank.J[done, -1], bank.early[done, -1]
        active = active[~done]
        if not len(active):
            break
    onset = np.array([min(e.onset_decision for e in events) for events in hypotheses])
    energy = np.nan_to_num((window.energy[onset - window.begin] + left) / window.noise_unit, nan=LOST)
    cost = energy + np.array([sum(event_penalty(e) for e in events) for events in hypotheses])
    return FitBatch(window, hypotheses, size, onset, left, energy, cost, inverse, J, early)


def event_penalty(event: Event) -> float:
    """Return the energy that an event has to explain to be accepted, in twice the log-likelihood."""
    return CLEAR + shape_penalty(event.rise_time)


def pseudo_inverse(J: np.ndarray) -> np.ndarray:
    """Return the pseudo-inverse of symmetric matrices (…, k, k), scaled to a diagonal of ones first."""
    if J.shape[-1] == 1:
        return 1.0 / np.maximum(J, 1e-300)
    scale = np.sqrt(np.maximum(np.einsum("...ii->...i", J), 1e-300))
    scale = scale[..., :, None] * scale[..., None, :]
    with np.errstate(over="ignore"):  # a change that no output shows has an unbounded variance
        return np.linalg.pinv(J / scale, rcond=1e-9, hermitian=True) / scale


# ---- onsets ----------------------------------------------------------------------------------------------------------


def refine_onsets(fits: FitBatch, which: list[int]) -> Steps[list[Explanation]]:
    """Return the fits `which` with their onsets and ends of rises shifted to where least energy is left.

    The first-order scan is exact to about a decision; onsets are refined by decisions and then by rows. All fits are
    refined side by side, each by its own results.
    """
    window, best = fits.window, {k: (fits, k) for k in which}
    plans = {k: _step_plan(window, fits.hypotheses[k][0]) for k in which}
    moves = dict.fromkeys(which, 0)
    while plans:
        shifted = [
            (k, hypothesis)
            for k, plan in plans.items()
            for hypothesis in _shifted_hypotheses(window, best[k][0].events(best[k][1]), plan[0])
        ]
        batch = None
        if shifted:
            batch = yield from fit_sizes(window, [hypothesis for _, hypothesis in shifted])
        for k in list(plans):
            better = _best(best[k], batch, [i for i, (owner, _) in enumerate(shifted) if owner == k])
            moved, best[k] = better is not best[k], better
            moves[k] += 1
            if not (moved and moves[k] < _MOVES):
                plans[k], moves[k] = plans[k][1:], 0
        plans = {k: plan for k, plan in plans.items() if plan}
    return [batch.explanation(i) for batch, i in best.values()]


def _step_plan(window: ReplayWindow, event: Event) -> list[int]:
    """Return the steps, in rows, by which an event is shifted: coarse first."""
    rows = window.evidence.rows_per_decision
    if 0 < event.rise_time < np.inf:
        return list(dict.fromkeys(rows * max(1, int(event.rise_time) // f) for f in _FRACTIONS))
    steps = [rows]
    while steps[-1] > 1 and not event.rise_time:
        steps.append(max(1, steps[-1] // 4))
    return steps


def _shifted_hypotheses(window: ReplayWindow, events: tuple[Event, ...], step: int) -> list[tuple[Event, ...]]:
    """Return a hypothesis with all its onsets, or all its ends of rises, shifted by multiples of `step` rows."""
    rows = window.evidence.rows_per_decision
    ends = (False, True) if 0 < events[0].rise_time < np.inf else (False,)
    hypotheses = (tuple(_shifted(e, step * factor, rows, end) for e in events) for end in ends for factor in _STEPS)
    return [shifted for shifted in hypotheses if all(_fits_window(window, e) for e in shifted)]


def _shifted(event: Event, shift: int, rows: int, end: bool) -> Event:
    """Return an event with its onset, or the end of its rise, shifted by `shift` rows; the other stays."""
    c, onset, rise_time, decisions = event.channel, event.onset, event.rise_time, round(shift / rows)
    if end:
        return Event(c, onset, rise_time + decisions, event.size, event.exponential)
    if event.is_ramp:
        return Event(c, onset + decisions, rise_time - decisions, event.size)
    return Event(c, round(onset * rows + shift) / rows, rise_time, event.size, event.exponential)


def _fits_window(window: ReplayWindow, event: Event) -> bool:
    if not window.begin <= event.onset < window.end - 1 or event.rise_time < 0:
        return False
    if event.exponential and event.rise_time < 1:
        return False
    return not event.is_ramp or event.onset + event.rise_time < window.end


def _best(present: tuple[FitBatch, int], batch: FitBatch | None, own: list[int]) -> tuple[FitBatch, int]:
    """Return the cheapest fit; of equally cheap ones that with the latest onset, since earlier the fault would not
    show."""
    fits = [present, *((batch, i) for i in own if batch is not None)]
    least = min(f.cost[i] for f, i in fits)
    cheapest = (fit for fit in fits if fit[0].cost[fit[1]] <= least + EQUAL)
    return max(cheapest, key=lambda fit: fit[0].hypotheses[fit[1]][0].onset)
