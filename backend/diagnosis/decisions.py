"""From evidence to findings, decision by decision: is something there, what is it, since when, how large?

1. *Watching*: the largest GLR over windows and channels, and the largest residual, are held against their thresholds.
2. *Naming*: one is above. Which channel explains the data best from which onset, and which others do as well? Here the
   filter is run again from each onset that comes into question, so that the answers to a fault that has just begun are
   the true ones (Willsky & Jones 1976). A finding is given when one channel leads clearly, or after a while as it then
   stands. Where the best channel leaves most of the residual unexplained, no fault of the model is it.
3. Afterwards what was found is taken as known, and watching goes on for what changes from there: another fault, or the
   end of this one. What is known is estimated anew as data come in.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.windows import LONGEST, Sums, explained, lengths, scan, sizes

CLEAR = 9.0  # lead in GLR (twice the log of a likelihood) that makes one channel the answer: odds of 90 to 1
AS_WELL = 6.0  # a channel within this explains the data as well: odds below 20 to 1
ROUGHLY = 0.1  # of the GLR: what the first-order answer to a large fault may be wrong by adds to both
FIRST_ORDER = 0.01  # of a size: what linearisation is taken to cost
SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times, after which an answer is given as it stands,
MOST_PATIENCE = 100  # decisions, if that is less
LEAST = 4  # decisions that an answer takes: a single outlier looks like anything over one
QUIET = 2.0  # standard deviations of the residual's energy: as loud as noise is
GONE = 0.2  # of its size: a fault whose estimate falls below is over
_LEADERS = 3  # channels whose onsets are looked at closely
_CLOSE = 9


@dataclass(frozen=True)
class Found:
    """One finding; times are decisions, sizes in the channels' units. ``channel`` None: not explained by the model."""

    at: int
    channel: int | None
    alternatives: tuple[int, ...]
    onset: int
    onset_from: int
    onset_to: int
    size: float
    deviation: float
    statistic: float
    output: int | None = None  # where it is not explained: the output with the largest residual
    cleared: int | None = None


@dataclass(frozen=True)
class Change:
    """θ has changed by ``size`` (p), to which the filter's state now answers with V (n × p)."""

    size: np.ndarray
    V: np.ndarray | None  # None: as it answers a θ that has long been there


@dataclass(frozen=True)
class Standing:
    """Where decisions stand after decision ``at``.

    ``trust``: information (p × p) that ``known`` was found with, were the noise white; ``loud`` (p): the same, each
    window's diagonal times its v, so that loud/trust² is the variance.
    """

    at: int
    start: int  # windows begin here or later
    known: np.ndarray
    trust: np.ndarray
    loud: np.ndarray
    memory: float = np.inf  # decisions that ``known`` was estimated from
    detected: int | None = None  # the decision at which what is being named was noticed
    again: int = 0  # the decision at which naming is tried next, or what is known is estimated anew
    active: tuple[int, ...] = ()  # indices into ``found``
    found: tuple[Found, ...] = field(default=())
    change: Change | None = None  # to be told to the filter before it goes on

    @classmethod
    def beginning(cls, calibrated: Calibrated, channels: int) -> "Standing":
        return cls(calibrated.begin, calibrated.begin, np.zeros(channels), np.zeros((channels, channels)),
                   np.zeros(channels))  # fmt: skip


@dataclass(frozen=True)
class Answer:
    """What a fault from an onset on would look like up to now: sums over the rows since, and V at their end."""

    J: np.ndarray
    s: np.ndarray
    q: float
    V: np.ndarray


@dataclass(frozen=True)
class Look:
    """What decisions are made from. ``answer(onset, at)`` runs the filter again from an onset."""

    sums: Sums
    calibrated: Calibrated
    answer: Callable[[int, int], Answer]
    oldest: int  # the earliest onset for which that can be done
    rows: int  # scalars of evidence in one decision


def decide(now: Standing, look: Look) -> Standing:
    """Go through the decisions that the sums reach, or up to one after which the filter must be told a change."""
    while now.at < look.sums.last and now.change is None:
        now = _watch(now, look) if now.detected is None else _name(now, look)
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
        return _cleared(replace(now, at=calm), unexplained) if calm is not None else replace(now, at=last)
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


# ---- naming --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Case:
    """What speaks for each channel: the energy that it explains (onsets × channels), over the onsets in question."""

    onsets: np.ndarray
    answers: list[Answer]
    energy: np.ndarray

    def best(self, channel: int) -> int:
        return int(self.energy[:, channel].argmax())


def _case(now: Standing, look: Look) -> _Case:
    """Onsets at first far apart, then close to where the leading channels have theirs."""
    first = max(now.start, look.oldest)
    coarse = now.at - lengths(now.at - first)
    case = _over(now, look, np.unique(np.append(coarse, first)))
    leaders = np.argsort(-case.energy.max(axis=0))[:_LEADERS]
    close = [case.onsets[0]]
    for channel in leaders:
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


def _name(now: Standing, look: Look) -> Standing:
    """One decision further with something noticed: name it, give it up, or wait for more."""
    cal, at = look.calibrated, now.at + 1
    now = replace(now, at=at)
    waited = at - now.detected
    if at < now.again:
        return now
    case = _case(now, look)
    noise = cal.noise
    best = case.energy.max(axis=0)
    leader = int(best.argmax())
    place = case.best(leader)
    length = at - int(case.onsets[place])
    k = int(noise.nearest(length))
    best = best / (noise.energy[k] / (noise.lengths[k] * look.rows))  # in units of the noise as it is
    glr = case.energy[place, leader] / noise.v[k, leader] / (1.0 + length / now.memory)
    residual, share = _left(now, look, case, place, leader)
    if glr < 0.5 * cal.glr and residual < 0.5 * cal.residual and waited > cal.settle:
        return replace(now, detected=None, start=max(now.start, at - cal.settle))  # it went away again
    order = np.sort(best)[::-1]
    sure = len(order) < 2 or order[0] - order[1] > CLEAR + ROUGHLY * order[0]
    believable = share >= SHARE or residual < cal.residual
    formed = length >= LEAST and glr > cal.glr and believable
    if not (sure and formed) and waited < min(PATIENCE * max(cal.settle, LEAST), MOST_PATIENCE):
        return replace(now, again=at + max(1, waited // 4))
    if believable and glr > 0.5 * cal.glr:
        return _fault(now, look, case, leader, best, glr)
    return _unexplained(now, look, length, residual)


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


def _fault(now: Standing, look: Look, case: _Case, leader: int, best: np.ndarray, glr: float) -> Standing:
    """The leading channel is it: its onset, its size. The filter is to be told."""
    place = case.best(leader)
    near = case.onsets[case.energy[:, leader] >= case.energy[place, leader] - 3.84]
    alternatives = tuple(int(i) for i in np.argsort(-best) if i != leader and best[leader] - best[i] < AS_WELL + ROUGHLY * best[leader])
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
        return _changed(now, held[0], size, deviation)
    found = Found(now.at, leader, alternatives, onset, int(near.min()), int(near.max()), size, deviation, glr)
    return replace(now, found=(*now.found, found), active=(*now.active, len(now.found)))


def _changed(now: Standing, i: int, change: float, deviation: float) -> Standing:
    """A fault that is known has changed its size, or has ended."""
    total = float(now.known[now.found[i].channel])
    if abs(total) < max(GONE * abs(total - change), 3.0 * deviation):
        return _cleared(now, [i])
    return _with(now, i, replace(now.found[i], size=total, deviation=deviation))


def _cleared(now: Standing, which: list[int]) -> Standing:
    """Findings that are over; what the filter took as known of them becomes zero."""
    known, change = now.known.copy(), now.change
    for i in which:
        channel = now.found[i].channel
        if channel is not None:
            rest = np.zeros_like(known)
            rest[channel] = -known[channel]
            known[channel] = 0.0
            V = None if change is None else change.V
            change = Change((0.0 if change is None else change.size) + rest, V)
        now = _with(now, i, replace(now.found[i], cleared=now.at))
    active = tuple(k for k in now.active if k not in which)
    memory = now.memory if any(now.found[k].channel is not None for k in active) else np.inf
    return replace(now, known=known, active=active, memory=memory, change=change, start=now.at)


def _with(now: Standing, i: int, found: Found) -> Standing:
    return replace(now, found=(*now.found[:i], found, *now.found[i + 1 :]))


def _unexplained(now: Standing, look: Look, length: int, residual: float) -> Standing:
    """No channel explains it."""
    onset = now.at - length
    output = look.sums.loudest(max(onset, look.sums.first), now.at)
    found = Found(now.at, None, (), onset, onset, onset, np.nan, np.nan, residual, output)
    return replace(now, detected=None, start=now.at, found=(*now.found, found), active=(*now.active, len(now.found)))


# ---- afterwards ----------------------------------------------------------------------------------------------------------


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
        now = _with(now, i, replace(now.found[i], size=size, deviation=deviation))
    return _cleared(now, over) if over else now
