"""What was named last is looked at again as data come in: its size, what else it may have been, and whether all of it is needed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.decision_state import NEVER, DecisionState, Evidence, TentativeEvent
from thetascope.diagnosis.isolation.isolate import (
    YOUNG,
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

SLOW = (
    LONGEST - 50
)  # decisions after which a rise is left as it is: it takes longer than a step (YOUNG) to show how large it becomes
_APART = 8  # times as long ago as they were apart: events that began at about the same time


def revise_tentative(state: DecisionState, evidence: Evidence) -> DecisionState:
    """What is pending, with the data that came since: what else it may have been, and how large it is."""
    state = drop_stale(state, evidence)
    if state.tentative is None or state.tentative.settled:
        return state
    state, fit = _pruned(state, evidence)
    tentative, last = state.tentative, state.tentative.entries[-1]
    for group in dict.fromkeys(
        (
            *(group for entry in latest_open(tentative) for group in (coupled_events(tentative, entry), (entry,))),
            *_close_pairs(state),
        )
    ):
        choice = alternatives_of(state, evidence, group)
        better = len(group) == 1 or choice.leader.cost < _current_residual(state, evidence) + penalty_of(group)
        if choice.leader.output is None and len(choice.leader.events) == 1 and better:
            return _settled(accept_leader(state, evidence, choice))
    state = replace(state, tentative=replace(state.tentative, review_at=next_review(state, last.event.onset_decision)))
    return _settled(commit_fit(state, evidence, fit))


def _pruned(state: DecisionState, evidence: Evidence) -> tuple[DecisionState, Explanation]:
    """Without events that are not needed: the others explain as much, but for what it costs. And the sizes of these."""
    fit = _refit(state, evidence, state.tentative.entries)
    while len(entries := state.tentative.entries) > 1:
        rest = [tuple(entry for entry in entries if entry is not without) for without in entries]
        fits = [_refit(state, evidence, others) for others in rest]
        more = [f.energy - fit.energy - event_penalty(entry.event) for f, entry in zip(fits, entries, strict=True)]
        k = int(np.argmin(more))
        if more[k] >= 0:
            break
        tentative = replace(state.tentative, entries=rest[k])
        alone = all(entry.finding != entries[k].finding for entry in rest[k])
        state, fit = replace(withdraw(state, entries[k]) if alone else state, tentative=tentative), fits[k]
    return state, fit


def _refit(state: DecisionState, evidence: Evidence, entries: tuple[TentativeEvent, ...]) -> Explanation:
    """Each channel's latest event estimated anew; what came before it in the same channel stays."""
    latest = {entry.event.channel: entry.event for entry in entries}
    fixed = tuple(entry.event for entry in entries if entry.event not in latest.values())
    window = ReplayWindow.of(
        evidence, state.tentative.base, fixed, state.tentative.begin, state.at, state.trusted_outputs
    )
    return fit_sizes(window, [tuple(latest.values())]).explained(0)


def _current_residual(state: DecisionState, evidence: Evidence) -> float:
    """What is left by what is pending, in twice the log of a likelihood."""
    tentative = state.tentative
    window = ReplayWindow.of(
        evidence, tentative.base, tentative.events, tentative.begin, state.at, state.trusted_outputs
    )
    return float(window.energy[-1]) / window.noise_unit


def _settled(state: DecisionState) -> DecisionState:
    """With what is pending left as it is, if that is no longer entries: what comes may have begun before."""
    last = None if state.tentative is None else state.tentative.entries[-1].event
    if last is None or state.at - last.onset_decision <= (SLOW if last.rise_time else YOUNG):
        return state
    return replace(state, tentative=replace(state.tentative, settled=True, review_at=NEVER))


def _close_pairs(state: DecisionState) -> list[tuple[TentativeEvent, ...]]:
    """Events of two findings that began at about the same time: one may have been made up to mend the other."""
    entries = state.tentative.entries
    return [
        (a, b)
        for a, b in pairwise(entries)
        if a.finding != b.finding
        and abs(a.event.onset_decision - b.event.onset_decision) * _APART
        < state.at - max(a.event.onset_decision, b.event.onset_decision)
    ]
