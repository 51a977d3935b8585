"""From evidence to findings, decision by decision: is something there, what is it, since when, how large?

1. *Watching*: the largest GLR over windows and channels, and the largest residual, are held against their thresholds.
2. *Naming*: one is above. Which channel explains the data best from which onset, and which others do as well? Here the
   filter is run again from each onset that comes into question, so that the answers to a fault that has just begun are
   the true ones (Willsky & Jones 1976). A finding is given when one channel leads clearly, or after a while as it then
   stands. Where the best channel leaves most of the residual unexplained, no fault of the model is it.
3. Afterwards what was found is taken as known, and watching goes on for what changes from there: another fault, or the
   end of this one. What is known is estimated anew as data come in.
"""

from dataclasses import replace

import numpy as np

from backend.diagnosis.naming import FIRST_ORDER, LEAST, name
from backend.diagnosis.standing import GONE, Change, Look, Standing, cleared, with_found
from backend.diagnosis.windows import LONGEST, scan

QUIET = 2.0  # standard deviations of the residual's energy: as loud as noise is


def decide(now: Standing, look: Look) -> Standing:
    """Go through the decisions that the sums reach, or up to one after which the filter must be told a change."""
    while now.at < look.sums.last and now.change is None:
        now = _watch(now, look) if now.detected is None else name(now, look)
    return now


def _watch(now: Standing, look: Look) -> Standing:
    """Up to the first decision at which a test is above its threshold, or what is known is due to be estimated anew."""
    cal, last = look.calibrated, look.sums.last
    due = bool(_young(now))
    if due:
        last = min(last, max(now.again, now.at + 1))
    ends = np.arange(now.at + 1, last + 1)
    glr, residual = scan(look.sums, ends, now.start, now.memory, cal.noise, cal.within.given(now.known))
    unexplained = [i for i in now.active if now.found[i].channel is None]
    if unexplained:
        calm = _calm(look, ends[ends > now.start])
        return cleared(replace(now, at=calm), unexplained) if calm is not None else replace(now, at=last)
    over = np.flatnonzero((glr > cal.glr) | (residual > cal.residual))
    if len(over):
        at = int(ends[over[0]])
        return replace(now, at=at - 1, detected=at, again=at)
    now = replace(now, at=last)
    return _refined(now, look) if due and last >= now.again else now


def _calm(look: Look, ends: np.ndarray) -> int | None:
    """While something unexplained is on: the first decision at which the residual of a while is that of the noise."""
    noise, settle = look.calibrated.noise, look.calibrated.settle
    k = int(noise.nearest(max(LEAST, settle)))
    length = int(noise.lengths[k])
    ends = ends[ends - length >= look.sums.first]
    if not len(ends):
        return None
    _, _, q = look.sums.over(ends - length, ends)
    calm = np.flatnonzero(q < noise.energy[k] + QUIET * noise.scatter[k])
    return int(ends[calm[0]]) if len(calm) else None


def _young(now: Standing) -> list[int]:
    """Findings still to be estimated more closely. Later they are left alone, lest they take up what comes after."""
    active = [i for i in now.active if now.found[i].channel is not None]
    return [i for i in active if now.again - now.found[i].at < LONGEST // 2]


def _refined(now: Standing, look: Look) -> Standing:
    """What was found lately, estimated together from what it was found with and what came since."""
    held = [(i, now.found[i].channel) for i in _young(now)]
    begin = max(now.start, look.sums.first)
    picked = [c for _, c in held]
    J, s, _ = look.sums.over(begin, now.at)
    information = (J + now.trust)[np.ix_(picked, picked)]
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    covariance = np.linalg.pinv(information / np.outer(scale, scale), rcond=1e-9, hermitian=True) / np.outer(scale, scale)
    step = np.zeros_like(now.known)
    step[picked] = covariance @ s[picked]
    trust = now.trust.copy()
    trust[np.ix_(picked, picked)] = information
    length = now.at - begin
    noise = look.calibrated.noise
    loud = now.loud + noise.v[noise.nearest(length)] * np.diag(J)
    now = replace(now, known=now.known + step, trust=trust, loud=loud, memory=now.memory + length, start=now.at,
                  again=now.at + max(2, 2 * length), change=Change(step, None))  # fmt: skip
    over = []
    for k, (i, c) in enumerate(held):
        deviation = float(np.sqrt(max(covariance[k, k] * loud[c] / max(information[k, k], 1e-300), 0.0)))
        size = float(now.known[c])
        deviation = float(np.hypot(deviation, FIRST_ORDER * size))
        if abs(size) < max(GONE * abs(now.found[i].size), 3.0 * deviation):
            over.append(i)
        now = with_found(now, i, replace(now.found[i], size=size, deviation=deviation))
    return cleared(now, over) if over else now
