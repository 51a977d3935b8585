"""Accept events as known: findings get their sizes and ends, and the filter is restarted with the new θ₀."""

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
from thetascope.diagnosis.isolation.onset_uncertainty import step_uncertainty
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.isolation.size_uncertainty import (
    base_deviation,
    passed_on,
    rise_variance,
    shape_inflation,
    size_deviation,
)
from thetascope.diagnosis.yield_points import Steps

GONE = 0.2  # of its size: a fault whose estimate falls below this is over
CERTAIN = 2.0  # standard deviations of that size: what it exceeds zero by more than this is certain
LEAST = 4  # decisions that isolation takes at least: over one, a single outlier resembles any fault
SOON = 20  # decisions after a fault was isolated during which it is not taken to have changed
BEFORE = (
    200  # decisions before an onset, at least, that are kept: its first estimate may be late, and its interval long
)
RECENT = 100  # decisions: an output that fails again within this time was faulty throughout


def commit_fit(state: DecisionState, evidence: Evidence, fit: Explanation) -> Steps[DecisionState]:
    """Return the state with the tentative events, sized by a fit of them, taken as known.

    Findings get their sizes; those whose fault has vanished are cleared. The filter has to be restarted.
    """
    assert state.tentative is not None
    tentative = _merge_ramp(state.tentative, fit)
    fitted = {e.shape_key: e for e in fit.events}
    entries = tuple(replace(entry, event=fitted.get(entry.event.shape_key, entry.event)) for entry in tentative.entries)
    tentative = replace(tentative, entries=entries)
    known = tentative.base.plus(tentative.events, state.at).within_bounds(evidence.thresholds.bounds)
    memory = float(state.at - fit.onset) / (4 if any(e.is_drift for e in fit.events) else 1)
    before = {i: state.findings[i] for i in state.active}
    state = replace(state, known=known, tentative=tentative, memory=memory, start=state.at)
    yield
    window = ReplayWindow.of(
        evidence, tentative.base, tentative.events, tentative.begin, state.at, state.trusted_outputs
    )
    state = replace(state, restart=FilterRestart(window.replay.states[1:]))
    for i in state.active:  # a revised event may have been a change of an older fault
        channel = state.findings[i].channel
        if channel is not None:
            state = with_finding(state, i, replace(state.findings[i], size=float(known.level[channel])))
    over, refined = [], {}
    for k, event in enumerate(fit.events):
        i = next((entry.finding for entry in entries if entry.event == event), None)
        if i is None:  # merged into another event, which will be estimated again
            continue
        deviation, skew = (yield from _deviation(state, evidence, window, fit, k, i, before)), 0.0
        # whether it is over does not depend on when it began
        vanished_size = _size_if_vanished(
            state, event, i, deviation, before.get(i, state.findings[i]), state.at - fit.onset
        )
        if vanished_size is not None:
            over.append(i)
            state = with_finding(
                state, i, with_settled_size(replace(before.get(i, state.findings[i]), size=vanished_size))
            )
        else:
            if not event.rise_time:
                own = next(entry.own for entry in entries if entry.event == event)
                state, refined[event], deviation, skew = yield from _with_onset_interval(
                    state, evidence, fit, k, i, own, before, deviation
                )
            size = float(known.level[event.channel]) + refined.get(event, event).size - event.size
            initial = state.findings[i].initial or (size, deviation)
            finding = replace(state.findings[i], size=size, deviation=deviation, skew=skew, initial=initial)
            state = with_finding(state, i, finding)
    if any(step != event for event, step in refined.items()):
        state = yield from _with_refined_steps(state, evidence, tentative, refined)
    return clear_findings(state, over) if over else _remember_settled(state, entries)


def _with_refined_steps(
    state: DecisionState, evidence: Evidence, tentative: TentativeEvents, refined: dict[Event, Event]
) -> Steps[DecisionState]:
    """Return the state with steps taken as known with onsets between decisions and the sizes that belong to them.

    Otherwise the filter would go on with the size of an onset that is off by less than a decision, and that error
    would be found later as a change of the fault.
    """
    steps = tuple(refined.get(event, event) for event in tentative.events)
    known = tentative.base.plus(steps, state.at).within_bounds(evidence.thresholds.bounds)
    yield
    window = ReplayWindow.of(evidence, tentative.base, steps, tentative.begin, state.at, state.trusted_outputs)
    return replace(state, known=known, restart=FilterRestart(window.replay.states[1:]))


def _size_if_vanished(
    state: DecisionState, event: Event, i: int, deviation: float, before: Finding, length: int
) -> float | None:
    """Return the size that a fault had before an event that ended it; None if the fault is still on."""
    assert state.tentative is not None
    known, entries = state.known, state.tentative.entries
    others = tuple(e for e in state.tentative.events if e != event)
    size = float(known.level[event.channel])
    previous = float(state.tentative.base.plus(others, event.onset).level[event.channel])
    # a first estimate may be many times too large, with an interval that says so
    certain = max(abs(previous or before.size) - CERTAIN * before.deviation, 0.0)
    least = max(GONE * certain, 3.0 * deviation)
    # a fault that was isolated a moment ago is not over yet, unless another event changed it
    settled = state.at - state.findings[i].raised_at >= SOON or any(
        entry.finding == i and not entry.own for entry in entries
    )
    to_come = max(abs(known.slope[event.channel]) * max(length, LEAST), abs(size + known.asymptote[event.channel]))
    return previous or before.size if settled and abs(size) < least and to_come < least else None


def with_settled_size(finding: Finding) -> Finding:
    """Return a finding with the size that it had at the last time without a recent change, if there was one."""
    if finding.settled is None:
        return finding
    return replace(finding, size=finding.settled[0], deviation=finding.settled[1], skew=finding.settled[2])


def _remember_settled(state: DecisionState, entries: tuple[TentativeEvent, ...]) -> DecisionState:
    """Return the state with the present sizes stored as settled, for faults without a recent change."""
    if state.at - max(entry.event.onset for entry in entries) < SOON:
        return state
    # an event in a fault that was known before may turn out to be its end
    changing = {entry.finding for entry in entries if not entry.own and state.at - entry.event.onset < RECENT}
    for i in set(state.active) - changing:
        finding = state.findings[i]
        state = with_finding(state, i, replace(finding, settled=(finding.size, finding.deviation, finding.skew)))
    return state


# ---- standard deviations ---------------------------------------------------------------------------------------------


def _deviation(
    state: DecisionState,
    evidence: Evidence,
    window: ReplayWindow,
    fit: Explanation,
    k: int,
    i: int,
    before: dict[int, Finding],
) -> Steps[float]:
    """Return the standard deviation of the present size of event `k` of a fit, which belongs to finding `i`."""
    assert state.tentative is not None
    event, base = fit.events[k], state.tentative.base
    deviation, v = size_deviation(evidence, state.at, fit, k, list(before.values()))
    if 0 < event.rise_time < np.inf:
        without = yield from _window_before(state, evidence, fit)
        variance = yield from rise_variance(without, fit.events, k)
        if variance:
            deviation = float((variance + passed_on(fit, k, list(before.values()), variance)) ** 0.5)
        else:
            inflated = deviation * shape_inflation(window, event, deviation, v)
            deviation = max(state.findings[i].deviation, inflated)
    return float(np.hypot(deviation, base_deviation(base, event, before.get(i, state.findings[i]))))


def _window_before(state: DecisionState, evidence: Evidence, fit: Explanation) -> Steps[ReplayWindow]:
    """Return the window of the tentative events in which those of a fit are not known."""
    assert state.tentative is not None
    tentative = state.tentative
    others = tuple(e for e in tentative.events if e not in fit.events)
    yield
    return ReplayWindow.of(evidence, tentative.base, others, tentative.begin, state.at, state.trusted_outputs)


def _with_onset_interval(
    state: DecisionState,
    evidence: Evidence,
    fit: Explanation,
    k: int,
    i: int,
    own: bool,
    before: dict[int, Finding],
    deviation: float,
) -> Steps[tuple[DecisionState, Event, float, float]]:
    """Return the state with the interval of the onset of finding `i`, and step `k` with its best onset and size, and
    the deviation and skew of that size.

    Args:
        state, evidence, fit, k, i, before: as in `_deviation`.
        own: whether the finding was raised for this event.
        deviation: that of the size for a known onset, which is returned if the onset's uncertainty is not known.
    """
    assert state.tentative is not None
    finding, event = state.findings[i], fit.events[k]
    window = yield from _window_before(state, evidence, fit)
    width = finding.onset_to - finding.onset_from if own else 1.0
    uncertain = yield from step_uncertainty(window, fit.events, k, width)
    if uncertain is None:
        return state, event, deviation, 0.0
    if own:
        finding = replace(finding, onset=uncertain.onset, onset_from=uncertain.earliest, onset_to=uncertain.latest)
    variance = uncertain.deviation**2
    variance += passed_on(fit, k, list(before.values()), variance)
    base = base_deviation(state.tentative.base, event, before.get(i, finding))
    return with_finding(state, i, finding), uncertain.step, float(np.hypot(variance**0.5, base)), uncertain.skew


def _merge_ramp(tentative: TentativeEvents, fit: Explanation) -> TentativeEvents:
    """Return the events with a drift and a later drift that cancels its slope replaced by one ramp."""
    last = tentative.entries[-1]
    fitted = {e.shape_key: (e, fit.covariance[k, k]) for k, e in enumerate(fit.events)}
    second, variance = fitted.get(last.event.shape_key, (last.event, 0.0))
    for k, entry in enumerate(tentative.entries[:-1]):
        first = entry.event
        drifts = first.is_drift and second.is_drift and first.channel == second.channel
        if not drifts or second.onset <= first.onset:
            continue
        if abs(first.size + second.size) < max(3.0 * variance**0.5, GONE * abs(first.size)):
            rise_time = float(second.onset - first.onset)
            ramp = Event(first.channel, first.onset, rise_time, first.size * rise_time)
            merged = replace(entry, event=ramp, options=(ramp,))
            return replace(tentative, entries=(*tentative.entries[:k], merged, *tentative.entries[k + 1 : -1]))
    return tentative


# ---- findings --------------------------------------------------------------------------------------------------------


def clear_findings(state: DecisionState, which: list[int]) -> DecisionState:
    """Return the state with findings cleared and their channels no longer known. The filter has to be restarted."""
    channels = [c for i in which if (c := state.findings[i].channel) is not None]
    known = state.known.plus((), state.at).without(channels)
    for i in which:
        state = with_finding(state, i, replace(state.findings[i], cleared=state.at))
    active = tuple(k for k in state.active if k not in which)
    return replace(
        state,
        known=known,
        active=active,
        memory=state.memory if any(state.findings[k].channel is not None for k in active) else np.inf,
        restart=FilterRestart() if state.restart is None else state.restart,
        start=state.at,
        tentative=None,
    )


def with_finding(state: DecisionState, i: int, finding: Finding) -> DecisionState:
    """Return the state with finding `i` replaced."""
    return replace(state, findings=(*state.findings[:i], finding, *state.findings[i + 1 :]))


def _with_new_finding(state: DecisionState, finding: Finding) -> DecisionState:
    """Return the state with one more finding, which is on."""
    return replace(state, findings=(*state.findings, finding), active=(*state.active, len(state.findings)))


def assign_finding(
    state: DecisionState,
    window: ReplayWindow,
    statistic: float,
    event: Event,
    options: tuple[Event, ...],
    own: int | None,
) -> Steps[tuple[DecisionState, int, bool]]:
    """Return (state, index, own) of the finding that an event belongs to.

    It is the one that is on in its channel; otherwise `own`, renamed, if the event replaces one that had raised it;
    otherwise a new one. The returned `own` says whether the finding was raised for this event.
    """
    others = tuple(dict.fromkeys(o.channel for o in options if o.channel != event.channel))
    held = [i for i in state.active if state.findings[i].channel == event.channel and i != own]
    if held:
        return (state if own is None else clear_findings(state, [own])), held[0], False
    yield
    onset_from, onset_to = onset_interval(window, event)
    if own is None:
        finding = Finding(state.at, event.channel, others, event.onset, onset_from, onset_to, 0.0, 0.0, statistic)
        return _with_new_finding(state, finding), len(state.findings), True
    finding = state.findings[own]
    if finding.channel != event.channel:  # its sizes were those of another fault
        finding = replace(finding, size=0.0, settled=None, initial=None)
    finding = replace(
        finding,
        channel=event.channel,
        alternatives=others,
        onset=event.onset,
        onset_from=onset_from,
        onset_to=onset_to,
    )
    return with_finding(state, own, finding), own, True


def withdraw(state: DecisionState, entry: TentativeEvent) -> DecisionState:
    """Return the state without the finding that a rejected event had raised."""
    return clear_findings(state, [entry.finding]) if entry.own and entry.finding in state.active else state


def exclude_output(
    state: DecisionState, evidence: Evidence, output: int, onset: int, statistic: float
) -> Steps[DecisionState]:
    """Return the state in which the filter ignores an output from an onset on, with a finding for it.

    Events since then, or isolated just before, are withdrawn: the faulty output caused them.
    """
    state = drop_stale(state, evidence)
    onset = max(onset, earliest_replay(state, evidence), evidence.thresholds.begin)
    tentative, known = state.tentative, state.known
    mistaken = () if tentative is None else _caused_since(state, tentative, onset)
    own = [entry.finding for entry in mistaken if entry.own and entry.finding in state.active]
    if tentative is not None and mistaken:
        onset = max(min(onset, *(entry.event.onset_decision for entry in mistaken)), tentative.begin)
        rest = tuple(entry.event for entry in tentative.entries if entry not in mistaken)
        known = tentative.base.plus(rest, onset)
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[output] = 0.0
    yield
    segment = evidence.segment(onset, state.at, known.course)
    states = segment.replay(evidence.filter_state(onset), onset, trusted_outputs, False).states
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
    finding = Finding(state.at, None, (), onset, onset, onset, np.nan, np.nan, statistic, output)
    if own:
        return with_finding(state, own[0], replace(finding, raised_at=state.findings[own[0]].raised_at))
    recent = [
        i
        for i, f in enumerate(state.findings)
        if f.output == output and f.cleared is not None and state.at - f.cleared < RECENT
    ]
    if recent:
        reopened = with_finding(state, recent[-1], replace(state.findings[recent[-1]], cleared=None))
        return replace(reopened, active=(*state.active, recent[-1]))
    return _with_new_finding(state, finding)


def _caused_since(state: DecisionState, tentative: TentativeEvents, onset: int) -> tuple[TentativeEvent, ...]:
    """Return the events that began after an onset, or whose fault was isolated just now."""
    return tuple(
        entry
        for entry in tentative.entries
        if entry.event.onset_decision >= onset - LEAST
        or (entry.own and state.at - state.findings[entry.finding].raised_at < SOON)
    )


# ---- memory ----------------------------------------------------------------------------------------------------------


def earliest_replay(state: DecisionState, evidence: Evidence) -> int:
    """Return the earliest decision from which the filter may be run again; it does not depend on how rows arrived."""
    return max(evidence.oldest, state.at - LONGEST)


def drop_stale(state: DecisionState, evidence: Evidence) -> DecisionState:
    """Return the state with tentative events left as they are if data from their beginning are no longer available."""
    tentative, begin = state.tentative, max(evidence.oldest, state.at - LONGEST - BEFORE)
    if tentative is None or tentative.begin >= begin:
        return state
    if all(entry.event.onset_decision > begin for entry in tentative.entries):
        base = tentative.base.plus((), begin)
        return replace(state, tentative=replace(tentative, begin=begin, base=base))
    over = tuple(entry for entry in tentative.entries if entry.event.is_over(begin))
    entries = tuple(entry for entry in tentative.entries if entry not in over)
    base = tentative.base.plus(tuple(entry.event for entry in over), begin)
    return replace(state, tentative=TentativeEvents(begin, base, entries, NEVER, settled=True))
