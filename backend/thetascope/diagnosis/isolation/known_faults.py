"""What was found is taken as known: findings get their sizes and their ends, and the filter is told."""

from dataclasses import replace

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.decision_state import (
    NEVER,
    DecisionState,
    Event,
    Evidence,
    FilterRestart,
    Finding,
    TentativeEvent,
    TentativeEvents,
)
from thetascope.diagnosis.isolation.first_order import onset_interval
from thetascope.diagnosis.isolation.likelihood_fit import Explanation
from thetascope.diagnosis.isolation.ramp_uncertainty import shape_variance
from thetascope.diagnosis.isolation.replay import ReplayWindow

VAGUEST = 3.0  # times as uncertain as if its shape were known is a rise that is still going on
GONE = 0.2  # of its size: a fault whose estimate falls below is over
LEAST = 4  # decisions that an answer takes: a single outlier looks like anything over one
SOON = 20  # decisions after which a fault may have changed since it was named
RECENT = 100  # decisions within which an output that fails again has not been well


def commit_fit(state: DecisionState, evidence: Evidence, fit: Explanation) -> DecisionState:
    """Take what is pending as known, with the sizes of a fit; findings are told them."""
    tentative = _merge_ramp(state.tentative, fit)
    sizes = {e.shape_key: e for e in fit.events}
    entries = tuple(replace(entry, event=sizes.get(entry.event.shape_key, entry.event)) for entry in tentative.entries)
    events = tuple(entry.event for entry in entries)
    known = tentative.base.plus(events, state.at).within_bounds(evidence.thresholds.bounds)
    length = state.at - fit.onset
    memory = float(length) / (4 if any(e.is_drift for e in fit.events) else 1)
    before = {i: state.findings[i] for i in state.active}
    state = replace(state, known=known, tentative=replace(tentative, entries=entries), memory=memory, start=state.at)
    window = ReplayWindow.of(evidence, tentative.base, events, tentative.begin, state.at, state.trusted_outputs)
    state = replace(state, restart=FilterRestart(window.replay.states[1:]))
    for i in state.active:  # an event that is seen otherwise now may have been a change of an older fault
        if state.findings[i].channel is not None:
            state = with_finding(
                state, i, replace(state.findings[i], size=float(known.level[state.findings[i].channel]))
            )
    known_before = [f for f in before.values() if f.channel is not None]
    over = []
    for k, event in enumerate(fit.events):
        i = next((entry.finding for entry in entries if entry.event == event), None)
        if i is None:  # it is part of another event now, which will be estimated anew
            continue
        deviation, v = _size_deviation(state, evidence, fit, k, known_before)
        if 0 < event.rise_time < np.inf:
            shape = _shape_deviation(state, evidence, events, fit, k)
            deviation = (
                float(np.hypot(deviation, shape))
                if shape
                else max(state.findings[i].deviation, deviation * _shape_inflation(window, event, deviation, v))
            )
        if (
            tentative.base.slope[event.channel] or tentative.base.asymptote[event.channel]
        ):  # it went on from a level that is not known better
            deviation = float(np.hypot(deviation, before[i].deviation))
        size = float(known.level[event.channel])
        had = float(tentative.base.plus(tuple(e for e in events if e != event), event.onset).level[event.channel])
        least = max(GONE * abs(had or before[i].size), 3.0 * deviation)
        settled = state.at - state.findings[i].raised_at >= SOON or any(
            entry.finding == i and not entry.own for entry in entries
        )  # not a moment after
        coming = max(abs(known.slope[event.channel]) * max(length, LEAST), abs(size + known.asymptote[event.channel]))
        if settled and abs(size) < least and coming < least:
            over.append(i)
            state = with_finding(state, i, with_settled_size(replace(before[i], size=had or before[i].size)))
        else:
            first = state.findings[i].initial or (size, deviation)
            state = with_finding(state, i, replace(state.findings[i], size=size, deviation=deviation, initial=first))
    return clear_findings(state, over) if over else _remember_settled(state, entries)


def with_settled_size(found: Finding) -> Finding:
    """With the size that it had when nothing had happened for a while, if there was such a time."""
    return found if found.settled is None else replace(found, size=found.settled[0], deviation=found.settled[1])


def _remember_settled(state: DecisionState, entries: tuple[TentativeEvent, ...]) -> DecisionState:
    """With the sizes remembered of faults to which nothing has happened for a while."""
    if state.at - max(entry.event.onset for entry in entries) < SOON:
        return state
    changed = {
        entry.finding for entry in entries if not entry.own and state.at - entry.event.onset < RECENT
    }  # perhaps: it may turn out to be its end
    for i in set(state.active) - changed:
        state = with_finding(
            state, i, replace(state.findings[i], settled=(state.findings[i].size, state.findings[i].deviation))
        )
    return state


def _size_deviation(
    state: DecisionState, evidence: Evidence, fit: Explanation, k: int, known: list[Finding]
) -> tuple[float, float]:
    """Standard deviation of what event ``k`` of a fit has reached, if its shape is so, and the v that it rests on (`WindowNoise`); ``known``: the
    faults that were known before."""
    event, noise = fit.events[k], evidence.thresholds.noise
    settling, long = (
        float(noise.v[noise.nearest(n), event.channel]) for n in (2 * evidence.thresholds.settle, state.at - fit.onset)
    )
    v = long + float(fit.early[k]) * max(settling - long, 0.0)
    others = sum((fit.passed[k, f.channel] * f.deviation) ** 2 for f in known if f.channel != event.channel)
    variance = max(v * fit.covariance[k, k], 0.0)
    # errors of old standing are partly taken up by x
    return float(np.sqrt(variance + min(others, variance)) * abs(event.unit_value(state.at))), v


def _shape_deviation(
    state: DecisionState, evidence: Evidence, events: tuple[Event, ...], fit: Explanation, k: int
) -> float:
    """Standard deviation of what an event has reached by now since its shape is estimated as well; 0 if that cannot be told.

    What decides a shape are its ends, and there noise is white, unlike over the whole.
    """
    others = tuple(e for e in events if e not in fit.events)
    return (
        shape_variance(
            ReplayWindow.of(
                evidence, state.tentative.base, others, state.tentative.begin, state.at, state.trusted_outputs
            ),
            fit.events,
            k,
        )
        ** 0.5
    )


def _shape_inflation(window: ReplayWindow, event: Event, deviation: float, v: float) -> float:
    """By how much less is known of the size of a rise since its shape is estimated as well: it is known by what came after it."""
    if not 0 < event.rise_time < np.inf:
        return 1.0
    end = min(int(event.onset + event.rise_time * (2 if event.exponential else 1)), window.end - 1)
    J = float(window.future.ww[max(end - window.begin, 0), event.channel, event.channel])
    return float(np.clip((v / max(J, 1e-300)) ** 0.5 / max(deviation, 1e-300), 1.0, VAGUEST))


def _merge_ramp(tentative: TentativeEvents, fit: Explanation) -> TentativeEvents:
    """A rise that a later event of its channel brings to an end is one event: a rise with an end."""
    last = tentative.entries[-1]
    sizes = {e.shape_key: (e, fit.covariance[k, k]) for k, e in enumerate(fit.events)}
    for k, entry in enumerate(tentative.entries[:-1]):
        one = entry.event
        two, variance = sizes.get(last.event.shape_key, (last.event, 0.0))
        rising = one.is_drift and two.is_drift and one.channel == two.channel and two.onset > one.onset
        if rising and abs(one.size + two.size) < max(3.0 * variance**0.5, GONE * abs(one.size)):
            rise = float(two.onset - one.onset)
            event = Event(one.channel, one.onset, rise, one.size * rise)
            rest = (
                *tentative.entries[:k],
                replace(entry, event=event, options=(event,)),
                *tentative.entries[k + 1 : -1],
            )
            return replace(tentative, entries=rest)
    return tentative


def clear_findings(state: DecisionState, which: list[int]) -> DecisionState:
    """Findings that are over; what the filter took as known of them becomes zero."""
    known = state.known.plus((), state.at).without(
        [state.findings[i].channel for i in which if state.findings[i].channel is not None]
    )
    for i in which:
        state = with_finding(state, i, replace(state.findings[i], cleared=state.at))
    active = tuple(k for k in state.active if k not in which)
    memory = state.memory if any(state.findings[k].channel is not None for k in active) else np.inf
    change = FilterRestart() if state.restart is None else state.restart
    return replace(state, known=known, active=active, memory=memory, restart=change, start=state.at, tentative=None)


def with_finding(state: DecisionState, i: int, found: Finding) -> DecisionState:
    return replace(state, findings=(*state.findings[:i], found, *state.findings[i + 1 :]))


def assign_finding(
    state: DecisionState,
    window: ReplayWindow,
    statistic: float,
    event: Event,
    options: tuple[Event, ...],
    own: int | None,
):
    """The finding that an event belongs to: its ``own`` under a better name, that of its channel, or a new one."""
    others = tuple(dict.fromkeys(o.channel for o in options if o.channel != event.channel))
    held = [i for i in state.active if state.findings[i].channel == event.channel and i != own]
    if held:
        return (state if own is None else clear_findings(state, [own])), held[0], False
    span = onset_interval(window, event)
    if own is not None:
        found = state.findings[own]
        if found.channel != event.channel:  # what it was as another fault says nothing of this one
            found = replace(found, size=0.0, settled=None, initial=None)
        found = replace(
            found, channel=event.channel, alternatives=others, onset=event.onset, onset_from=span[0], onset_to=span[1]
        )
        return with_finding(state, own, found), own, True
    found = Finding(state.at, event.channel, others, event.onset, *span, 0.0, 0.0, statistic)
    state = replace(state, findings=(*state.findings, found), active=(*state.active, len(state.findings)))
    return state, len(state.findings) - 1, True


def withdraw(state: DecisionState, entry: TentativeEvent) -> DecisionState:
    """What was named last turns out to be something else altogether: its own finding is over."""
    return clear_findings(state, [entry.finding]) if entry.own and entry.finding in state.active else state


def exclude_output(
    state: DecisionState, evidence: Evidence, output: int, onset: int, statistic: float
) -> DecisionState:
    """An output is not followed from an onset on. What was named since, or just before, was named because of it."""
    state = drop_stale(state, evidence)
    onset = max(onset, earliest_replay(state, evidence), evidence.thresholds.begin)
    tentative, entries = state.tentative, () if state.tentative is None else state.tentative.entries
    mistaken = tuple(
        entry
        for entry in entries
        if entry.event.onset_decision >= onset - LEAST
        or (entry.own and state.at - state.findings[entry.finding].raised_at < SOON)
    )
    own = [entry.finding for entry in mistaken if entry.own and entry.finding in state.active]
    if mistaken:
        onset = max(min(onset, *(entry.event.onset_decision for entry in mistaken)), tentative.begin)
        rest = tuple(entry.event for entry in tentative.entries if entry not in mistaken)
        known = tentative.base.plus(rest, onset)
    else:
        known = state.known
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[output] = 0.0
    states = (
        evidence.segment(onset, state.at, known.course)
        .replay(evidence.filter_state(onset), onset, trusted_outputs, False)
        .states
    )
    state = clear_findings(state, own[1:]) if own[1:] else state
    state = replace(
        state,
        known=known.plus((), state.at),
        tentative=None,
        detected=None,
        start=state.at,
        trusted_outputs=trusted_outputs,
        restart=FilterRestart(states),
    )
    found = Finding(state.at, None, (), onset, onset, onset, np.nan, np.nan, statistic, output)
    again = [
        i
        for i, f in enumerate(state.findings)
        if f.output == output and f.cleared is not None and state.at - f.cleared < RECENT
    ]
    if own:
        return with_finding(state, own[0], replace(found, raised_at=state.findings[own[0]].raised_at))
    if again:
        return replace(
            with_finding(state, again[-1], replace(state.findings[again[-1]], cleared=None)),
            active=(*state.active, again[-1]),
        )
    return replace(state, findings=(*state.findings, found), active=(*state.active, len(state.findings)))


def earliest_replay(state: DecisionState, evidence: Evidence) -> int:
    """The earliest decision from which the filter can be run again, however the rows came in."""
    return max(evidence.oldest, state.at - LONGEST)


def drop_stale(state: DecisionState, evidence: Evidence) -> DecisionState:
    """With what is pending since longer ago than the filter can be run again from left as it is, or without what was before it."""
    tentative, begin = state.tentative, earliest_replay(state, evidence)
    if tentative is None or tentative.begin >= begin:
        return state
    if all(entry.event.onset_decision > begin for entry in tentative.entries):
        return replace(state, tentative=replace(tentative, begin=begin, base=tentative.base.plus((), begin)))
    over = tuple(entry for entry in tentative.entries if entry.event.is_over(begin))
    entries = tuple(entry for entry in tentative.entries if entry not in over)
    return replace(
        state,
        tentative=TentativeEvents(
            begin, tentative.base.plus(tuple(entry.event for entry in over), begin), entries, NEVER, settled=True
        ),
    )
