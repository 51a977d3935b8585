"""Second thoughts about what is not explained: it may be the belief in other faults that is wrong.

While an output is not heeded its readings are compared with what the filter makes of the others and of the faults it knows. If one of these
ended meanwhile, or was never there, the two never agree again. So now and then the last stretch is looked at with all outputs heeded,
with the known faults and without some: where one of these leaves noise alone it is believed.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np

from backend.diagnosis.knowledge import cleared, oldest, with_found
from backend.diagnosis.standing import Change, Found, Look, Standing
from backend.diagnosis.stretch import Replay

FIRST = 64  # decisions after which an output gets another chance; then twice as long each time
_QUIET = 3.0  # standard deviations of the noise's energy that are left at most
_MOST = 3  # faults of which every combination is tried


def due(now: Standing, decision: int) -> int | None:
    """The next decision from ``decision`` on at which something unexplained is looked at once more; None: nothing is unexplained."""
    times = [now.found[i].at + FIRST * 2 ** max(0, int(np.ceil(np.log2(max(decision - now.found[i].at, 1) / FIRST)))) for i in _unexplained(now)]
    return min(times, default=None)


def _unexplained(now: Standing) -> list[int]:
    return [i for i in now.active if now.found[i].channel is None]


def reconsidered(now: Standing, look: Look) -> Standing:
    """With outputs heeded again for which that is due and what they show can be explained."""
    for i in _unexplained(now):
        if due(now, now.at) == now.at and not look.sums.still[now.at - look.sums.first, now.found[i].output] > look.filter.patience[now.found[i].output]:
            now = _tried(now, look, i)
    return now


def _tried(now: Standing, look: Look, i: int) -> Standing:
    begin = max(oldest(now, look), now.at - max(FIRST, (now.at - now.found[i].at) // 2), look.calibrated.begin)
    heed = now.heed.copy()
    heed[now.found[i].output] = 1.0
    faults = [k for k in now.active if now.found[k].channel is not None]
    sets = [()] + ([c for n in range(1, len(faults) + 1) for c in combinations(faults, n)] if len(faults) <= _MOST else [*((k,) for k in faults), tuple(faults)])
    tried = [(_replayed(now, look, over, begin, heed), over) for over in sets]
    left = [_left(look, replay, begin, now.at, heed) for replay, _ in tried]
    best = next((k for k in np.argsort([len(over) for over in sets], kind="stable") if left[k] < _QUIET), None)
    if best is None:
        return now
    replay, over = tried[best]
    for k in over:
        size, deviation = now.found[k].stood or (now.found[k].size, now.found[k].deviation)
        now = with_found(now, k, replace(now.found[k], size=size, deviation=deviation))
    now = cleared(now, [i, *over])
    return replace(now, heed=heed, change=Change(replay.states[1:]), detected=None, start=now.at)


def _replayed(now: Standing, look: Look, over: tuple[int, ...], begin: int, heed: np.ndarray) -> Replay:
    """The filter along the last stretch as if some faults were over."""
    found: list[Found] = [now.found[k] for k in over]
    known = now.known.plus((), now.at).without([f.channel for f in found]) if found else now.known
    return look.stretch(begin, now.at, known.course).replay(look.state(begin), begin, heed, False)


def _left(look: Look, replay: Replay, begin: int, at: int, heed: np.ndarray) -> float:
    """Energy in the second half of the stretch, in standard deviations of the noise's."""
    half, noise = (at - begin) // 2, look.calibrated.noise
    k = int(noise.nearest(half))
    share = float(heed.mean()) * half / noise.lengths[k]
    energy = float(replay.energy[-1] - replay.energy[-1 - half])
    return (energy - float(noise.energy[k]) * share) / (float(noise.scatter[k]) * share**0.5)
