"""Revise the latest events as data come in: their sizes, what else they may be, and whether all of them are needed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.decision_state import (
    NEVER,
    DecisionState,
    Evidence,
    TentativeEvent,
    TentativeEvents,
)
from thetascope.diagnosis.isolation.isolate import (
    REVISABLE,
    accept_leader,
    alternatives_of,
    coupled_events,
    latest_open,
    next_review,
    penalty_of,
)
from thetascope.diagnosis.isolation.known_faults import commit_fit, drop_stale, withdraw
from thetascope.diagnosis.isolation.likelihood_fit import Explanation, event_penalty, fit_sizes
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

REVISABLE_RISE = (
    LONGEST - 50
)  # decisions after which a rise is no longer revised: its size shows later than a step's (REVISABLE)
_CLOSE = 8  # events are close if their distance is this many times shorter than the time since then


def revise_tentative(state: DecisionState, evidence: Evidence) -> Steps[DecisionState]:
    """Return the state with its tentative events reviewed on the data that came since."""
    state = drop_stale(state, evidence)
    if state.tentative is None or state.tentative.settled:
        return state
    state, tentative, fit = yield from _pruned(state, state.tentative, evidence)
    candidates = (group for entry in latest_open(tentative) for group in (coupled_events(tentative, entry), (entry,)))
    for group in dict.fromkeys((*candidates, *_close_pairs(state, tentative))):
        choice = yield from alternatives_of(state, evidence, group)
        better = len(group) == 1
        if not better:
            present = yield from _present_energy(state, tentative, evidence)
            better = choice.leader.cost < present + penalty_of(group)
        if choice.leader.output is None and len(choice.leader.events) == 1 and better:
            return _settle_old((yield from accept_leader(state, evidence, choice)))
    review_at = next_review(state, tentative.entries[-1].event.onset_decision)
    state = replace(state, tentative=replace(tentative, review_at=review_at))
    return _settle_old((yield from commit_fit(state, evidence, fit)))


def _pruned(
    state: DecisionState, tentative: TentativeEvents, evidence: Evidence
) -> Steps[tuple[DecisionState, TentativeEvents, Explanation]]:
    """Return the state without events whose removal costs less than their penalty, the events that remain, and their
    fit."""
    fit = yield from _refit(state, tentative, evidence)
    while len(tentative.entries) > 1:
        entries = tentative.entries
        reduced = [replace(tentative, entries=tuple(e for e in entries if e is not removed)) for removed in entries]
        fits = []
        for others in reduced:
            refit = yield from _refit(state, others, evidence)
            fits.append(refit)
        loss = [f.energy - fit.energy - event_penalty(e.event) for f, e in zip(fits, entries, strict=True)]
        k = int(np.argmin(loss))
        if loss[k] >= 0:
            break
        removed, tentative, fit = entries[k], reduced[k], fits[k]
        alone = all(entry.finding != removed.finding for entry in tentative.entries)
        state = replace(withdraw(state, removed) if alone else state, tentative=tentative)
    return state, tentative, fit


def _refit(state: DecisionState, tentative: TentativeEvents, evidence: Evidence) -> Steps[Explanation]:
    """Return a fit of each channel's latest event; earlier events of the same channel stay as they are."""
    latest = {entry.event.channel: entry.event for entry in tentative.entries}
    fixed = tuple(event for event in tentative.events if event not in latest.values())
    yield
    window = ReplayWindow.of(evidence, tentative.base, fixed, tentative.begin, state.at, state.trusted_outputs)
    fits = yield from fit_sizes(window, [tuple(latest.values())])
    return fits.explanation(0)


def _present_energy(state: DecisionState, tentative: TentativeEvents, evidence: Evidence) -> Steps[float]:
    """Return the energy that the tentative events leave, in units of noise."""
    yield
    window = ReplayWindow.of(
        evidence, tentative.base, tentative.events, tentative.begin, state.at, state.trusted_outputs
    )
    return float(window.energy[-1]) / window.noise_unit


def _settle_old(state: DecisionState) -> DecisionState:
    """Return the state with tentative events settled if they are too old to be revised."""
    if state.tentative is None:
        return state
    last = state.tentative.entries[-1].event
    if state.at - last.onset_decision <= (REVISABLE_RISE if last.rise_time else REVISABLE):
        return state
    return replace(state, tentative=replace(state.tentative, settled=True, review_at=NEVER))


def _close_pairs(state: DecisionState, tentative: TentativeEvents) -> list[tuple[TentativeEvent, TentativeEvent]]:
    """Return pairs of events of two findings that began at about the same time: one may compensate an error in the
    other."""
    pairs = []
    for a, b in pairwise(tentative.entries):
        first, second = a.event.onset_decision, b.event.onset_decision
        if a.finding != b.finding and abs(first - second) * _CLOSE < state.at - max(first, second):
            pairs.append((a, b))
    return pairs
