"""From evidence to findings, decision by decision: is something there, what is it, since when, how large?

1. *Watching*: the largest GLR over windows and channels, and the largest residual, are held against their thresholds.
2. *Naming* (isolate.py): one is above. What explains the data best, and what else does as well? A finding is given when one
   explanation leads clearly, or after a while as it then stands.
3. Afterwards what was found is taken as known, and watching goes on for what changes from there: another fault, or the
   end of this one. What was found last is looked at again as data come in (revise.py): its size, and what else it might
   have been. An output that cannot be trusted is not followed until it agrees again with what the filter makes of the
   others; now and then it gets another chance (revise_beliefs.py).
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

LEAST_QUIET = 20  # decisions at least that an output must agree again, since outliers come one at a time: an eighth of what it was off
MOST_QUIET = 100
QUIET_ENERGY = 2.0  # standard deviations of the residual's energy: as loud as noise is


def advance_decisions(state: DecisionState, evidence: Evidence) -> DecisionState:
    """Go through the decisions that the sums reach, or up to one after which the filter must be told a change."""
    while state.at < evidence.sums.last and state.restart is None:
        state = _next_alarm(state, evidence) if state.detected is None else isolate_fault(state, evidence)
        if state.restart is None and (stuck := _stuck(state, evidence)) is not None:
            repeated = evidence.sums.repeats[state.at - evidence.sums.first, stuck]
            since = state.at - math.ceil(
                (repeated + 1) / evidence.rows_per_decision
            )  # the first of them repeats none, and is wrong, too
            state = exclude_output(
                state, evidence, stuck, since, float(evidence.sums.repeats[state.at - evidence.sums.first, stuck])
            )
    return state


def _stuck(state: DecisionState, evidence: Evidence) -> int | None:
    """An output that is heeded though it shows the same number all the time: noise does not."""
    stuck = np.flatnonzero(
        (evidence.sums.repeats[state.at - evidence.sums.first] > evidence.filter.stuck_after) * state.trusted_outputs
    )
    return int(stuck[0]) if len(stuck) else None


def _next_alarm(state: DecisionState, evidence: Evidence) -> DecisionState:
    """Up to the first decision at which a test is above its threshold, or what was found last is due to be looked at again."""
    cal, last = evidence.thresholds, evidence.sums.last
    if state.tentative is not None:
        last = min(last, max(state.tentative.review_at, state.at + 1))
    stuck = (
        evidence.sums.repeats[state.at + 1 - evidence.sums.first : last + 1 - evidence.sums.first]
        > evidence.filter.stuck_after
    ) @ state.trusted_outputs > 0
    last = state.at + 1 + int(stuck.argmax()) if stuck.any() else last
    quiet_at = _first_quiet_decision(state, evidence, last)
    last = last if quiet_at is None else quiet_at[0]
    again = next_readmission(state, state.at + 1)
    last = last if again is None else min(last, again)
    ends = np.arange(state.at + 1, last + 1)
    bounds = cal.bounds.relative_to(state.known.level)
    glr, residual = scan(evidence.sums, ends, max(state.start, state.passed), state.memory, cal.noise, bounds)
    over = np.flatnonzero((glr > cal.glr) | (residual > cal.residual))
    if len(over) and not _blocked(state):
        at = int(ends[over[0]])
        return replace(state, at=at - 1, detected=at, next_attempt=at)
    state = _with_current_sizes(replace(state, at=last), cal.bounds)
    if quiet_at is not None and quiet_at[0] == last:
        return _restore_output(state, quiet_at[1])
    if again == last:
        state = readmit_outputs(state, evidence)
    return (
        revise_tentative(state, evidence)
        if state.restart is None and state.tentative is not None and last >= state.tentative.review_at
        else state
    )


def _with_current_sizes(state: DecisionState, bounds: ThetaBounds) -> DecisionState:
    """With the sizes that faults which are known to grow have reached by now."""
    if not (state.known.slope.any() or state.known.asymptote.any()):
        return state
    size, found = np.clip(state.known.at(state.at), bounds.low, bounds.high), list(state.findings)
    for i in state.active:
        if found[i].channel is not None:
            new = float(size[found[i].channel])
            grown = max(1.0, abs(new / found[i].size)) if found[i].size else 1.0  # as sure of its pace as it was
            found[i] = replace(found[i], size=new, deviation=found[i].deviation * grown)
    return replace(state, findings=tuple(found))


def _unexplained(state: DecisionState) -> list[int]:
    return [i for i in state.active if state.findings[i].channel is None]


def _blocked(state: DecisionState) -> bool:
    """Whether something is on that neither a fault of the model nor one output explains: until it is over nothing else is."""
    return bool(_unexplained(state)) and bool(state.trusted_outputs.all())


def _first_quiet_decision(state: DecisionState, evidence: Evidence, last: int) -> tuple[int, int] | None:
    """The first decision (up to ``last``) at which something unexplained has been over for a while, and which."""
    noise, settle, best, first = evidence.thresholds.noise, evidence.thresholds.settle, None, evidence.sums.first
    ends = np.arange(state.at + 1, last + 1)
    for i in _unexplained(state):
        found, m = state.findings[i], len(state.trusted_outputs)
        k = noise.nearest(np.clip((ends - found.raised_at) // 8, max(LEAST_QUIET, settle), max(MOST_QUIET, settle)))
        begins = ends - noise.lengths[k]
        a, b = np.maximum(begins, first) - first, ends - first
        if state.trusted_outputs.all():
            quiet = evidence.sums.e[b] - evidence.sums.e[a] < noise.energy[k] + QUIET_ENERGY * noise.energy_std[k]
        else:
            q = evidence.sums.q[b, found.output] - evidence.sums.q[a, found.output]
            quiet = q < noise.energy[k] / m + QUIET_ENERGY * noise.energy_std[k] / m**0.5
            stuck = evidence.sums.repeats[:, found.output] > evidence.filter.stuck_after[found.output]
            quiet &= np.maximum.accumulate(np.where(stuck, np.arange(len(stuck)), -1))[b] <= a
        quiet &= begins >= max(first, found.raised_at)
        if quiet.any() and (best is None or ends[quiet.argmax()] < best[0]):
            best = int(ends[quiet.argmax()]), i
    return best


def _restore_output(state: DecisionState, i: int) -> DecisionState:
    """An unexplained finding is over: its output is heeded again."""
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[state.findings[i].output] = 1.0
    return replace(clear_findings(state, [i]), trusted_outputs=trusted_outputs, restart=FilterRestart(), start=state.at)
