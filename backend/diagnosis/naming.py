"""Something was noticed: which channel is it, since when, how large, and which others might it be as well?

The filter is run again from each onset that comes into question, so that the answers to a fault that has just begun are
the true ones (Willsky & Jones 1976). While more data are waited for, a few onsets far apart will do; before an answer is
given those close to the best are looked at, too.
"""

from dataclasses import dataclass, replace

import numpy as np

from backend.diagnosis.standing import Answer, Change, Found, Look, Standing, changed
from backend.diagnosis.windows import explained, sizes

CLEAR = 9.0  # lead in GLR (twice the log of a likelihood) that makes one channel the answer: odds of 90 to 1
AS_WELL = 6.0  # a channel within this explains the data as well: odds below 20 to 1
ROUGHLY = 0.1  # of the GLR: what the first-order answer to a large fault may be wrong by adds to both
SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times, after which an answer is given as it stands,
MOST_PATIENCE = 100  # decisions, if that is less
LEAST = 4  # decisions that an answer takes: a single outlier looks like anything over one
_LEADERS = 3  # channels whose onsets are looked at closely
_CLOSE = 9
FIRST_ORDER = 0.01  # of a size: what linearisation is taken to cost
_APART = 1.7  # how much earlier each onset is than the one after, counted from now


@dataclass(frozen=True)
class _Case:
    """What speaks for each channel: the energy that it explains (onsets × channels), over the onsets in question."""

    onsets: np.ndarray
    answers: list[Answer]
    energy: np.ndarray

    def best(self, channel: int) -> int:
        return int(self.energy[:, channel].argmax())


def _far_apart(now: Standing, look: Look) -> _Case:
    """Onsets ever further back, and the earliest that comes into question."""
    first, back, onsets = max(now.start, look.oldest), 1.0, []
    while now.at - back > first:
        onsets.append(now.at - round(back))
        back = max(back + 1, back * _APART)
    return _over(now, look, np.unique([first, *onsets]))


def _close(now: Standing, look: Look, case: _Case) -> _Case:
    """With onsets close to where the leading channels have theirs."""
    close = []
    for channel in np.argsort(-case.energy.max(axis=0))[:_LEADERS]:
        place = case.best(int(channel))
        low, high = case.onsets[max(place - 1, 0)], case.onsets[min(place + 1, len(case.onsets) - 1)]
        close += np.linspace(low, high, _CLOSE).round().astype(int).tolist()
    fine = _over(now, look, np.setdiff1d(close, case.onsets))
    order = np.argsort(np.concatenate([case.onsets, fine.onsets]), kind="stable")
    answers = [*case.answers, *fine.answers]
    return _Case(np.concatenate([case.onsets, fine.onsets])[order], [answers[i] for i in order],
                 np.concatenate([case.energy, fine.energy])[order])  # fmt: skip


def _over(now: Standing, look: Look, onsets: np.ndarray) -> _Case:
    answers = [look.answer(int(o), now.at) for o in onsets]
    p = len(now.known)
    D, s = (np.array(v).reshape(-1, p) for v in ([np.diag(a.J) for a in answers], [a.s for a in answers]))
    return _Case(onsets, answers, explained(D, s, look.calibrated.within.given(now.known)))


@dataclass(frozen=True)
class _Verdict:
    """What a case comes to: the leading channel and its lead, what it leaves of the residual, whether that is an answer."""

    best: np.ndarray
    leader: int
    length: int
    glr: float
    residual: float
    believable: bool
    answer: bool


def name(now: Standing, look: Look) -> Standing:
    """One decision further with something noticed: name it, give it up, or wait for more."""
    cal, at = look.calibrated, now.at + 1
    now = replace(now, at=at)
    waited = at - now.detected
    if at < now.again:
        return now
    late = waited >= min(PATIENCE * max(cal.settle, LEAST), MOST_PATIENCE)
    case = _far_apart(now, look)
    found = _verdict(now, look, case)
    if found.glr < 0.5 * cal.glr and found.residual < 0.5 * cal.residual and waited > cal.settle:
        return replace(now, detected=None, start=max(now.start, at - cal.settle))  # it went away again
    if found.answer or late:
        case = _close(now, look, case)
        found = _verdict(now, look, case)
    if not found.answer and not late:
        return replace(now, again=at + max(1, waited // 4))
    if found.believable and found.glr > 0.5 * cal.glr:
        return _fault(now, look, case, found)
    return _unexplained(now, look, found)


def _verdict(now: Standing, look: Look, case: _Case) -> _Verdict:
    cal, noise = look.calibrated, look.calibrated.noise
    best = case.energy.max(axis=0)
    leader = int(best.argmax())
    place = case.best(leader)
    length = now.at - int(case.onsets[place])
    k = int(noise.nearest(length))
    best = best / (noise.energy[k] / (noise.lengths[k] * look.rows))  # in units of the noise as it is
    glr = case.energy[place, leader] / noise.v[k, leader] / (1.0 + length / now.memory)
    residual, share = _left(now, look, case, place, leader)
    order = np.sort(best)[::-1]
    sure = len(order) < 2 or order[0] - order[1] > CLEAR + ROUGHLY * order[0]
    believable = share >= SHARE or residual < cal.residual
    formed = length >= LEAST and glr > cal.glr and believable
    return _Verdict(best, leader, length, glr, residual, believable, sure and formed)


def _left(now: Standing, look: Look, case: _Case, place: int, channel: int) -> tuple[float, float]:
    """Residual that a channel leaves, in standard deviations of the noise's; the share of the excess that it explains."""
    noise, answer = look.calibrated.noise, case.answers[place]
    length = now.at - int(case.onsets[place])
    k = int(noise.nearest(length))
    scale = length / noise.lengths[k]
    excess = answer.q - float(noise.energy[k]) * scale
    taken = float(case.energy[place, channel])
    left = (excess - taken) / float(noise.scatter[k] * np.sqrt(scale))
    return left, taken / excess if excess > 0 else 1.0


def _fault(now: Standing, look: Look, case: _Case, verdict: _Verdict) -> Standing:
    """The leading channel is it: its onset, its size. The filter is to be told."""
    leader, best = verdict.leader, verdict.best
    place = case.best(leader)
    near = case.onsets[case.energy[:, leader] >= case.energy[place, leader] - 3.84]
    margin = AS_WELL + ROUGHLY * best[leader]
    alternatives = tuple(int(i) for i in np.argsort(-best) if i != leader and best[leader] - best[i] < margin)
    onset, answer = int(case.onsets[place]), case.answers[place]
    noise, J = look.calibrated.noise, float(answer.J[leader, leader])
    size = float(sizes(np.diag(answer.J), answer.s, look.calibrated.within.given(now.known))[leader])
    variance = float(noise.v[noise.nearest(now.at - onset), leader]) / J
    step = np.zeros_like(now.known)
    step[leader] = size
    trust, loud = now.trust.copy(), now.loud.copy()
    trust[leader, leader], loud[leader] = J, variance * J * J
    length = now.at - onset
    now = replace(now, known=now.known + step, trust=trust, loud=loud, detected=None, start=now.at, memory=float(length),
                  again=now.at + max(2, length), change=Change(step, answer.V))  # fmt: skip
    deviation = float(np.hypot(np.sqrt(variance), FIRST_ORDER * size))
    held = [i for i in now.active if now.found[i].channel == leader]
    if held:
        return changed(now, held[0], size, deviation)
    found = Found(now.at, leader, alternatives, onset, int(near.min()), int(near.max()), size, deviation, verdict.glr)
    return replace(now, found=(*now.found, found), active=(*now.active, len(now.found)))


def _unexplained(now: Standing, look: Look, verdict: _Verdict) -> Standing:
    """No channel explains it."""
    onset = now.at - verdict.length
    output = look.sums.loudest(max(onset, look.sums.first), now.at)
    found = Found(now.at, None, (), onset, onset, onset, np.nan, np.nan, verdict.residual, output)
    return replace(now, detected=None, start=now.at, found=(*now.found, found), active=(*now.active, len(now.found)))
