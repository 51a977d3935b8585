"""What could explain the data since some decision: one change of θ, two at once, or an output that cannot be trusted.

What is worth it (first_order.py) is held against the data in full (likelihood_fit.py). An output that cannot be trusted (stuck, delayed,
noisy, …) is tried by not heeding it: its prediction by the others is then compared with what it shows, as noise of a variance
to be estimated: N (1 + log(q/N)) in place of q, for N numbers.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.isolation.first_order import FirstOrderScan
from thetascope.diagnosis.isolation.likelihood_fit import (
    CLEAR,
    Explanation,
    fit_sizes,
    pseudo_inverse,
    refine_onsets,
    residual_score,
)
from thetascope.diagnosis.isolation.replay import ReplayWindow

AMBIGUOUS = 6.0  # an explanation within this is as good: odds below 20 to 1
ROUGHLY = 0.1  # of the energy explained: what first-order answers may be wrong by
_HELD = 4.0  # what a new fault has to explain more than a change of one that is on
_TRIED = 4  # explanations that are held against the data in full
_VAGUE = 3  # changes of θ that a distrusted output counts for
_BACK = 100  # decisions over which an output is compared with the others


def faulty_outputs(window: ReplayWindow) -> list[Explanation]:
    """For each output what not heeding it explains, from where it parts from what the filter makes of the others."""
    answers = []
    for k in np.flatnonzero(window.trusted_outputs):
        trusted_outputs = window.trusted_outputs.copy()
        trusted_outputs[k] = 0.0
        begin = max(window.begin, window.end - _BACK)
        one = window.expected_energy(window.end - begin, np.eye(len(trusted_outputs))[k])[0] / (
            window.end - begin
        )  # in a decision
        shown = window.replay_trusting(begin, trusted_outputs).q[:, k]
        left = (window.end - begin) - np.arange(window.end - begin)
        after = shown[-1] - shown[:-1]
        onset = begin + int(np.argmin(shown[:-1] + _vague(after, one * left)))
        seen = window.replay_trusting(onset, trusted_outputs)
        energy = (float(window.energy[onset - window.begin]) + float(seen.energy[-1])) / window.noise_unit
        energy += float(_vague(seen.q[-1, k], one * (window.end - onset))) / window.noise_unit
        found = residual_score(window, onset, float(seen.energy[-1]), trusted_outputs)
        answers.append(Explanation((), int(k), onset, energy, energy + CLEAR * _VAGUE, *found, np.zeros((0, 0))))
    return answers


def _vague(q: np.ndarray, expected: np.ndarray | float) -> np.ndarray:
    """Energy of numbers whose variance is estimated, at least one: instead of q, ``expected_energy`` being its mean."""
    return np.minimum(q, expected) + expected * np.log(np.maximum(q / expected, 1.0))


def single_faults(
    window: ReplayWindow,
    seen: FirstOrderScan,
    memory: float,
    held: set[int],
    options: tuple[Event, ...] = (),
    least_length: int = 0,
) -> tuple[list[Explanation], bool]:
    """One change of one channel: those that may be it, held against the data in full, the best first; and whether onsets were moved
    to where they fit best. They are not where the best began less than ``least_length`` decisions ago, or has an equal, so that
    nothing would be said anyway.

    ``options`` are tried whatever the first order says of them.
    """
    noise = window.evidence.thresholds.noise
    best = seen.energy.max(axis=0)
    order = np.argsort(-best)[:_TRIED]
    least = best[order[0]] * (1 - ROUGHLY) - AMBIGUOUS - CLEAR
    tried = [o for o in options if o.onset_decision >= window.begin]
    for place, c in enumerate(order):
        for entry in seen.best_by_shape(int(c)):
            if place > 1 and seen.energy[entry, c] < least:
                continue
            onset, rise = int(seen.onsets[entry]), float(seen.rise_times[entry])
            size = float(seen.s[entry, c]) / max(float(seen.D[entry, c]), 1e-300)
            tried.append(Event(int(c), onset, rise, size, bool(seen.exponential[entry])))
    fits = fit_sizes(window, [(event,) for event in tried])
    order = np.argsort(fits.cost, kind="stable")
    rivals = [fits.cost[i] for i in order if tried[i].channel != tried[order[0]].channel]
    hasty = window.end - fits.onset[order[0]] < least_length - 1 or (
        rivals and rivals[0] < fits.cost[order[0]] + AMBIGUOUS / 2
    )
    near = [int(i) for k, i in enumerate(order) if k < 2 or fits.cost[i] < fits.cost[order[0]] + 2 * CLEAR]
    own = {}  # of each channel the best, and those that may yet be as good
    for i in near:
        own.setdefault(tried[i].channel, []).append(i)
    near = [i for mine in own.values() for i in mine if fits.cost[i] < fits.cost[mine[0]] + AMBIGUOUS]
    near = [] if least_length and hasty else near
    answers = []
    for fit in [*refine_onsets(fits, near), *(fits.explained(int(i)) for i in order if i not in near)]:
        c, since = fit.events[0].channel, window.end - fit.onset
        taken = float(window.energy[-1]) / window.noise_unit - fit.energy
        statistic = taken / float(noise.largest_v[int(noise.nearest(since)), c]) / (1.0 + since / memory)
        bonus = _HELD if c in held else 0.0  # a fault that changes is likelier than a new one
        answers.append(replace(fit, cost=fit.cost - bonus, statistic=statistic))
    answers.sort(key=lambda e: e.cost)
    return [
        e for i, e in enumerate(answers) if e.events[0].channel not in {o.events[0].channel for o in answers[:i]}
    ], bool(near)


def double_faults(window: ReplayWindow, seen: FirstOrderScan, memory: float) -> list[Explanation]:
    """Two changes at one instant, of those that explain most to first order; the best first."""
    p, tried = seen.energy.shape[1], []
    if p < 2:
        return []
    steps = np.arange(len(seen.J))
    for i, j in combinations(range(p), 2):
        J, s = seen.J[:, [i, j]][:, :, [i, j]], seen.s[steps][:, [i, j]]
        D = np.maximum(np.einsum("dii->di", J), 1e-300)
        det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] ** 2
        apart = det > 1e-6 * D[:, 0] * D[:, 1]
        energy = np.where(
            apart,
            (J[:, 1, 1] * s[:, 0] ** 2 - 2 * J[:, 0, 1] * s[:, 0] * s[:, 1] + J[:, 0, 0] * s[:, 1] ** 2)
            / np.where(apart, det, 1.0),
            0.0,
        )
        k = int(energy.argmax())
        tried.append((float(energy[k]), k, (i, j)))
    tried = sorted(tried, reverse=True)[:_TRIED]
    tries = []
    for _, entry, (i, j) in tried:
        size = pseudo_inverse(seen.J[entry][np.ix_([i, j], [i, j])]) @ seen.s[entry, [i, j]]
        onset = int(seen.onsets[entry])
        tries.append((Event(i, onset, 0.0, float(size[0])), Event(j, onset, 0.0, float(size[1]))))
    fits = fit_sizes(window, tries)
    found = [*refine_onsets(fits, [0]), *(fits.explained(k) for k in range(1, len(tries)))]
    answers = [
        replace(fit, statistic=energy / (1.0 + (window.end - fit.onset) / memory))
        for fit, (energy, *_) in zip(found, tried, strict=True)
    ]
    return sorted(answers, key=lambda e: e.cost)
