"""What was noticed gets a name, a new one or another for what was named last."""

from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.candidates import AS_WELL, distrusted, pairs, singles
from thetascope.diagnosis.isolation.decision_state import Change, Event, Found, Look, Pending, Standing, Young
from thetascope.diagnosis.isolation.first_order import case
from thetascope.diagnosis.isolation.known_faults import (
    LEAST,
    SOON,
    distrust,
    finding,
    oldest,
    remembered,
    take,
    withdrawn,
)
from thetascope.diagnosis.isolation.likelihood_fit import CLEAR, Explained, price
from thetascope.diagnosis.isolation.replay import Scene

SHARE = 0.7  # of the energy above the noise that a fault of the model has to explain
PATIENCE = 8  # settling times, after which an answer is given as it stands,
MOST_PATIENCE = 100  # decisions, if that is less
YOUNG = LONGEST // 2  # decisions after which a finding is left as it is, lest it take up what comes after
BELIEVED = 4.0  # standard deviations of the noise's energy: what a true explanation may leave
DOUBTED = 3.0  # the same, from which on it is asked what else it may be
MOST_YOUNG = 3  # events that may still be seen otherwise


@dataclass(frozen=True)
class Choice:
    """Explanations of the same data, the best first; ``revised``: the events that are pending whose place they take."""

    scene: Scene
    answers: list[Explained]
    revised: tuple[Young, ...] = ()

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
    choice = _new(now, look, LEAST if waited < 2 * LEAST else 0)
    last = _last_look(now)
    if last is not None and (_now_and_then(waited) or at == last or _ready(choice, now, look, waited)):
        choice = _otherwise(now, look, choice)
    leader = choice.leader
    if (
        max(e.statistic for e in choice.answers) < 0.5 * cal.glr
        and leader.output is None
        and leader.left < 0.5 * cal.residual
        and waited > cal.settle
    ):
        return replace(now, detected=None, passed=at - cal.settle)  # it went away again
    if not _ready(choice, now, look, waited):
        again = at + max(1, waited // 2)
        return replace(now, again=last if last is not None and at < last < again else again)
    if leader.output is None and leader.statistic > 0.5 * cal.glr and (leader.left < BELIEVED or leader.share >= SHARE):
        return raised(now, look, choice)
    return _unexplained(now, look, choice)


def _now_and_then(waited: int) -> bool:
    """When what was named last is looked at again though nothing is to be said yet: it takes long."""
    return waited >= LEAST and waited & (waited - 1) == 0


def _last_look(now: Standing) -> int | None:
    """The last decision at which what was named last can be looked at with all its data; None: nothing is to be looked at."""
    pending = now.pending
    return None if pending is None or pending.settled else _kept_until(pending.young[-1].event.first)


def _kept_until(onset: int) -> int:
    """The last decision at which all data since an onset are there."""
    return onset + LONGEST - 1


def next_look(now: Standing, onset: int) -> int:
    """When what began at an onset is looked at again: when there is twice as much data, and once more before these are forgotten."""
    following, last = now.at + max(2, now.at - onset), _kept_until(onset)
    return last if now.at < last < following else following


def _ready(choice: Choice, now: Standing, look: Look, waited: int) -> bool:
    """Whether an answer is given: it is sure and has taken its form, or it has been waited for long enough."""
    leader = choice.leader
    formed = now.at - leader.onset >= (LEAST if len(leader.events) == 1 else 2 * LEAST)
    formed &= leader.output is not None or leader.statistic > look.calibrated.glr
    formed &= waited >= 2 * LEAST or not any(
        e.rise for e in leader.events
    )  # a slow fault does not show from its onset on
    return (_sure(choice, now) and formed and leader.left < BELIEVED) or waited >= _patience(choice, now, look)


def _patience(choice: Choice, now: Standing, look: Look) -> int:
    """Decisions after which an answer is given as it stands: more, if it is open whether a fault is new at all."""
    held = {now.found[i].channel for i in now.active}
    near = [e for e in choice.answers if e.cost - choice.leader.cost < CLEAR and e.output is None]
    if len({bool({v.channel for v in e.events} & held) for e in near}) > 1:
        return MOST_PATIENCE
    return min(PATIENCE * max(look.calibrated.settle, LEAST), MOST_PATIENCE)


def _sure(choice: Choice, now: Standing) -> bool:
    """Whether the leader has no rival, or what it could be is known already."""
    leader = choice.leader
    if choice.revised and leader.output is None and {e.channel for e in leader.events} <= _channels(choice.revised):
        return True
    rivals = [e for e in choice.answers[1:] if e.output is None or leader.output is None]
    return not rivals or rivals[0].cost - leader.cost > CLEAR


def _new(now: Standing, look: Look, least_length: int) -> Choice:
    """What new events may explain the data; ``least_length``: see `singles`."""
    held = {now.found[i].channel for i in now.active} - {None}
    pending = now.pending
    if pending is None:
        scene = Scene.of(look, now.known, (), max(now.start, oldest(now, look)), now.at, now.heed)
        return Choice(scene, _answers(scene, now.memory, held, least_length=least_length))
    scene = Scene.of(look, pending.base, pending.events, pending.begin, now.at, now.heed)
    return Choice(scene, _answers(scene, now.memory if pending.settled else np.inf, held, least_length=least_length))


def _otherwise(now: Standing, look: Look, new: Choice) -> Choice:
    """What was named last named otherwise, if that explains the data better than new events do."""
    pending = now.pending
    groups = dict.fromkeys(
        group for y in (*latest_open(pending), pending.young[-1]) for group in ((y,), together(pending, y))
    )
    instead = min((seen_as(now, look, group) for group in groups), key=lambda c: c.leader.cost - price_of(c.revised))
    # a fault named a moment ago was named wrongly, rather than that it has changed by now
    group = instead.revised
    changed = any(y.own for y in group) and {e.channel for e in new.leader.events} == {group[-1].event.channel}
    more = CLEAR if changed and now.at - now.found[group[-1].found].at < SOON else 0.0
    return instead if instead.leader.cost < new.leader.cost + price_of(group) + more else new


def latest_open(pending: Pending) -> list[Young]:
    """The latest event that could be something else."""
    return [y for y in pending.young if len(y.options) > 1][-1:]


def together(pending: Pending, young: Young) -> tuple[Young, ...]:
    """The events that are seen as one fault with another: if that is wrong, so are they."""
    return tuple(y for y in pending.young if y.found == young.found)


def price_of(young: tuple[Young, ...]) -> float:
    """What events cost themselves, in twice the log of a likelihood."""
    return sum(price(y.event) for y in young)


def _channels(young: tuple[Young, ...]) -> set[int]:
    return set().union(*(y.channels for y in young))


def seen_as(now: Standing, look: Look, group: tuple[Young, ...]) -> Choice:
    """What else events that are pending may have been: one of another shape, or another fault."""
    pending, own = now.pending, any(y.own for y in group)
    others = tuple(y.event for y in pending.young if y not in group)
    scene = Scene.of(look, pending.base, others, pending.begin, now.at, now.heed)
    held = {now.found[i].channel for i in now.active} - {None, group[-1].event.channel if own else None}
    options = tuple(dict.fromkeys(o for y in group for o in y.options))
    return Choice(scene, _kept(_answers(scene, np.inf, held, options), group[-1].event.channel), group)


def _kept(answers: list[Explained], channel: int) -> list[Explained]:
    """The name that was given comes first as long as it explains the data as well."""
    same = [e for e in answers if [v.channel for v in e.events] == [channel]]
    if same and same[0].cost < answers[0].cost + AS_WELL:
        return [same[0], *(e for e in answers if e is not same[0])]
    return answers


def _answers(
    scene: Scene, memory: float, held: set[int], options: tuple[Event, ...] = (), least_length: int = 0
) -> list[Explained]:
    seen = case(scene, bool(options))
    answers, exact = singles(scene, seen, memory, held, options, least_length)
    if answers[0].left > DOUBTED and exact:
        glr = scene.look.calibrated.glr
        if not any(e.left < BELIEVED and e.statistic > glr and scene.at - e.onset >= 2 * LEAST for e in answers):
            answers += distrusted(scene)
        answers += pairs(scene, seen, memory)
    return sorted(answers, key=lambda e: e.cost)


# ---- findings ------------------------------------------------------------------------------------------------------------


def raised(now: Standing, look: Look, choice: Choice) -> Standing:
    """The leading explanation is it. The filter is to be told."""
    leader, scene, pending = choice.leader, choice.scene, now.pending
    old: tuple[Young, ...] = () if pending is None else pending.young
    named = {e.channel for e in leader.events}
    again, *others = sorted((y for y in choice.revised if y.own), key=lambda y: y.event.channel not in named) or [None]
    old = tuple(y for y in old if y not in choice.revised)
    for other in others:  # two findings turn out to be one
        now = withdrawn(now, other) if other.found != again.found else now
    if again is not None and not named & _channels(choice.revised):
        now, again = withdrawn(now, again), None
    young = []
    for event in leader.events:
        options = (event, *_others(choice, event))
        mine = again is not None and event.channel in _channels(choice.revised)
        now, i, own = finding(now, scene, leader.statistic, event, options, again.found if mine else None)
        again = None if mine else again
        young.append(Young(event, i, own, options))
    begin, base, review = scene.begin, scene.base, next_look(now, leader.onset)
    if pending is None or len(old) + len(young) > MOST_YOUNG or now.at - begin > YOUNG:
        begin = max(begin, _since(now, old, young))
        over = tuple(y for y in old if y.event.first < begin and y.event.over(begin))  # left as they are
        base, old = base.plus(tuple(y.event for y in over), begin), tuple(y for y in old if y not in over)
    now = replace(now, detected=None, pending=Pending(begin, base, (*old, *young), review))
    return take(now, look, leader)


def _since(now: Standing, old: tuple[Young, ...], young: list[Young]) -> int:
    """The decision from which on data are needed: before what is new, and what belongs to it; no rise is cut in two."""
    new = min(y.event.first for y in young)
    faults = {y.found for y in young}
    first = min([new, *(y.event.first for y in old if y.event.endless or y.found in faults)]) - (now.at - new)
    for event in sorted((y.event for y in old), key=lambda e: -e.onset):
        first = first if event.over(first) else min(first, event.first)
    return first


def _others(choice: Choice, event: Event) -> list[Event]:
    """What else an event could be: of explanations that are as good and differ in it alone."""
    leader = choice.leader
    rest = {e.channel for e in leader.events} - {event.channel}
    found = []
    for other in choice.answers[1:]:
        mine = [e for e in other.events if e.channel not in rest]
        if other.cost - leader.cost < AS_WELL and len(other.events) == len(leader.events) and len(mine) == 1:
            found.append(mine[0])
    return found


def _unexplained(now: Standing, look: Look, choice: Choice) -> Standing:
    """No channel explains it: an output is not to be trusted, or something is on that is not in the model."""
    outputs = [e for e in choice.answers if e.output is not None]
    if not outputs:
        outputs = distrusted(choice.scene)
    best = min(outputs, key=lambda e: e.cost)
    left = min((e.left for e in choice.answers if e.output is None), default=best.left)
    if best.left < look.calibrated.residual or best.share >= SHARE:
        return distrust(now, look, best.output, best.onset, left)
    found = Found(now.at, None, (), best.onset, best.onset, best.onset, np.nan, np.nan, left, best.output)
    return replace(
        now,
        detected=None,
        start=now.at,
        found=(*now.found, found),
        active=(*now.active, len(now.found)),
        change=Change(),
        pending=None,
    )
