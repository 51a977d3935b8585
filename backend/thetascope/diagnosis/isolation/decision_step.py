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

from thetascope.diagnosis.detection.window_tests import Range, scan
from thetascope.diagnosis.isolation.decision_state import Change, Look, Standing
from thetascope.diagnosis.isolation.isolate import name
from thetascope.diagnosis.isolation.known_faults import cleared, distrust
from thetascope.diagnosis.isolation.revise import reviewed
from thetascope.diagnosis.isolation.revise_beliefs import due, reconsidered

CALM = 20  # decisions at least that an output must agree again, since outliers come one at a time: an eighth of what it was off
MOST_CALM = 100
QUIET = 2.0  # standard deviations of the residual's energy: as loud as noise is


def decide(now: Standing, look: Look) -> Standing:
    """Go through the decisions that the sums reach, or up to one after which the filter must be told a change."""
    while now.at < look.sums.last and now.change is None:
        now = _watch(now, look) if now.detected is None else name(now, look)
        if now.change is None and (stuck := _stuck(now, look)) is not None:
            repeated = look.sums.still[now.at - look.sums.first, stuck]
            since = now.at - math.ceil((repeated + 1) / look.rows)  # the first of them repeats none, and is wrong, too
            now = distrust(now, look, stuck, since, float(look.sums.still[now.at - look.sums.first, stuck]))
    return now


def _stuck(now: Standing, look: Look) -> int | None:
    """An output that is heeded though it shows the same number all the time: noise does not."""
    stuck = np.flatnonzero((look.sums.still[now.at - look.sums.first] > look.filter.patience) * now.heed)
    return int(stuck[0]) if len(stuck) else None


def _watch(now: Standing, look: Look) -> Standing:
    """Up to the first decision at which a test is above its threshold, or what was found last is due to be looked at again."""
    cal, last = look.calibrated, look.sums.last
    if now.pending is not None:
        last = min(last, max(now.pending.review, now.at + 1))
    stuck = (
        look.sums.still[now.at + 1 - look.sums.first : last + 1 - look.sums.first] > look.filter.patience
    ) @ now.heed > 0
    last = now.at + 1 + int(stuck.argmax()) if stuck.any() else last
    calm = _calm(now, look, last)
    last = last if calm is None else calm[0]
    again = due(now, now.at + 1)
    last = last if again is None else min(last, again)
    ends = np.arange(now.at + 1, last + 1)
    within = cal.within.given(now.known.level)
    glr, residual = scan(look.sums, ends, max(now.start, now.passed), now.memory, cal.noise, within)
    over = np.flatnonzero((glr > cal.glr) | (residual > cal.residual))
    if len(over) and not _paused(now):
        at = int(ends[over[0]])
        return replace(now, at=at - 1, detected=at, again=at)
    now = _grown(replace(now, at=last), cal.within)
    if calm is not None and calm[0] == last:
        return _trusted(now, calm[1])
    if again == last:
        now = reconsidered(now, look)
    return reviewed(now, look) if now.change is None and now.pending is not None and last >= now.pending.review else now


def _grown(now: Standing, within: Range) -> Standing:
    """With the sizes that faults which are known to grow have reached by now."""
    if not (now.known.slope.any() or now.known.rest.any()):
        return now
    size, found = np.clip(now.known.at(now.at), within.low, within.high), list(now.found)
    for i in now.active:
        if found[i].channel is not None:
            new = float(size[found[i].channel])
            grown = max(1.0, abs(new / found[i].size)) if found[i].size else 1.0  # as sure of its pace as it was
            found[i] = replace(found[i], size=new, deviation=found[i].deviation * grown)
    return replace(now, found=tuple(found))


def _unexplained(now: Standing) -> list[int]:
    return [i for i in now.active if now.found[i].channel is None]


def _paused(now: Standing) -> bool:
    """Whether something is on that neither a fault of the model nor one output explains: until it is over nothing else is."""
    return bool(_unexplained(now)) and bool(now.heed.all())


def _calm(now: Standing, look: Look, last: int) -> tuple[int, int] | None:
    """The first decision (up to ``last``) at which something unexplained has been over for a while, and which."""
    noise, settle, best, first = look.calibrated.noise, look.calibrated.settle, None, look.sums.first
    ends = np.arange(now.at + 1, last + 1)
    for i in _unexplained(now):
        found, m = now.found[i], len(now.heed)
        k = noise.nearest(np.clip((ends - found.at) // 8, max(CALM, settle), max(MOST_CALM, settle)))
        begins = ends - noise.lengths[k]
        a, b = np.maximum(begins, first) - first, ends - first
        if now.heed.all():
            quiet = look.sums.e[b] - look.sums.e[a] < noise.energy[k] + QUIET * noise.scatter[k]
        else:
            q = look.sums.q[b, found.output] - look.sums.q[a, found.output]
            quiet = q < noise.energy[k] / m + QUIET * noise.scatter[k] / m**0.5
            stuck = look.sums.still[:, found.output] > look.filter.patience[found.output]
            quiet &= np.maximum.accumulate(np.where(stuck, np.arange(len(stuck)), -1))[b] <= a
        quiet &= begins >= max(first, found.at)
        if quiet.any() and (best is None or ends[quiet.argmax()] < best[0]):
            best = int(ends[quiet.argmax()]), i
    return best


def _trusted(now: Standing, i: int) -> Standing:
    """An unexplained finding is over: its output is heeded again."""
    heed = now.heed.copy()
    heed[now.found[i].output] = 1.0
    return replace(cleared(now, [i]), heed=heed, change=Change(), start=now.at)
