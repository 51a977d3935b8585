"""Second thoughts about what is not explained: it may be the belief in other faults that is wrong.

While an output is not heeded its readings are compared with what the filter makes of the others and of the faults it knows. If one of these
ended meanwhile, or was never there, the two never agree again. So now and then the last stretch is looked at with all outputs heeded,
with the known faults and without some: where one of these leaves noise alone it is believed.
"""

from dataclasses import replace
from itertools import combinations

from thetascope.diagnosis.isolation.decision_state import Change, Found, Look, Standing
from thetascope.diagnosis.isolation.known_faults import as_it_stood, cleared, oldest, with_found
from thetascope.diagnosis.residuals.segment import Replay

FIRST = 64  # decisions after which an output gets another chance; then twice as long each time
_QUIET = 3.0  # standard deviations of the noise's energy that are left at most
_MOST = 3  # faults of which every combination is tried


def due(now: Standing, decision: int) -> int | None:
    """The next decision from ``decision`` on at which something unexplained is looked at once more; None: nothing is unexplained."""
    return min((_next(now.found[i], decision) for i in _unexplained(now)), default=None)


def _next(found: Found, decision: int) -> int:
    """The first of its times from a decision on."""
    after = FIRST
    while found.at + after < decision:
        after *= 2
    return found.at + after


def _unexplained(now: Standing) -> list[int]:
    return [i for i in now.active if now.found[i].channel is None]


def reconsidered(now: Standing, look: Look) -> Standing:
    """With outputs heeded again for which that is due and what they show can be explained; one that stands still cannot."""
    still = look.sums.still[now.at - look.sums.first] > look.filter.patience
    for i in _unexplained(now):
        if i in now.active and _next(now.found[i], now.at) == now.at and not still[now.found[i].output]:
            now = _tried(now, look, i)
    return now


def _tried(now: Standing, look: Look, i: int) -> Standing:
    begin = max(oldest(now, look), now.at - max(FIRST, (now.at - now.found[i].at) // 2), look.calibrated.begin)
    heed = now.heed.copy()
    heed[now.found[i].output] = 1.0
    faults = [k for k in now.active if now.found[k].channel is not None]
    counts = range(len(faults) + 1) if len(faults) <= _MOST else sorted({0, 1, len(faults)})
    for over in (some for count in counts for some in combinations(faults, count)):  # as few as will do
        known = now.known.without([now.found[k].channel for k in over])
        replay = look.stretch(begin, now.at, known.course).replay(look.state(begin), begin, heed, False)
        if _left(look, replay, now.at - begin) < _QUIET:
            for k in over:
                now = with_found(now, k, as_it_stood(now.found[k]))
            return replace(cleared(now, [i, *over]), heed=heed, change=Change(replay.states[1:]), detected=None)
    return now


def _left(look: Look, replay: Replay, length: int) -> float:
    """Energy in the second half of a stretch of so many decisions, in standard deviations of the noise's."""
    mean, deviation = look.calibrated.noise.expected(length // 2, replay.heed)
    return (float(replay.energy[-1] - replay.energy[-1 - length // 2]) - mean) / deviation
