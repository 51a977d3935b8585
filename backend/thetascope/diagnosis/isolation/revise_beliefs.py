"""Second thoughts about what is not explained: it may be the belief in other faults that is wrong.

While an output is not heeded its readings are compared with what the filter makes of the others and of the faults it knows. If one of these
ended meanwhile, or was never there, the two never agree again. So now and then the last stretch is looked at with all outputs heeded,
with the known faults and without some: where one of these leaves noise alone it is believed.
"""

from dataclasses import replace
from itertools import combinations

from thetascope.diagnosis.isolation.decision_state import DecisionState, Evidence, FilterRestart, Finding
from thetascope.diagnosis.isolation.known_faults import clear_findings, earliest_replay, with_finding, with_settled_size
from thetascope.diagnosis.residuals.segment import ReplayResult

FIRST = 64  # decisions after which an output gets another chance; then twice as long each time
_QUIET = 3.0  # standard deviations of the noise's energy that are left at most
_MOST = 3  # faults of which every combination is tried


def next_readmission(state: DecisionState, decision: int) -> int | None:
    """The next decision from ``decision`` on at which something unexplained is looked at once more; None: nothing is unexplained."""
    return min((_next(state.findings[i], decision) for i in _unexplained(state)), default=None)


def _next(found: Finding, decision: int) -> int:
    """The first of its times from a decision on."""
    after = FIRST
    while found.raised_at + after < decision:
        after *= 2
    return found.raised_at + after


def _unexplained(state: DecisionState) -> list[int]:
    return [i for i in state.active if state.findings[i].channel is None]


def readmit_outputs(state: DecisionState, evidence: Evidence) -> DecisionState:
    """With outputs heeded again for which that is due and what they show can be explained; one that stands still cannot."""
    still = evidence.sums.repeats[state.at - evidence.sums.first] > evidence.filter.stuck_after
    for i in _unexplained(state):
        if i in state.active and _next(state.findings[i], state.at) == state.at and not still[state.findings[i].output]:
            state = _tried(state, evidence, i)
    return state


def _tried(state: DecisionState, evidence: Evidence, i: int) -> DecisionState:
    begin = max(
        earliest_replay(state, evidence),
        state.at - max(FIRST, (state.at - state.findings[i].raised_at) // 2),
        evidence.thresholds.begin,
    )
    trusted_outputs = state.trusted_outputs.copy()
    trusted_outputs[state.findings[i].output] = 1.0
    faults = [k for k in state.active if state.findings[k].channel is not None]
    counts = range(len(faults) + 1) if len(faults) <= _MOST else sorted({0, 1, len(faults)})
    for over in (some for count in counts for some in combinations(faults, count)):  # as few as will do
        known = state.known.without([state.findings[k].channel for k in over])
        replay = evidence.segment(begin, state.at, known.course).replay(
            evidence.filter_state(begin), begin, trusted_outputs, False
        )
        if _left(evidence, replay, state.at - begin) < _QUIET:
            for k in over:
                state = with_finding(state, k, with_settled_size(state.findings[k]))
            return replace(
                clear_findings(state, [i, *over]),
                trusted_outputs=trusted_outputs,
                restart=FilterRestart(replay.states[1:]),
                detected=None,
            )
    return state


def _left(evidence: Evidence, replay: ReplayResult, length: int) -> float:
    """Energy in the second half of a stretch of so many decisions, in standard deviations of the noise's."""
    mean, deviation = evidence.thresholds.noise.expected_energy(length // 2, replay.trusted_outputs)
    return (float(replay.energy[-1] - replay.energy[-1 - length // 2]) - mean) / deviation
