"""What was noticed gets a name, a new one or another for what was named last."""

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

SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times, after which an answer is given as it stands,
MOST_PATIENCE = 100  # decisions, if that is less
YOUNG = LONGEST // 2  # decisions after which a finding is left as it is, lest it take up what comes after
ACCEPTED_RESIDUAL = 4.0  # standard deviations of the noise's energy: what a true explanation may leave
DOUBTFUL_RESIDUAL = 3.0  # the same, from which on it is asked what else it may be
MOST_TENTATIVE = 3  # events that may still be seen otherwise


@dataclass(frozen=True)
class RankedExplanations:
    """Explanations of the same data, the best first; ``revised``: the events that are pending whose place they take."""

    window: ReplayWindow
    answers: list[Explanation]
    revised: tuple[TentativeEvent, ...] = ()

    @property
    def leader(self) -> Explanation:
        return self.answers[0]


def isolate_fault(state: DecisionState, evidence: Evidence) -> DecisionState:
    """One decision further with something noticed: name it, give it up, or wait for more."""
    cal, at = evidence.thresholds, state.at + 1
    state = drop_stale(replace(state, at=at), evidence)
    waited = at - state.detected
    if at < state.next_attempt:
        return state
    choice = _new_events(state, evidence, LEAST if waited < 2 * LEAST else 0)
    last = _last_review(state)
    if last is not None and (_review_due(waited) or at == last or _ready(choice, state, evidence, waited)):
        choice = _or_revision(state, evidence, choice)
    leader = choice.leader
    if (
        max(e.statistic for e in choice.answers) < 0.5 * cal.glr
        and leader.output is None
        and leader.left < 0.5 * cal.residual
        and waited > cal.settle
    ):
        return replace(state, detected=None, passed=at - cal.settle)  # it went away again
    if not _ready(choice, state, evidence, waited):
        again = at + max(1, waited // 2)
        return replace(state, next_attempt=last if last is not None and at < last < again else again)
    if (
        leader.output is None
        and leader.statistic > 0.5 * cal.glr
        and (leader.left < ACCEPTED_RESIDUAL or leader.share >= SHARE)
    ):
        return accept_leader(state, evidence, choice)
    return _unexplained(state, evidence, choice)


def _review_due(waited: int) -> bool:
    """When what was named last is looked at again though nothing is to be said yet: it takes long."""
    return waited >= LEAST and waited & (waited - 1) == 0


def _last_review(state: DecisionState) -> int | None:
    """The last decision at which what was named last can be looked at with all its data; None: nothing is to be looked at."""
    tentative = state.tentative
    return None if tentative is None or tentative.settled else _kept_until(tentative.entries[-1].event.onset_decision)


def _kept_until(onset: int) -> int:
    """The last decision at which all data since an onset are there."""
    return onset + LONGEST - 1


def next_review(state: DecisionState, onset: int) -> int:
    """When what began at an onset is looked at again: when there is twice as much data, and once more before these are forgotten."""
    following, last = state.at + max(2, state.at - onset), _kept_until(onset)
    return last if state.at < last < following else following


def _ready(choice: RankedExplanations, state: DecisionState, evidence: Evidence, waited: int) -> bool:
    """Whether an answer is given: it is sure and has taken its form, or it has been waited for long enough."""
    leader = choice.leader
    formed = state.at - leader.onset >= (LEAST if len(leader.events) == 1 else 2 * LEAST)
    formed &= leader.output is not None or leader.statistic > evidence.thresholds.glr
    formed &= waited >= 2 * LEAST or not any(
        e.rise_time for e in leader.events
    )  # a slow fault does not show from its onset on
    return (_sure(choice, state) and formed and leader.left < ACCEPTED_RESIDUAL) or waited >= _patience(
        choice, state, evidence
    )


def _patience(choice: RankedExplanations, state: DecisionState, evidence: Evidence) -> int:
    """Decisions after which an answer is given as it stands: more, if it is open whether a fault is new at all."""
    held = {state.findings[i].channel for i in state.active}
    near = [e for e in choice.answers if e.cost - choice.leader.cost < CLEAR and e.output is None]
    if len({bool({v.channel for v in e.events} & held) for e in near}) > 1:
        return MOST_PATIENCE
    return min(PATIENCE * max(evidence.thresholds.settle, LEAST), MOST_PATIENCE)


def _sure(choice: RankedExplanations, state: DecisionState) -> bool:
    """Whether the leader has no rival, or what it could be is known already."""
    leader = choice.leader
    if choice.revised and leader.output is None and {e.channel for e in leader.events} <= _channels(choice.revised):
        return True
    rivals = [e for e in choice.answers[1:] if e.output is None or leader.output is None]
    return not rivals or rivals[0].cost - leader.cost > CLEAR


def _new_events(state: DecisionState, evidence: Evidence, least_length: int) -> RankedExplanations:
    """What new events may explain the data; ``least_length``: see `single_faults`."""
    held = {state.findings[i].channel for i in state.active} - {None}
    tentative = state.tentative
    if tentative is None:
        window = ReplayWindow.of(
            evidence,
            state.known,
            (),
            max(state.start, earliest_replay(state, evidence)),
            state.at,
            state.trusted_outputs,
        )
        return RankedExplanations(window, _explanations(window, state.memory, held, least_length=least_length))
    window = ReplayWindow.of(
        evidence, tentative.base, tentative.events, tentative.begin, state.at, state.trusted_outputs
    )
    return RankedExplanations(
        window, _explanations(window, state.memory if tentative.settled else np.inf, held, least_length=least_length)
    )


def _or_revision(state: DecisionState, evidence: Evidence, new: RankedExplanations) -> RankedExplanations:
    """What was named last named otherwise, if that explains the data better than new events do."""
    tentative = state.tentative
    groups = dict.fromkeys(
        group
        for entry in (*latest_open(tentative), tentative.entries[-1])
        for group in ((entry,), coupled_events(tentative, entry))
    )
    instead = min(
        (alternatives_of(state, evidence, group) for group in groups),
        key=lambda c: c.leader.cost - penalty_of(c.revised),
    )
    # a fault named a moment ago was named wrongly, rather than that it has changed by now
    group = instead.revised
    changed = any(entry.own for entry in group) and {e.channel for e in new.leader.events} == {group[-1].event.channel}
    more = CLEAR if changed and state.at - state.findings[group[-1].finding].raised_at < SOON else 0.0
    return instead if instead.leader.cost < new.leader.cost + penalty_of(group) + more else new


def latest_open(tentative: TentativeEvents) -> list[TentativeEvent]:
    """The latest event that could be something else."""
    return [entry for entry in tentative.entries if len(entry.options) > 1][-1:]


def coupled_events(tentative: TentativeEvents, member: TentativeEvent) -> tuple[TentativeEvent, ...]:
    """The events that are seen as one fault with another: if that is wrong, so are they."""
    return tuple(entry for entry in tentative.entries if entry.finding == member.finding)


def penalty_of(entries: tuple[TentativeEvent, ...]) -> float:
    """What events cost themselves, in twice the log of a likelihood."""
    return sum(event_penalty(entry.event) for entry in entries)


def _channels(entries: tuple[TentativeEvent, ...]) -> set[int]:
    return set().union(*(entry.channels for entry in entries))


def alternatives_of(state: DecisionState, evidence: Evidence, group: tuple[TentativeEvent, ...]) -> RankedExplanations:
    """What else events that are pending may have been: one of another shape, or another fault."""
    tentative, own = state.tentative, any(entry.own for entry in group)
    others = tuple(entry.event for entry in tentative.entries if entry not in group)
    window = ReplayWindow.of(evidence, tentative.base, others, tentative.begin, state.at, state.trusted_outputs)
    held = {state.findings[i].channel for i in state.active} - {None, group[-1].event.channel if own else None}
    options = tuple(dict.fromkeys(o for entry in group for o in entry.options))
    return RankedExplanations(
        window, _keep_channel(_explanations(window, np.inf, held, options), group[-1].event.channel), group
    )


def _keep_channel(answers: list[Explanation], channel: int) -> list[Explanation]:
    """The name that was given comes first as long as it explains the data as well."""
    same = [e for e in answers if [v.channel for v in e.events] == [channel]]
    if same and same[0].cost < answers[0].cost + AMBIGUOUS:
        return [same[0], *(e for e in answers if e is not same[0])]
    return answers


def _explanations(
    window: ReplayWindow, memory: float, held: set[int], options: tuple[Event, ...] = (), least_length: int = 0
) -> list[Explanation]:
    seen = first_order_scan(window, bool(options))
    answers, exact = single_faults(window, seen, memory, held, options, least_length)
    if answers[0].left > DOUBTFUL_RESIDUAL and exact:
        glr = window.evidence.thresholds.glr
        if not any(
            e.left < ACCEPTED_RESIDUAL and e.statistic > glr and window.end - e.onset >= 2 * LEAST for e in answers
        ):
            answers += faulty_outputs(window)
        answers += double_faults(window, seen, memory)
    return sorted(answers, key=lambda e: e.cost)


# ---- findings ------------------------------------------------------------------------------------------------------------


def accept_leader(state: DecisionState, evidence: Evidence, choice: RankedExplanations) -> DecisionState:
    """The leading explanation is it. The filter is to be told."""
    leader, window, tentative = choice.leader, choice.window, state.tentative
    old: tuple[TentativeEvent, ...] = () if tentative is None else tentative.entries
    named = {e.channel for e in leader.events}
    again, *others = sorted(
        (entry for entry in choice.revised if entry.own), key=lambda entry: entry.event.channel not in named
    ) or [None]
    old = tuple(entry for entry in old if entry not in choice.revised)
    for other in others:  # two findings turn out to be one
        state = withdraw(state, other) if other.finding != again.finding else state
    if again is not None and not named & _channels(choice.revised):
        state, again = withdraw(state, again), None
    entries = []
    for event in leader.events:
        options = (event, *_other_options(choice, event))
        mine = again is not None and event.channel in _channels(choice.revised)
        state, i, own = assign_finding(state, window, leader.statistic, event, options, again.finding if mine else None)
        again = None if mine else again
        entries.append(TentativeEvent(event, i, own, options))
    begin, base, review = window.begin, window.base, next_review(state, leader.onset)
    if tentative is None or len(old) + len(entries) > MOST_TENTATIVE or state.at - begin > YOUNG:
        begin = max(begin, _window_begin(state, old, entries))
        over = tuple(
            entry for entry in old if entry.event.onset_decision < begin and entry.event.is_over(begin)
        )  # left as they are
        base, old = (
            base.plus(tuple(entry.event for entry in over), begin),
            tuple(entry for entry in old if entry not in over),
        )
    state = replace(state, detected=None, tentative=TentativeEvents(begin, base, (*old, *entries), review))
    return commit_fit(state, evidence, leader)


def _window_begin(state: DecisionState, old: tuple[TentativeEvent, ...], entries: list[TentativeEvent]) -> int:
    """The decision from which on data are needed: before what is new, and what belongs to it; no rise is cut in two."""
    new = min(entry.event.onset_decision for entry in entries)
    faults = {entry.finding for entry in entries}
    first = min(
        [new, *(entry.event.onset_decision for entry in old if entry.event.is_drift or entry.finding in faults)]
    ) - (state.at - new)
    for event in sorted((entry.event for entry in old), key=lambda e: -e.onset):
        first = first if event.is_over(first) else min(first, event.onset_decision)
    return first


def _other_options(choice: RankedExplanations, event: Event) -> list[Event]:
    """What else an event could be: of explanations that are as good and differ in it alone."""
    leader = choice.leader
    rest = {e.channel for e in leader.events} - {event.channel}
    found = []
    for other in choice.answers[1:]:
        mine = [e for e in other.events if e.channel not in rest]
        if other.cost - leader.cost < AMBIGUOUS and len(other.events) == len(leader.events) and len(mine) == 1:
            found.append(mine[0])
    return found


def _unexplained(state: DecisionState, evidence: Evidence, choice: RankedExplanations) -> DecisionState:
    """No channel explains it: an output is not to be trusted, or something is on that is not in the model."""
    outputs = [e for e in choice.answers if e.output is not None]
    if not outputs:
        outputs = faulty_outputs(choice.window)
    best = min(outputs, key=lambda e: e.cost)
    left = min((e.left for e in choice.answers if e.output is None), default=best.left)
    if best.left < evidence.thresholds.residual or best.share >= SHARE:
        return exclude_output(state, evidence, best.output, best.onset, left)
    found = Finding(state.at, None, (), best.onset, best.onset, best.onset, np.nan, np.nan, left, best.output)
    return replace(
        state,
        detected=None,
        start=state.at,
        findings=(*state.findings, found),
        active=(*state.active, len(state.findings)),
        restart=FilterRestart(),
        tentative=None,
    )
