"""Readmit ignored outputs: not the output, but the known faults may be wrong.

The readings of an ignored output are compared with their prediction from the other outputs and the known faults. If one
of these faults has ended meanwhile, or never existed, the two never agree again. Therefore the latest data are tested
from time to time with all outputs trusted, with the known faults and without some of them: the first combination that
leaves noise alone is accepted.
"""

from dataclasses import replace
from itertools import combinations

from thetascope.diagnosis.isolation.decision_state import DecisionState, Evidence, FilterRestart, Finding
from thetascope.diagnosis.isolation.known_faults import (
    clear_findings,
    earliest_replay,
    with_finding,
    with_settled_size,
)
from thetascope.diagnosis.residuals.segment import ReplayResult
from thetascope.diagnosis.yield_points import Steps

FIRST = 64  # decisions after which an output is tried for the first time; then twice as long each time
_QUIET = 3.0  # standard deviations of the noise's energy that may be left
_MOST = 3  # number of faults up to which every combination is tried


def next_readmission(state: DecisionState, decision: int) -> int | None:
    """Return the next decision from `decision` on at which an ignored output is tried; None: no output is ignored."""
    return min((_next_trial(state.findings[i], decision) for i in _unexplained(state)), default=None)


def _next_trial(finding: Finding, decision: int) -> int:
    after = FIRST
    while finding.raised_at + after < decision:
        after *= 2
    return finding.raised_at + after


def _unexplained(state: DecisionState) -> list[int]:
    """Return the indices of active findings that no channel explains."""
    return [i for i in state.active if state.findings[i].channel is None]


def readmit_outputs(state: DecisionState, evidence: Evidence) -> Steps[DecisionState]:
    """Return the state with outputs trusted again that are due for a trial and pass it; a stuck output is not tried."""
    stuck = evidence.sums.repeats[state.at - evidence.sums.first] > evidence.filter.stuck_after
    for i in _unexplained(state):
        if i in state.active and _next_trial(state.findings[i], state.at) == state.at:
            output = state.findings[i].output
            if output is None or not stuck[output]:
                state = yield from _try_output(state, evidence, i)
    return state


def _try_output(state: DecisionState, evidence: Evidence, i: int) -> Steps[DecisionState]:
    """Return the state with the output of finding `i` trusted if its readings are explained without some known
    faults."""
    length = max(FIRST, (state.at - state.findings[i].raised_at) // 2)
    begin = max(earliest_replay(state, evidence), state.at - length, evidence.thresholds.begin)
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[state.findings[i].output] = 1.0
    faults = [k for k in state.active if state.findings[k].channel is not None]
    counts = range(len(faults) + 1) if len(faults) <= _MOST else sorted({0, 1, len(faults)})
    for ended in (group for count in counts for group in combinations(faults, count)):  # as few as possible
        channels = [channel for k in ended if (channel := state.findings[k].channel) is not None]
        known = state.known.without(channels)
        yield
        segment = evidence.segment(begin, state.at, known.course)
        replay = segment.replay(evidence.filter_state(begin), begin, trusted_outputs, False)
        if _excess(evidence, replay, state.at - begin) < _QUIET:
            for k in ended:
                state = with_finding(state, k, with_settled_size(state.findings[k]))
            state = clear_findings(state, [i, *ended])
            restart = FilterRestart(replay.states[1:])
            return replace(state, trusted_outputs=trusted_outputs, restart=restart, detected=None)
    return state


def _excess(evidence: Evidence, replay: ReplayResult, length: int) -> float:
    """Return the energy in the second half of a window of `length` decisions above its mean, in standard deviations of
    noise."""
    mean, deviation = evidence.thresholds.noise.expected_energy(length // 2, replay.trusted_outputs)
    return (float(replay.energy[-1] - replay.energy[-1 - length // 2]) - mean) / deviation
