"""Hypotheses for an unexplained change: one fault, two at the same time, or a faulty output.

The first-order scan (first_order.py) selects faults, which are then fitted in full (likelihood_fit.py). A faulty output
(stuck, delayed, noisy, …) is tested by ignoring it: its prediction from the other outputs is compared with its
readings, taken as noise of an unknown variance, so that N (1 + log(q/N)) replaces the energy q of N numbers.
"""

from collections import defaultdict
from dataclasses import replace
from itertools import combinations

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.first_order import FirstOrderScan
from thetascope.diagnosis.isolation.likelihood_fit import (
    CLEAR,
    Explanation,
    FitBatch,
    fit_sizes,
    pseudo_inverse,
    refine_onsets,
    residual_score,
)
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

AMBIGUOUS = (
    6.0  # lead in twice the log-likelihood below which two hypotheses explain the data equally well: odds of 20 to 1
)
FIRST_ORDER_ERROR = 0.1  # relative error of the energy in the first-order scan
_HELD = 4.0  # lead that a new fault needs over a change of one that is on
_TRIED = 4  # hypotheses that are fitted in full
_OUTPUT_EVENTS = 3  # events that a faulty output counts as in the penalty
_BACK = 100  # decisions over which an output is compared with the others


def faulty_outputs(window: ReplayWindow) -> Steps[list[Explanation]]:
    """Return for each trusted output the hypothesis that it is faulty, from where it departs from its prediction by the
    others."""
    explanations = []
    for k in np.flatnonzero(window.trusted_outputs):
        trusted = window.trusted_outputs.copy()
        trusted[k] = 0.0
        begin = max(window.begin, window.end - _BACK)
        length = window.end - begin
        per_decision = window.expected_energy(length, np.eye(len(trusted))[k])[0] / length
        yield
        q = window.replay_trusting(begin, trusted).q[:, k]
        after = q[-1] - q[:-1]
        onset = begin + int(np.argmin(q[:-1] + _unknown_variance(after, per_decision * (length - np.arange(length)))))
        yield
        replay = window.replay_trusting(onset, trusted)
        left, expected = float(replay.energy[-1]), per_decision * (window.end - onset)
        energy = (float(window.energy[onset - window.begin]) + left) / window.noise_unit
        energy += float(_unknown_variance(replay.q[-1, k], expected)) / window.noise_unit
        score, share = residual_score(window, onset, left, trusted)
        cost, none = energy + CLEAR * _OUTPUT_EVENTS, np.zeros((0, 0))
        explanations.append(Explanation((), int(k), onset, energy, cost, score, share, none, 0.0, np.zeros(0), none))
    return explanations


def _unknown_variance(q: np.ndarray, expected: np.ndarray | float) -> np.ndarray:
    """Return the energy that replaces q for numbers of an unknown variance of at least one; `expected`: the mean of
    q."""
    return np.minimum(q, expected) + expected * np.log(np.maximum(q / expected, 1.0))


def single_faults(
    window: ReplayWindow,
    scan: FirstOrderScan,
    memory: float,
    held: set[int],
    options: tuple[Event, ...] = (),
    least_length: int = 0,
) -> Steps[tuple[list[Explanation], bool]]:
    """Return the best explanation of each channel by one fault, best first, and whether onsets were refined.

    Args:
        window: the data.
        scan: its first-order scan.
        memory: decisions that θ₀ was estimated from: the statistic is reduced for longer windows.
        held: channels with a fault that is on; a change of one of these is likelier than a new fault.
        options: events to be tried in any case.
        least_length: onsets are not refined where the best one is less than this many decisions ago or has a rival,
            because nothing would be decided yet; 0: they always are.
    """
    noise = window.evidence.thresholds.noise
    hypotheses = [o for o in options if o.onset_decision >= window.begin] + _scanned_events(scan)
    fits = yield from fit_sizes(window, [(event,) for event in hypotheses])
    order = np.argsort(fits.cost, kind="stable")
    best_cost = fits.cost[order[0]]
    rivals = [fits.cost[i] for i in order if hypotheses[i].channel != hypotheses[order[0]].channel]
    undecided = window.end - fits.onset[order[0]] < least_length - 1 or (
        rivals and rivals[0] < best_cost + AMBIGUOUS / 2
    )
    near = [] if least_length and undecided else _near_best(fits, order, hypotheses)
    refined = yield from refine_onsets(fits, near)
    explanations = []
    for fit in [*refined, *(fits.explanation(int(i)) for i in order if i not in near)]:
        c, length = fit.events[0].channel, window.end - fit.onset
        gained = float(window.energy[-1]) / window.noise_unit - fit.energy
        statistic = gained / float(noise.largest_v[int(noise.nearest(length)), c]) / (1.0 + length / memory)
        bonus = _HELD if c in held else 0.0
        explanations.append(replace(fit, cost=fit.cost - bonus, statistic=statistic))
    explanations.sort(key=lambda e: e.cost)
    best_of_channel: dict[int, Explanation] = {}
    for e in explanations:
        best_of_channel.setdefault(e.events[0].channel, e)
    return list(best_of_channel.values()), bool(near)


def _scanned_events(scan: FirstOrderScan) -> list[Event]:
    """Return the events of the leading channels, one for each shape; of channels after the second only those close to
    the best."""
    best = scan.energy.max(axis=0)
    order = np.argsort(-best)[:_TRIED]
    least = best[order[0]] * (1 - FIRST_ORDER_ERROR) - AMBIGUOUS - CLEAR
    events = []
    for rank, c in enumerate(order):
        for entry in scan.best_by_shape(int(c)):
            if rank > 1 and scan.energy[entry, c] < least:
                continue
            size = float(scan.s[entry, c]) / max(float(scan.D[entry, c]), 1e-300)
            onset, rise_time = int(scan.onsets[entry]), float(scan.rise_times[entry])
            events.append(Event(int(c), onset, rise_time, size, bool(scan.exponential[entry])))
    return events


def _near_best(fits: FitBatch, order: np.ndarray, hypotheses: list[Event]) -> list[int]:
    """Return the fits worth refining: in each channel near the best fit, the best one and those that may turn out
    equally good."""
    best_cost = fits.cost[order[0]]
    by_channel: dict[int, list[int]] = defaultdict(list)
    for rank, i in enumerate(order):
        if rank < 2 or fits.cost[i] < best_cost + 2 * CLEAR:
            by_channel[hypotheses[i].channel].append(int(i))
    return [i for own in by_channel.values() for i in own if fits.cost[i] < fits.cost[own[0]] + AMBIGUOUS]


def double_faults(window: ReplayWindow, scan: FirstOrderScan, memory: float) -> Steps[list[Explanation]]:
    """Return explanations by two simultaneous steps, of the pairs that explain most to first order; best first."""
    p = scan.energy.shape[1]
    if p < 2:
        return []
    best = sorted((_best_pair_onset(scan, i, j) for i, j in combinations(range(p), 2)), reverse=True)[:_TRIED]
    hypotheses = []
    for _, entry, (i, j) in best:
        size = pseudo_inverse(scan.J[entry][np.ix_([i, j], [i, j])]) @ scan.s[entry, [i, j]]
        onset = int(scan.onsets[entry])
        hypotheses.append((Event(i, onset, 0.0, float(size[0])), Event(j, onset, 0.0, float(size[1]))))
    fits = yield from fit_sizes(window, hypotheses)
    refined = yield from refine_onsets(fits, [0])
    explanations = [
        replace(fit, statistic=energy / (1.0 + (window.end - fit.onset) / memory))
        for fit, (energy, *_) in zip(
            [*refined, *(fits.explanation(k) for k in range(1, len(hypotheses)))], best, strict=True
        )
    ]
    return sorted(explanations, key=lambda e: e.cost)


def _best_pair_onset(scan: FirstOrderScan, i: int, j: int) -> tuple[float, int, tuple[int, int]]:
    """Return (energy, entry, channels) of the onset at which steps in two channels explain most: sᵀ J⁻¹ s of the
    pair."""
    steps = np.arange(len(scan.J))
    J, s = scan.J[:, [i, j]][:, :, [i, j]], scan.s[steps][:, [i, j]]
    D = np.maximum(np.einsum("dii->di", J), 1e-300)
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] ** 2
    separable = det > 1e-6 * D[:, 0] * D[:, 1]
    energy = np.where(
        separable,
        (J[:, 1, 1] * s[:, 0] ** 2 - 2 * J[:, 0, 1] * s[:, 0] * s[:, 1] + J[:, 0, 0] * s[:, 1] ** 2)
        / np.where(separable, det, 1.0),
        0.0,
    )
    k = int(energy.argmax())
    return float(energy[k]), k, (i, j)
