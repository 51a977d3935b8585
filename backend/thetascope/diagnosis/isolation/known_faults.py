"""What was found is taken as known: findings get their sizes and their ends, and the filter is told."""

from dataclasses import replace

import numpy as np

from thetascope.diagnosis.detection.window_tests import LONGEST
from thetascope.diagnosis.isolation.decision_state import NEVER, Change, Event, Found, Look, Pending, Standing, Young
from thetascope.diagnosis.isolation.first_order import onsets
from thetascope.diagnosis.isolation.likelihood_fit import Explained
from thetascope.diagnosis.isolation.ramp_uncertainty import shape_variance
from thetascope.diagnosis.isolation.replay import Scene

VAGUEST = 3.0  # times as uncertain as if its shape were known is a rise that is still going on
GONE = 0.2  # of its size: a fault whose estimate falls below is over
LEAST = 4  # decisions that an answer takes: a single outlier looks like anything over one
SOON = 20  # decisions after which a fault may have changed since it was named
RECENT = 100  # decisions within which an output that fails again has not been well


def take(now: Standing, look: Look, fit: Explained) -> Standing:
    """Take what is pending as known, with the sizes of a fit; findings are told them."""
    pending = _levelled(now.pending, fit)
    sizes = {e.course_key: e for e in fit.events}
    young = tuple(replace(y, event=sizes.get(y.event.course_key, y.event)) for y in pending.young)
    events = tuple(y.event for y in young)
    known = pending.base.plus(events, now.at).inside(look.calibrated.within)
    length = now.at - fit.onset
    memory = float(length) / (4 if any(e.endless for e in fit.events) else 1)
    before = {i: now.found[i] for i in now.active}
    now = replace(now, known=known, pending=replace(pending, young=young), memory=memory, start=now.at)
    scene = Scene.of(look, pending.base, events, pending.begin, now.at, now.heed)
    now = replace(now, change=Change(scene.track.states[1:]))
    for i in now.active:  # an event that is seen otherwise now may have been a change of an older fault
        if now.found[i].channel is not None:
            now = with_found(now, i, replace(now.found[i], size=float(known.level[now.found[i].channel])))
    known_before = [f for f in before.values() if f.channel is not None]
    over = []
    for k, event in enumerate(fit.events):
        i = next((y.found for y in young if y.event == event), None)
        if i is None:  # it is part of another event now, which will be estimated anew
            continue
        deviation, v = _deviation(now, look, fit, k, known_before)
        if 0 < event.rise < np.inf:
            shape = _by_shape(now, look, events, fit, k)
            deviation = (
                float(np.hypot(deviation, shape))
                if shape
                else max(now.found[i].deviation, deviation * _vaguer(scene, event, deviation, v))
            )
        if (
            pending.base.slope[event.channel] or pending.base.rest[event.channel]
        ):  # it went on from a level that is not known better
            deviation = float(np.hypot(deviation, before[i].deviation))
        size = float(known.level[event.channel])
        had = float(pending.base.plus(tuple(e for e in events if e != event), event.onset).level[event.channel])
        least = max(GONE * abs(had or before[i].size), 3.0 * deviation)
        settled = now.at - now.found[i].at >= SOON or any(
            y.found == i and not y.own for y in young
        )  # not a moment after
        coming = max(abs(known.slope[event.channel]) * max(length, LEAST), abs(size + known.rest[event.channel]))
        if settled and abs(size) < least and coming < least:
            over.append(i)
            now = with_found(now, i, as_it_stood(replace(before[i], size=had or before[i].size)))
        else:
            first = now.found[i].first or (size, deviation)
            now = with_found(now, i, replace(now.found[i], size=size, deviation=deviation, first=first))
    return cleared(now, over) if over else _stood(now, young)


def as_it_stood(found: Found) -> Found:
    """With the size that it had when nothing had happened for a while, if there was such a time."""
    return found if found.stood is None else replace(found, size=found.stood[0], deviation=found.stood[1])


def _stood(now: Standing, young: tuple[Young, ...]) -> Standing:
    """With the sizes remembered of faults to which nothing has happened for a while."""
    if now.at - max(y.event.onset for y in young) < SOON:
        return now
    changed = {
        y.found for y in young if not y.own and now.at - y.event.onset < RECENT
    }  # perhaps: it may turn out to be its end
    for i in set(now.active) - changed:
        now = with_found(now, i, replace(now.found[i], stood=(now.found[i].size, now.found[i].deviation)))
    return now


def _deviation(now: Standing, look: Look, fit: Explained, k: int, known: list[Found]) -> tuple[float, float]:
    """Standard deviation of what event ``k`` of a fit has reached, if its shape is so, and the v that it rests on (`Noise`); ``known``: the
    faults that were known before."""
    event, noise = fit.events[k], look.calibrated.noise
    settling, long = (
        float(noise.v[noise.nearest(n), event.channel]) for n in (2 * look.calibrated.settle, now.at - fit.onset)
    )
    v = long + float(fit.early[k]) * max(settling - long, 0.0)
    others = sum((fit.passed[k, f.channel] * f.deviation) ** 2 for f in known if f.channel != event.channel)
    variance = max(v * fit.covariance[k, k], 0.0)
    # errors of old standing are partly taken up by x
    return float(np.sqrt(variance + min(others, variance)) * abs(event.reached(now.at))), v


def _by_shape(now: Standing, look: Look, events: tuple[Event, ...], fit: Explained, k: int) -> float:
    """Standard deviation of what an event has reached by now since its shape is estimated as well; 0 if that cannot be told.

    What decides a shape are its ends, and there noise is white, unlike over the whole.
    """
    others = tuple(e for e in events if e not in fit.events)
    return (
        shape_variance(Scene.of(look, now.pending.base, others, now.pending.begin, now.at, now.heed), fit.events, k)
        ** 0.5
    )


def _vaguer(scene: Scene, event: Event, deviation: float, v: float) -> float:
    """By how much less is known of the size of a rise since its shape is estimated as well: it is known by what came after it."""
    if not 0 < event.rise < np.inf:
        return 1.0
    end = min(int(event.onset + event.rise * (2 if event.bent else 1)), scene.at - 1)
    J = float(scene.ahead.ww[max(end - scene.begin, 0), event.channel, event.channel])
    return float(np.clip((v / max(J, 1e-300)) ** 0.5 / max(deviation, 1e-300), 1.0, VAGUEST))


def _levelled(pending: Pending, fit: Explained) -> Pending:
    """A rise that a later event of its channel brings to an end is one event: a rise with an end."""
    last = pending.young[-1]
    sizes = {e.course_key: (e, fit.covariance[k, k]) for k, e in enumerate(fit.events)}
    for k, young in enumerate(pending.young[:-1]):
        one = young.event
        two, variance = sizes.get(last.event.course_key, (last.event, 0.0))
        rising = one.endless and two.endless and one.channel == two.channel and two.onset > one.onset
        if rising and abs(one.size + two.size) < max(3.0 * variance**0.5, GONE * abs(one.size)):
            rise = float(two.onset - one.onset)
            event = Event(one.channel, one.onset, rise, one.size * rise)
            rest = (*pending.young[:k], replace(young, event=event, options=(event,)), *pending.young[k + 1 : -1])
            return replace(pending, young=rest)
    return pending


def cleared(now: Standing, which: list[int]) -> Standing:
    """Findings that are over; what the filter took as known of them becomes zero."""
    known = now.known.plus((), now.at).without(
        [now.found[i].channel for i in which if now.found[i].channel is not None]
    )
    for i in which:
        now = with_found(now, i, replace(now.found[i], cleared=now.at))
    active = tuple(k for k in now.active if k not in which)
    memory = now.memory if any(now.found[k].channel is not None for k in active) else np.inf
    change = Change() if now.change is None else now.change
    return replace(now, known=known, active=active, memory=memory, change=change, start=now.at, pending=None)


def with_found(now: Standing, i: int, found: Found) -> Standing:
    return replace(now, found=(*now.found[:i], found, *now.found[i + 1 :]))


def finding(now: Standing, scene: Scene, statistic: float, event: Event, options: tuple[Event, ...], own: int | None):
    """The finding that an event belongs to: its ``own`` under a better name, that of its channel, or a new one."""
    others = tuple(dict.fromkeys(o.channel for o in options if o.channel != event.channel))
    held = [i for i in now.active if now.found[i].channel == event.channel and i != own]
    if held:
        return (now if own is None else cleared(now, [own])), held[0], False
    span = onsets(scene, event)
    if own is not None:
        found = now.found[own]
        if found.channel != event.channel:  # what it was as another fault says nothing of this one
            found = replace(found, size=0.0, stood=None, first=None)
        found = replace(
            found, channel=event.channel, alternatives=others, onset=event.onset, onset_from=span[0], onset_to=span[1]
        )
        return with_found(now, own, found), own, True
    found = Found(now.at, event.channel, others, event.onset, *span, 0.0, 0.0, statistic)
    now = replace(now, found=(*now.found, found), active=(*now.active, len(now.found)))
    return now, len(now.found) - 1, True


def withdrawn(now: Standing, young: Young) -> Standing:
    """What was named last turns out to be something else altogether: its own finding is over."""
    return cleared(now, [young.found]) if young.own and young.found in now.active else now


def distrust(now: Standing, look: Look, output: int, onset: int, statistic: float) -> Standing:
    """An output is not followed from an onset on. What was named since, or just before, was named because of it."""
    now = remembered(now, look)
    onset = max(onset, oldest(now, look), look.calibrated.begin)
    pending, young = now.pending, () if now.pending is None else now.pending.young
    mistaken = tuple(
        y for y in young if y.event.first >= onset - LEAST or (y.own and now.at - now.found[y.found].at < SOON)
    )
    own = [y.found for y in mistaken if y.own and y.found in now.active]
    if mistaken:
        onset = max(min(onset, *(y.event.first for y in mistaken)), pending.begin)
        rest = tuple(y.event for y in pending.young if y not in mistaken)
        known = pending.base.plus(rest, onset)
    else:
        known = now.known
    heed = now.heed.copy()
    heed[output] = 0.0
    states = look.stretch(onset, now.at, known.course).replay(look.state(onset), onset, heed, False).states
    now = cleared(now, own[1:]) if own[1:] else now
    now = replace(
        now, known=known.plus((), now.at), pending=None, detected=None, start=now.at, heed=heed, change=Change(states)
    )
    found = Found(now.at, None, (), onset, onset, onset, np.nan, np.nan, statistic, output)
    again = [
        i
        for i, f in enumerate(now.found)
        if f.output == output and f.cleared is not None and now.at - f.cleared < RECENT
    ]
    if own:
        return with_found(now, own[0], replace(found, at=now.found[own[0]].at))
    if again:
        return replace(
            with_found(now, again[-1], replace(now.found[again[-1]], cleared=None)), active=(*now.active, again[-1])
        )
    return replace(now, found=(*now.found, found), active=(*now.active, len(now.found)))


def oldest(now: Standing, look: Look) -> int:
    """The earliest decision from which the filter can be run again, however the rows came in."""
    return max(look.oldest, now.at - LONGEST)


def remembered(now: Standing, look: Look) -> Standing:
    """With what is pending since longer ago than the filter can be run again from left as it is, or without what was before it."""
    pending, begin = now.pending, oldest(now, look)
    if pending is None or pending.begin >= begin:
        return now
    if all(y.event.first > begin for y in pending.young):
        return replace(now, pending=replace(pending, begin=begin, base=pending.base.plus((), begin)))
    over = tuple(y for y in pending.young if y.event.over(begin))
    young = tuple(y for y in pending.young if y not in over)
    return replace(
        now, pending=Pending(begin, pending.base.plus(tuple(y.event for y in over), begin), young, NEVER, settled=True)
    )
