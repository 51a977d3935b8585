"""Detect, isolate and revise, decision by decision.

1. *Detection*: the largest GLR over windows and channels, and the largest residual, are compared with their thresholds.
2. *Isolation* (isolate.py): a test is above its threshold. Hypotheses are ranked by likelihood; a finding is raised
   when one leads clearly, or after a while with the best one.
3. Afterwards the fault is taken as known, and detection continues for changes from there: another fault, or the end of
   this one. The latest events are revised as data come in (revise.py). An output that is faulty is ignored by the
   filter until it agrees again with its prediction from the others; from time to time it is tried again
   (revise_beliefs.py).

Functions that return `Steps` are generators: they yield before each longer computation.
"""

import math
from dataclasses import replace

import numpy as np

from thetascope.diagnosis.detection.window_tests import ThetaBounds, scan
from thetascope.diagnosis.isolation.decision_state import DecisionState, Evidence, FilterRestart
from thetascope.diagnosis.isolation.isolate import isolate_fault
from thetascope.diagnosis.isolation.known_faults import clear_findings, exclude_output
from thetascope.diagnosis.isolation.revise import revise_tentative
from thetascope.diagnosis.isolation.revise_beliefs import next_readmission, readmit_outputs
from thetascope.diagnosis.yield_points import Steps

LEAST_QUIET = (
    20  # decisions: an output has to agree for an eighth of the time it was faulty, but at least for this long,
)
MOST_QUIET = 100  # and at most for this long; outliers come one at a time
QUIET_ENERGY = 2.0  # standard deviations of the noise's energy: a residual below the mean plus this is noise


def advance_decisions(state: DecisionState, evidence: Evidence) -> Steps[DecisionState]:
    """Return the state after all decisions that `evidence.sums` covers, or after the first one that requires a filter
    restart."""
    while state.at < evidence.sums.last and state.restart is None:
        if state.detected is None:
            state = yield from _next_alarm(state, evidence)
        else:
            state = yield from isolate_fault(state, evidence)
        if state.restart is None and (stuck := _stuck_output(state, evidence)) is not None:
            repeated = float(evidence.sums.repeats[state.at - evidence.sums.first, stuck])
            # the first of the equal values repeats none, and is wrong already
            since = state.at - math.ceil((repeated + 1) / evidence.rows_per_decision)
            state = yield from exclude_output(state, evidence, stuck, since, repeated)
    return state


def _stuck_output(state: DecisionState, evidence: Evidence) -> int | None:
    """Return a trusted output that has repeated one value for longer than noise allows, or None."""
    repeats = evidence.sums.repeats[state.at - evidence.sums.first]
    stuck = np.flatnonzero((repeats > evidence.filter.stuck_after) * state.trusted_outputs)
    return int(stuck[0]) if len(stuck) else None


def _next_alarm(state: DecisionState, evidence: Evidence) -> Steps[DecisionState]:
    """Return the state at the first decision at which a test exceeds its threshold or something else is due.

    Due may be a review of tentative events, the end of an unexplained finding, or another trial of an ignored output.
    """
    thresholds, last = evidence.thresholds, evidence.sums.last
    if state.tentative is not None:
        last = min(last, max(state.tentative.review_at, state.at + 1))
    repeats = evidence.sums.repeats[state.at + 1 - evidence.sums.first : last + 1 - evidence.sums.first]
    stuck = (repeats > evidence.filter.stuck_after) @ state.trusted_outputs > 0
    last = state.at + 1 + int(stuck.argmax()) if stuck.any() else last
    quiet = _first_quiet_decision(state, evidence, last)
    last = last if quiet is None else quiet[0]
    readmission = next_readmission(state, state.at + 1)
    last = last if readmission is None else min(last, readmission)
    ends = np.arange(state.at + 1, last + 1)
    bounds = thresholds.bounds.relative_to(state.known.level)
    glr, residual = scan(evidence.sums, ends, max(state.start, state.passed), state.memory, thresholds.noise, bounds)
    exceeded = np.flatnonzero((glr > thresholds.glr) | (residual > thresholds.residual))
    if len(exceeded) and not _is_blocked(state):
        at = int(ends[exceeded[0]])
        return replace(state, at=at - 1, detected=at, next_attempt=at)
    state = _with_current_sizes(replace(state, at=last), thresholds.bounds)
    if quiet is not None and quiet[0] == last:
        return _restore_output(state, quiet[1])
    if readmission == last:
        state = yield from readmit_outputs(state, evidence)
    if state.restart is None and state.tentative is not None and last >= state.tentative.review_at:
        return (yield from revise_tentative(state, evidence))
    return state


def _with_current_sizes(state: DecisionState, bounds: ThetaBounds) -> DecisionState:
    """Return the state with the present sizes of faults that are still growing."""
    if not (state.known.slope.any() or state.known.asymptote.any()):
        return state
    size, findings = np.clip(state.known.at(state.at), bounds.low, bounds.high), list(state.findings)
    for i in state.active:
        finding = findings[i]
        if finding.channel is not None:
            present = float(size[finding.channel])
            # the deviation grows with the size: the slope is as certain as before
            growth = max(1.0, abs(present / finding.size)) if finding.size else 1.0
            findings[i] = replace(finding, size=present, deviation=finding.deviation * growth, skew=0.0)
    return replace(state, findings=tuple(findings))


def _unexplained(state: DecisionState) -> list[int]:
    """Return the indices of active findings that no channel explains."""
    return [i for i in state.active if state.findings[i].channel is None]


def _is_blocked(state: DecisionState) -> bool:
    """Return whether a finding is on that neither a channel nor one output explains: until it is over, no other is
    raised."""
    return bool(_unexplained(state)) and bool(state.trusted_outputs.all())


def _first_quiet_decision(state: DecisionState, evidence: Evidence, last: int) -> tuple[int, int] | None:
    """Return (decision, finding) of the first unexplained finding that has been over for long enough by `last`, or
    None."""
    noise, settle, first = evidence.thresholds.noise, evidence.thresholds.settle, evidence.sums.first
    sums, m, best = evidence.sums, len(state.trusted_outputs), None
    ends = np.arange(state.at + 1, last + 1)
    for i in _unexplained(state):
        finding = state.findings[i]
        k = noise.nearest(np.clip((ends - finding.raised_at) // 8, max(LEAST_QUIET, settle), max(MOST_QUIET, settle)))
        begins = ends - noise.lengths[k]
        a, b = np.maximum(begins, first) - first, ends - first
        if state.trusted_outputs.all():
            quiet = sums.e[b] - sums.e[a] < noise.energy[k] + QUIET_ENERGY * noise.energy_std[k]
        else:
            q = sums.q[b, finding.output] - sums.q[a, finding.output]
            quiet = q < noise.energy[k] / m + QUIET_ENERGY * noise.energy_std[k] / m**0.5
            stuck = sums.repeats[:, finding.output] > evidence.filter.stuck_after[finding.output]
            quiet &= np.maximum.accumulate(np.where(stuck, np.arange(len(stuck)), -1))[b] <= a
        quiet &= begins >= max(first, finding.raised_at)
        if quiet.any() and (best is None or ends[quiet.argmax()] < best[0]):
            best = int(ends[quiet.argmax()]), i
    return best


def _restore_output(state: DecisionState, i: int) -> DecisionState:
    """Return the state with unexplained finding `i` cleared and its output trusted again."""
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[state.findings[i].output] = 1.0
    state = clear_findings(state, [i])
    return replace(state, trusted_outputs=trusted_outputs, restart=FilterRestart(), start=state.at)
