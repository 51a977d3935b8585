"""What was named last is looked at again as data come in: its size, what else it may have been, and whether all of it is needed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.decision_state import NEVER, Look, Standing, Young
from thetascope.diagnosis.isolation.isolate import YOUNG, latest_open, next_look, price_of, raised, seen_as, together
from thetascope.diagnosis.isolation.known_faults import remembered, take, withdrawn
from thetascope.diagnosis.isolation.likelihood_fit import Explained, fitted, price
from thetascope.diagnosis.isolation.replay import Scene

SLOW = (
    LONGEST - 50
)  # decisions after which a rise is left as it is: it takes longer than a step (YOUNG) to show how large it becomes
_APART = 8  # times as long ago as they were apart: events that began at about the same time


def reviewed(now: Standing, look: Look) -> Standing:
    """What is pending, with the data that came since: what else it may have been, and how large it is."""
    now = remembered(now, look)
    if now.pending is None or now.pending.settled:
        return now
    now, fit = _pruned(now, look)
    pending, last = now.pending, now.pending.young[-1]
    for group in dict.fromkeys(
        (*(group for y in latest_open(pending) for group in (together(pending, y), (y,))), *_neighbours(now))
    ):
        choice = seen_as(now, look, group)
        better = len(group) == 1 or choice.leader.cost < _present(now, look) + price_of(group)
        if choice.leader.output is None and len(choice.leader.events) == 1 and better:
            return _settled(raised(now, look, choice))
    now = replace(now, pending=replace(now.pending, review=next_look(now, last.event.first)))
    return _settled(take(now, look, fit))


def _pruned(now: Standing, look: Look) -> tuple[Standing, Explained]:
    """Without events that are not needed: the others explain as much, but for what it costs. And the sizes of these."""
    fit = _refitted(now, look, now.pending.young)
    while len(young := now.pending.young) > 1:
        rest = [tuple(y for y in young if y is not without) for without in young]
        fits = [_refitted(now, look, others) for others in rest]
        more = [f.energy - fit.energy - price(y.event) for f, y in zip(fits, young, strict=True)]
        k = int(np.argmin(more))
        if more[k] >= 0:
            break
        pending = replace(now.pending, young=rest[k])
        alone = all(y.found != young[k].found for y in rest[k])
        now, fit = replace(withdrawn(now, young[k]) if alone else now, pending=pending), fits[k]
    return now, fit


def _refitted(now: Standing, look: Look, young: tuple[Young, ...]) -> Explained:
    """Each channel's latest event estimated anew; what came before it in the same channel stays."""
    latest = {y.event.channel: y.event for y in young}
    fixed = tuple(y.event for y in young if y.event not in latest.values())
    scene = Scene.of(look, now.pending.base, fixed, now.pending.begin, now.at, now.heed)
    return fitted(scene, [tuple(latest.values())]).explained(0)


def _present(now: Standing, look: Look) -> float:
    """What is left by what is pending, in twice the log of a likelihood."""
    pending = now.pending
    scene = Scene.of(look, pending.base, pending.events, pending.begin, now.at, now.heed)
    return float(scene.energy[-1]) / scene.unit


def _settled(now: Standing) -> Standing:
    """With what is pending left as it is, if that is no longer young: what comes may have begun before."""
    last = None if now.pending is None else now.pending.young[-1].event
    if last is None or now.at - last.first <= (SLOW if last.rise else YOUNG):
        return now
    return replace(now, pending=replace(now.pending, settled=True, review=NEVER))


def _neighbours(now: Standing) -> list[tuple[Young, ...]]:
    """Events of two findings that began at about the same time: one may have been made up to mend the other."""
    young = now.pending.young
    return [
        (a, b)
        for a, b in pairwise(young)
        if a.found != b.found
        and abs(a.event.first - b.event.first) * _APART < now.at - max(a.event.first, b.event.first)
    ]
