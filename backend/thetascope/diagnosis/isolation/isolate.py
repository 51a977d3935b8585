"""Isolation: find the fault behind a detected change, either a new event or a revision of the latest ones."""

from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.candidates import AMBIGUOUS, double_faults, faulty_outputs, single_faults
from thetascope.diagnosis.isolation.decision_state import (
    DecisionState,
    Event,
    Evidence,
    FilterRestart,
    Finding,
    TentativeEvent,
    TentativeEvents,
)
from thetascope.diagnosis.isolation.first_order import first_order_scan
from thetascope.diagnosis.isolation.known_faults import (
    BEFORE,
    LEAST,
    SOON,
    assign_finding,
    commit_fit,
    drop_stale,
    earliest_replay,
    exclude_output,
    withdraw,
)
from thetascope.diagnosis.isolation.likelihood_fit import CLEAR, Explanation, event_penalty
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times after which the best explanation is accepted as it is,
MOST_PATIENCE = 100  # or this number of decisions, if that is less
REVISABLE = (
    LONGEST // 2
)  # decisions after which an event is no longer revised, so that it does not absorb later changes
ACCEPTED_RESIDUAL = 4.0  # standard deviations of the noise's energy that a true explanation may leave
DOUBTFUL_RESIDUAL = 3.0  # the same, above which other hypotheses are tried too
MOST_TENTATIVE = 3  # events that may be revised at one time


@dataclass(frozen=True)
class RankedExplanations:
    """Explanations of one window of data, best first.

    Attributes:
        window: the data.
        ranked: the explanations by cost.
        revised: the tentative events that they replace.
    """

    window: ReplayWindow
    ranked: list[Explanation]
    revised: tuple[TentativeEvent, ...] = ()

    @property
    def leader(self) -> Explanation:
        """The best explanation."""
        return self.ranked[0]


def isolate_fault(state: DecisionState, evidence: Evidence) -> Steps[DecisionState]:
    """Return the state one decision later: the detected change is isolated, dismissed, or left for more data."""
    assert state.detected is not None
    thresholds, at = evidence.thresholds, state.at + 1
    waited = at - state.detected
    state = drop_stale(replace(state, at=at), evidence)
    if at < state.next_attempt:
        return state
    choice = yield from _new_events(state, evidence, LEAST if waited < 2 * LEAST else 0)
    last = _last_review(state)
    if last is not None and (_review_due(waited) or at == last or _is_ready(choice, state, evidence, waited)):
        choice = yield from _or_revision(state, evidence, choice)
    leader = choice.leader
    vanished = max(e.statistic for e in choice.ranked) < 0.5 * thresholds.glr and leader.output is None
    if vanished and leader.left < 0.5 * thresholds.residual and waited > thresholds.settle:
        return replace(state, detected=None, passed=at - thresholds.settle)
    if not _is_ready(choice, state, evidence, waited):
        attempt = at + max(1, waited // 2)
        return replace(state, next_attempt=last if last is not None and at < last < attempt else attempt)
    explained = leader.left < ACCEPTED_RESIDUAL or leader.share >= SHARE
    if leader.output is None and leader.statistic > 0.5 * thresholds.glr and explained:
        return (yield from accept_leader(state, evidence, choice))
    return (yield from _raise_unexplained(state, evidence, choice))


def _review_due(waited: int) -> bool:
    """Return whether to review the latest events although no decision is due: after 4, 8, 16 … decisions of waiting."""
    return waited >= LEAST and waited & (waited - 1) == 0


def _last_review(state: DecisionState) -> int | None:
    """Return the last decision at which the latest event can be reviewed with all its data; None: nothing to review."""
    tentative = state.tentative
    if tentative is None or tentative.settled:
        return None
    return _data_until(tentative.entries[-1].event.onset_decision)


def _data_until(onset: int) -> int:
    """Return the last decision at which all data since an onset are available."""
    return onset + LONGEST - 1


def next_review(state: DecisionState, onset: int) -> int:
    """Return when to review an event: when there are twice as many data, and once more before they are dropped."""
    following, last = state.at + max(2, state.at - onset), _data_until(onset)
    return last if state.at < last < following else following


def _is_ready(choice: RankedExplanations, state: DecisionState, evidence: Evidence, waited: int) -> bool:
    """Return whether to decide: the leader is clear and has enough data, or patience has run out."""
    leader = choice.leader
    enough = state.at - leader.onset >= (LEAST if len(leader.events) == 1 else 2 * LEAST)
    enough &= leader.output is not None or leader.statistic > evidence.thresholds.glr
    enough &= waited >= 2 * LEAST or not any(e.rise_time for e in leader.events)  # a slow fault shows late
    clear = _is_clear(choice) and enough and leader.left < ACCEPTED_RESIDUAL
    return clear or waited >= _patience(choice, state, evidence)


def _patience(choice: RankedExplanations, state: DecisionState, evidence: Evidence) -> int:
    """Return after how many decisions the leader is accepted as it is: later if it is open whether the fault is new."""
    held = _held_channels(state)
    near = [e for e in choice.ranked if e.cost - choice.leader.cost < CLEAR and e.output is None]
    if len({bool({v.channel for v in e.events} & held) for e in near}) > 1:
        return MOST_PATIENCE
    return min(PATIENCE * max(evidence.thresholds.settle, LEAST), MOST_PATIENCE)


def _held_channels(state: DecisionState) -> set[int]:
    """Return the channels with a finding that is on."""
    return {channel for i in state.active if (channel := state.findings[i].channel) is not None}


def _is_clear(choice: RankedExplanations) -> bool:
    """Return whether the leader has no rival, or is among the options that it was known to have."""
    leader = choice.leader
    if choice.revised and leader.output is None and {e.channel for e in leader.events} <= _channels(choice.revised):
        return True
    rivals = [e for e in choice.ranked[1:] if e.output is None or leader.output is None]
    return not rivals or rivals[0].cost - leader.cost > CLEAR


# ---- hypotheses ------------------------------------------------------------------------------------------------------


def _new_events(state: DecisionState, evidence: Evidence, least_length: int) -> Steps[RankedExplanations]:
    """Return the explanations by new events; `least_length`: see `single_faults`."""
    tentative, held = state.tentative, _held_channels(state)
    yield
    if tentative is None:
        begin = max(state.start, earliest_replay(state, evidence))
        window = ReplayWindow.of(evidence, state.known, (), begin, state.at, state.trusted_outputs)
        memory = state.memory
    else:
        window = ReplayWindow.of(
            evidence, tentative.base, tentative.events, tentative.begin, state.at, state.trusted_outputs
        )
        memory = state.memory if tentative.settled else np.inf
    ranked = yield from _explanations(window, memory, held, least_length=least_length)
    return RankedExplanations(window, ranked)


def _or_revision(state: DecisionState, evidence: Evidence, new: RankedExplanations) -> Steps[RankedExplanations]:
    """Return the best revision of the latest events if it explains the data better than new events, else `new`."""
    tentative = state.tentative
    assert tentative is not None
    groups = dict.fromkeys(
        group
        for entry in (*latest_open(tentative), tentative.entries[-1])
        for group in ((entry,), coupled_events(tentative, entry))
    )
    revisions = []
    for group in groups:
        alternatives = yield from alternatives_of(state, evidence, group)
        revisions.append(alternatives)
    revision = min(revisions, key=lambda r: r.leader.cost - penalty_of(r.revised))
    group = revision.revised
    # a fault isolated a moment ago was isolated wrongly, rather than that it has changed already
    repeated = any(entry.own for entry in group) and {e.channel for e in new.leader.events} == {group[-1].event.channel}
    bonus = CLEAR if repeated and state.at - state.findings[group[-1].finding].raised_at < SOON else 0.0
    return revision if revision.leader.cost < new.leader.cost + penalty_of(group) + bonus else new


def latest_open(tentative: TentativeEvents) -> list[TentativeEvent]:
    """Return the latest event that has alternatives, if there is one."""
    return [entry for entry in tentative.entries if len(entry.options) > 1][-1:]


def coupled_events(tentative: TentativeEvents, member: TentativeEvent) -> tuple[TentativeEvent, ...]:
    """Return the events that belong to the same fault as `member`: if one is wrong, so are the others."""
    return tuple(entry for entry in tentative.entries if entry.finding == member.finding)


def penalty_of(entries: tuple[TentativeEvent, ...]) -> float:
    """Return the sum of the penalties of events, in twice the log-likelihood."""
    return sum(event_penalty(entry.event) for entry in entries)


def _channels(entries: tuple[TentativeEvent, ...]) -> set[int]:
    """Return the channels that events may belong to."""
    return {channel for entry in entries for channel in entry.channels}


def alternatives_of(
    state: DecisionState, evidence: Evidence, group: tuple[TentativeEvent, ...]
) -> Steps[RankedExplanations]:
    """Return what may replace tentative events: an event of another shape, or another fault."""
    tentative, own = state.tentative, any(entry.own for entry in group)
    assert tentative is not None
    others = tuple(entry.event for entry in tentative.entries if entry not in group)
    yield
    window = ReplayWindow.of(evidence, tentative.base, others, tentative.begin, state.at, state.trusted_outputs)
    held = _held_channels(state) - ({group[-1].event.channel} if own else set())
    options = tuple(dict.fromkeys(o for entry in group for o in entry.options))
    explanations = yield from _explanations(window, np.inf, held, options)
    return RankedExplanations(window, _prefer_channel(explanations, group[-1].event.channel), group)


def _prefer_channel(ranked: list[Explanation], channel: int) -> list[Explanation]:
    """Return explanations with that of a channel first if it is as good as the best."""
    same = [e for e in ranked if [v.channel for v in e.events] == [channel]]
    if same and same[0].cost < ranked[0].cost + AMBIGUOUS:
        return [same[0], *(e for e in ranked if e is not same[0])]
    return ranked


def _explanations(
    window: ReplayWindow, memory: float, held: set[int], options: tuple[Event, ...] = (), least_length: int = 0
) -> Steps[list[Explanation]]:
    """Return explanations by cost: one fault, and if that leaves too much, a faulty output or two faults; see
    `single_faults`."""
    scan = yield from first_order_scan(window, bool(options))
    explanations, refined = yield from single_faults(window, scan, memory, held, options, least_length)
    if explanations[0].left > DOUBTFUL_RESIDUAL and refined:
        if not any(_is_acceptable(window, e) for e in explanations):
            explanations += yield from faulty_outputs(window)
        explanations += yield from double_faults(window, scan, memory)
    return sorted(explanations, key=lambda e: e.cost)


def _is_acceptable(window: ReplayWindow, explanation: Explanation) -> bool:
    long_enough = window.end - explanation.onset >= 2 * LEAST
    significant = explanation.statistic > window.evidence.thresholds.glr
    return explanation.left < ACCEPTED_RESIDUAL and significant and long_enough


# ---- decisions -------------------------------------------------------------------------------------------------------


def accept_leader(state: DecisionState, evidence: Evidence, choice: RankedExplanations) -> Steps[DecisionState]:
    """Accept the best explanation, raise or revise its findings, and restart the filter."""
    leader, window, tentative = choice.leader, choice.window, state.tentative
    named = {e.channel for e in leader.events}
    old = tuple(e for e in (() if tentative is None else tentative.entries) if e not in choice.revised)
    own = sorted((e for e in choice.revised if e.own), key=lambda e: e.event.channel not in named)
    reused = own[0] if own else None
    for other in own[1:]:  # two findings turn out to be one
        state = withdraw(state, other) if other.finding != own[0].finding else state
    if reused is not None and not named & _channels(choice.revised):
        state, reused = withdraw(state, reused), None
    new = []
    for event in leader.events:
        options = (event, *_other_options(choice, event))
        reuse = reused if reused is not None and event.channel in _channels(choice.revised) else None
        finding = None if reuse is None else reuse.finding
        state, i, is_own = yield from assign_finding(state, window, leader.statistic, event, options, finding)
        reused = None if reuse is not None else reused
        new.append(TentativeEvent(event, i, is_own, options))
    begin, base, review_at = window.begin, window.base, next_review(state, leader.onset)
    if tentative is None or len(old) + len(new) > MOST_TENTATIVE or state.at - begin > REVISABLE:
        begin = max(begin, _window_begin(state, old, new))
        over = tuple(e for e in old if e.event.onset_decision < begin and e.event.is_over(begin))  # no longer revised
        base, old = base.plus(tuple(e.event for e in over), begin), tuple(e for e in old if e not in over)
    state = replace(state, detected=None, tentative=TentativeEvents(begin, base, (*old, *new), review_at))
    return (yield from commit_fit(state, evidence, leader))


def _window_begin(state: DecisionState, old: tuple[TentativeEvent, ...], new: list[TentativeEvent]) -> int:
    """Return the decision from which data are needed: as long before the new events as after them, at least BEFORE,
    without cutting a rise in two."""
    onset = min(entry.event.onset_decision for entry in new)
    faults = {entry.finding for entry in new}
    related = (e.event.onset_decision for e in old if e.event.is_drift or e.finding in faults)
    first = min([onset, *related]) - max(state.at - onset, BEFORE)
    for event in sorted((entry.event for entry in old), key=lambda e: -e.onset):
        first = first if event.is_over(first) else min(first, event.onset_decision)
    return first


def _other_options(choice: RankedExplanations, event: Event) -> list[Event]:
    """Return the events that could replace one of the leader's: those of equally good explanations that differ in it
    alone."""
    leader = choice.leader
    rest = {e.channel for e in leader.events} - {event.channel}
    options = []
    for other in choice.ranked[1:]:
        differing = [e for e in other.events if e.channel not in rest]
        equally_good = other.cost - leader.cost < AMBIGUOUS and len(other.events) == len(leader.events)
        if equally_good and len(differing) == 1:
            options.append(differing[0])
    return options


def _raise_unexplained(state: DecisionState, evidence: Evidence, choice: RankedExplanations) -> Steps[DecisionState]:
    """Return the state with a finding that no channel explains: one output is faulty, or the model lacks the fault."""
    outputs = [e for e in choice.ranked if e.output is not None]
    if not outputs:
        outputs = yield from faulty_outputs(choice.window)
    best = min(outputs, key=lambda e: e.cost)
    left = min((e.left for e in choice.ranked if e.output is None), default=best.left)
    if best.output is not None and (best.left < evidence.thresholds.residual or best.share >= SHARE):
        return (yield from exclude_output(state, evidence, best.output, best.onset, left))
    onset = best.onset
    finding = Finding(state.at, None, (), onset, onset, onset, np.nan, np.nan, left, best.output)
    return replace(
        state,
        detected=None,
        start=state.at,
        findings=(*state.findings, finding),
        active=(*state.active, len(state.findings)),
        restart=FilterRestart(),
        tentative=None,
    )
