"""What was noticed gets a name; what was named last is looked at again as data come in."""

from dataclasses import dataclass, replace

import numpy as np

from backend.diagnosis.hypotheses import AS_WELL, CLEAR, Explained, distrusted, fitted, pairs, singles
from backend.diagnosis.knowledge import LEAST, SOON, distrust, finding, oldest, remembered, take, withdrawn
from backend.diagnosis.scene import Scene
from backend.diagnosis.screening import case
from backend.diagnosis.standing import Change, Event, Found, Look, Pending, Standing, Young
from backend.diagnosis.windows import LONGEST

SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times, after which an answer is given as it stands,
MOST_PATIENCE = 100  # decisions, if that is less
YOUNG = LONGEST // 2  # decisions after which a finding is left as it is, lest it take up what comes after
BELIEVED = 4.0  # standard deviations of the noise's energy: what a true explanation may leave
DOUBTED = 3.0  # the same, from which on it is asked what else it may be
MOST_YOUNG = 3  # events that may still be seen otherwise


@dataclass(frozen=True)
class _Choice:
    """Explanations of the same data, the best first; ``revised``: the event that is pending whose place they take."""

    scene: Scene
    answers: list[Explained]
    revised: int | None = None

    @property
    def leader(self) -> Explained:
        return self.answers[0]


def name(now: Standing, look: Look) -> Standing:
    """One decision further with something noticed: name it, give it up, or wait for more."""
    cal, at = look.calibrated, now.at + 1
    now = remembered(replace(now, at=at), look)
    waited = at - now.detected
    if at < now.again:
        return now
    choice = _choice(now, look)
    leader = choice.leader
    length = at - leader.onset
    if max(e.statistic for e in choice.answers) < 0.5 * cal.glr and leader.output is None and leader.left < 0.5 * cal.residual and waited > cal.settle:
        return replace(now, detected=None, start=max(now.start, at - cal.settle))  # it went away again
    believable = leader.left < BELIEVED
    formed = length >= (LEAST if len(leader.events) == 1 else 2 * LEAST) and (leader.output is not None or leader.statistic > cal.glr)
    if not (_sure(choice, now) and formed and believable) and waited < _patience(choice, now, look):
        return replace(now, again=at + max(1, waited // 3))
    if leader.output is None and leader.statistic > 0.5 * cal.glr and (believable or leader.share >= SHARE):
        return _raised(now, look, choice)
    return _unexplained(now, look, choice)


def _patience(choice: _Choice, now: Standing, look: Look) -> int:
    """Decisions after which an answer is given as it stands: more, if it is open whether a fault is new at all."""
    held = {now.found[i].channel for i in now.active}
    near = [e for e in choice.answers if e.cost - choice.leader.cost < CLEAR and e.output is None]
    if len({bool({v.channel for v in e.events} & held) for e in near}) > 1:
        return MOST_PATIENCE
    return min(PATIENCE * max(look.calibrated.settle, LEAST), MOST_PATIENCE)


def _sure(choice: _Choice, now: Standing) -> bool:
    """Whether the leader has no rival, or what it could be is known already."""
    leader = choice.leader
    again = None if choice.revised is None else now.pending.young[choice.revised]
    if again is not None and leader.output is None and {e.channel for e in leader.events} <= again.channels:
        return True
    rivals = [e for e in choice.answers[1:] if e.output is None or leader.output is None]
    return not rivals or rivals[0].cost - leader.cost > CLEAR


def _choice(now: Standing, look: Look) -> _Choice:
    """What may explain the data: something new, or what was named last named otherwise."""
    held = {now.found[i].channel for i in now.active} - {None}
    pending = now.pending
    if pending is None:
        scene = Scene.of(look, now.known, (), max(now.start, oldest(now, look)), now.at, now.heed)
        return _Choice(scene, _answers(scene, now.memory, held))
    scene = Scene.of(look, pending.base, pending.events, pending.begin, now.at, now.heed)
    new = _Choice(scene, _answers(scene, np.inf, held))
    open_ = [k for k, y in enumerate(pending.young) if len(y.options) > 1][-1:]
    tried = [_instead(now, look, k) for k in sorted({*open_, len(pending.young) - 1})]
    instead = min(tried, key=lambda c: c.leader.cost)
    # a fault named a moment ago was named wrongly, rather than that it has changed by now
    last = pending.young[instead.revised]
    changed = last.own and {e.channel for e in new.leader.events} == {last.event.channel}
    more = CLEAR if changed and now.at - now.found[last.found].at < SOON else 0.0
    return instead if instead.leader.cost < new.leader.cost + CLEAR + more else new


def _instead(now: Standing, look: Look, k: int) -> _Choice:
    """What else an event that is pending may have been."""
    pending, young = now.pending, now.pending.young[k]
    others = tuple(y.event for i, y in enumerate(pending.young) if i != k)
    scene = Scene.of(look, pending.base, others, pending.begin, now.at, now.heed)
    held = {now.found[i].channel for i in now.active} - {None, young.event.channel if young.own else None}
    return _Choice(scene, _kept(_answers(scene, np.inf, held, young.options), young), k)


def _kept(answers: list[Explained], last: Young) -> list[Explained]:
    """The name that was given comes first as long as it explains the data as well."""
    same = [e for e in answers if [v.channel for v in e.events] == [last.event.channel]]
    if same and same[0].cost < answers[0].cost + AS_WELL:
        return [same[0], *(e for e in answers if e is not same[0])]
    return answers


def _answers(scene: Scene, memory: float, held: set[int], options: tuple[Event, ...] = ()) -> list[Explained]:
    seen = case(scene, bool(options))
    answers = singles(scene, seen, memory, held, options)
    if answers[0].left > DOUBTED:
        glr = scene.look.calibrated.glr
        if not any(e.left < BELIEVED and e.statistic > glr and scene.at - e.onset >= 2 * LEAST for e in answers):
            answers += distrusted(scene)
        answers += pairs(scene, seen, memory)
    return sorted(answers, key=lambda e: e.cost)


# ---- findings ------------------------------------------------------------------------------------------------------------


def _raised(now: Standing, look: Look, choice: _Choice) -> Standing:
    """The leading explanation is it. The filter is to be told."""
    leader, scene, pending = choice.leader, choice.scene, now.pending
    old: tuple[Young, ...] = () if pending is None else pending.young
    again: Young | None = None
    if choice.revised is not None:
        again, old = old[choice.revised], (*old[: choice.revised], *old[choice.revised + 1 :])
        if not again.own or not {e.channel for e in leader.events} & again.channels:
            now, again = withdrawn(now, again), None
    young = []
    for event in leader.events:
        options = (event, *_others(choice, event))
        mine = again is not None and event.channel in again.channels
        now, i, own = finding(now, scene, leader.statistic, event, options, again.found if mine else None)
        again = None if mine else again
        young.append(Young(event, i, own, options))
    begin = scene.begin if pending is not None else max(scene.begin, leader.onset - 2 * (now.at - leader.onset))
    base, review = scene.base, now.at + max(2, now.at - leader.onset)
    if len(old) + len(young) > MOST_YOUNG or now.at - begin > YOUNG:  # the older ones are left as they are
        begin = max(begin, min(y.event.first for y in young))
        base, old = base.plus(tuple(y.event for y in old), begin), ()
    now = replace(now, detected=None, pending=Pending(begin, base, (*old, *young), review))
    return take(now, look, leader)


def _others(choice: _Choice, event: Event) -> list[Event]:
    """What else an event could be: of explanations that are as good and differ in it alone."""
    leader = choice.leader
    rest = {e.channel for e in leader.events} - {event.channel}
    found = []
    for other in choice.answers[1:]:
        mine = [e for e in other.events if e.channel not in rest]
        if other.cost - leader.cost < AS_WELL and len(other.events) == len(leader.events) and len(mine) == 1:
            found.append(mine[0])
    return found


def _unexplained(now: Standing, look: Look, choice: _Choice) -> Standing:
    """No channel explains it: an output is not to be trusted, or something is on that is not in the model."""
    outputs = [e for e in choice.answers if e.output is not None]
    if not outputs:
        outputs = distrusted(choice.scene)
    best = min(outputs, key=lambda e: e.cost)
    left = min((e.left for e in choice.answers if e.output is None), default=best.left)
    if best.left < look.calibrated.residual or best.share >= SHARE:
        return distrust(now, look, best.output, best.onset, left)
    found = Found(now.at, None, (), best.onset, best.onset, best.onset, np.nan, np.nan, left, best.output)
    return replace(now, detected=None, start=now.at, found=(*now.found, found), active=(*now.active, len(now.found)), change=Change(),
                   pending=None)  # fmt: skip


# ---- afterwards ----------------------------------------------------------------------------------------------------------


def reviewed(now: Standing, look: Look) -> Standing:
    """What is pending, with the data that came since: what else it may have been, and how large it is."""
    now = remembered(now, look)
    if now.pending is None:
        return now
    pending, last = now.pending, now.pending.young[-1]
    for k in [k for k, y in enumerate(pending.young) if len(y.options) > 1][-1:]:
        choice = _instead(now, look, k)
        if choice.leader.output is None and len(choice.leader.events) == 1:
            return _settled(_raised(now, look, choice))
    # each channel's latest event is estimated anew; what came before it in the same channel stays
    latest = {y.event.channel: y.event for y in pending.young}
    fixed = tuple(e for e in pending.events if e not in latest.values())
    fit = fitted(Scene.of(look, pending.base, fixed, pending.begin, now.at, now.heed), tuple(latest.values()))
    now = replace(now, pending=replace(pending, review=now.at + max(2, now.at - last.event.first)))
    return _settled(take(now, look, fit))


def _settled(now: Standing) -> Standing:
    """Without what is pending, if that is no longer young."""
    return replace(now, pending=None) if now.pending is not None and now.at - now.pending.begin > YOUNG else now
