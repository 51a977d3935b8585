"""The findings of a record at its end: every fault again with all rows, its alternatives, its interval, its bound.

While a record is followed, an early wrong name is corrected by further events. At the end each event and the later ones
of the same channel are replaced by a single event if that explains the rows better; events that more rows refute are
dropped; the numbers of all events are refined together; and the other channels are tried in place of each.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.records.events import DRIFT, END, PLATEAU, RAMP, RISE, STEP, FaultEvent
from thetascope.diagnosis.records.follow import RISES, Decision, Follower
from thetascope.diagnosis.records.naming import Explanation, Stretch, explanations, onsets, refine, score, size_at

Z95 = 1.96
_BACK = 300  # rows before an event
_ROWS = 6000  # of a stretch in which an event is judged again, at most
_AGAIN = 6  # iterations in which events are refined again
_TOGETHER = 12_000  # rows in which all events are refined together, at most
_GRID = 40
_REACH, _TIMES = 6.0, 49  # standard deviations around an onset, and times there, at which −2 log L is evaluated
_ONE = 3.84  # 95 % quantile of χ² with one degree of freedom
_STILL = 0.9  # of the threshold: by less than this an event no longer lowers −2 log L
_CLOSE = 40.0  # score up to which an alternative is mentioned


@dataclass(frozen=True)
class Estimate:
    """A number with the ends of its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def holds_zero(self) -> bool:
        """Return whether the interval contains zero."""
        return self.low <= 0.0 <= self.high


@dataclass(frozen=True)
class Candidate:
    """One explanation of a fault.

    Attributes:
        event: channel and course, of a fault that changed its last change.
        onset, size, rate: onset in s; size at the end of the fault, in the channel's unit; its rate of change per
            second there.
        bound: the bound that the size has reached, if it has.
        behind: by how much its score is worse than the best one's; up to EQUAL they are not separable.
    """

    event: FaultEvent
    onset: Estimate
    size: Estimate
    rate: float
    bound: float | None
    behind: float


@dataclass(frozen=True)
class RecordFault:
    """A fault of one channel.

    Attributes:
        best, others: the best explanation, and other channels.
        alarm, statistic: time in s of the alarm, and its statistic.
        ended: time in s at which it ended; None: it lasts.
        changes: times in s at which it changed.
    """

    best: Candidate
    others: tuple[Candidate, ...]
    alarm: float
    statistic: float
    ended: float | None
    changes: tuple[float, ...] = ()

    @property
    def confirmed(self) -> bool:
        """Return whether the interval of its size excludes zero."""
        return not self.best.size.holds_zero


def final_faults(follower: Follower) -> tuple[RecordFault, ...]:
    """Return the findings at the end of the record; the follower's story becomes the final one."""
    for revise in (_consolidated, _significant, _simplified, _significant):
        follower.settle(sorted(revise(follower, follower.story), key=lambda e: e.onset))
    if not follower.story:
        return ()
    refined = _refined(follower)
    follower.settle([numbers.event for numbers in refined])
    faults = [_fault(follower, place, numbers) for place, numbers in enumerate(refined) if numbers.event.shape != END]
    return tuple(_merged(faults))


# ---- the story -------------------------------------------------------------------------------------------------------


def _stretch(follower: Follower, begin: float, end: float | None, most: int = _ROWS) -> Stretch:
    """Return the rows from some time before `begin` to `end`, in s, or to the last row."""
    t = follower.data.t
    onset = int(np.searchsorted(t, begin))
    last = len(t) if end is None else max(int(np.searchsorted(t, end)), min(len(t), onset + 60))
    first = max(0, onset - _BACK)
    return follower.stretch(first, max(min(last, first + most), min(len(t), onset + 10)))


def _taus(stretch: Stretch) -> list[float]:
    """Return the time constants of rises that are tried."""
    return [rise * stretch.period for rise in RISES]


def _near(stretch: Stretch, onset: float) -> np.ndarray:
    """Return onsets around one, and later ones."""
    row = int(np.searchsorted(stretch.data.t, onset))
    return onsets(max(0, row - 100), len(stretch.data.t) - 1, _GRID, [row, row - 1])


def _consolidated(follower: Follower, story: Sequence[FaultEvent]) -> list[FaultEvent]:
    """Return the story with several events replaced by a single one where that explains the rows better.

    Groups are an event and all later ones of its channel, and an event and the next one.
    """
    kept, place = sorted(story, key=lambda e: e.onset), 0
    while place < len(kept):
        event = kept[place]
        same = [e for e in kept[place:] if e.channel == event.channel]
        for group in (same, kept[place : place + 2]):
            better = _single(follower, kept, group) if len(group) > 1 else None
            if better is not None:
                rest = [e for e in kept if e not in group]
                kept = sorted([*rest, better], key=lambda e: e.onset)
                break
        else:
            place += 1
    return kept


def _single(follower: Follower, story: Sequence[FaultEvent], group: Sequence[FaultEvent]) -> FaultEvent | None:
    """Return an event that explains the rows better than a group of events does, or None."""
    if any(e.shape == END for e in group):
        return None
    others = [e for e in story if e not in group]
    end = min((e.onset for e in others if e.onset > group[0].onset), default=None)
    stretch = _stretch(follower, group[0].onset, end)
    last = float(stretch.data.t[-1])
    if any(e.onset >= last for e in group):
        return None
    base = [e for e in others if e.onset < last]
    free = list(range(len(base), len(base) + len(group)))
    several = score(stretch, [*base, *group], free, stretch.run([*base, *group], ()).loss)
    single = explanations(stretch, base, _near(stretch, group[0].onset), _taus(stretch))
    if all(e.shape == RAMP and e.channel == group[0].channel for e in group):
        rise = group[1].onset - group[0].onset  # a ramp that ends looks like two ramps
        plateau = group[0].moved(shape=PLATEAU, size=group[0].size * rise, tau=max(rise, stretch.period))
        single.append(refine(stretch, [*base, plateau], [len(base)]))
    single = sorted((s for s in single if s.event.shape != END and s.score < several), key=lambda s: s.score)
    return single[0].event if single else None


def _significant(follower: Follower, story: Sequence[FaultEvent]) -> list[FaultEvent]:
    """Return the story without events that more rows refute."""
    kept = list(story)
    for event in list(story):
        others = [e for e in kept if e is not event]
        after = [e.onset for e in kept if e.onset > event.onset]
        stretch = _stretch(follower, event.onset, min(after, default=None))
        if stretch.run(others, ()).loss - stretch.run(kept, ()).loss < _STILL * follower.threshold:
            kept = others
    while kept and kept[0].shape == END:
        kept = kept[1:]
    return kept


def _simplified(follower: Follower, story: Sequence[FaultEvent]) -> list[FaultEvent]:
    """Return the story with steps and ramps in place of courses with more numbers where these explain no better."""
    kept = list(story)
    for place, event in enumerate(kept):
        if event.shape not in (DRIFT, RISE, PLATEAU):
            continue
        others = [e for i, e in enumerate(kept) if i != place]
        after = [e.onset for e in kept if e.onset > event.onset]
        stretch = _stretch(follower, event.onset, min(after, default=None))
        own = score(stretch, [*others, event], [len(others)], stretch.run([*others, event], ()).loss)
        slope = event.slope or event.size / max(event.tau, stretch.period)
        simple = [event.moved(shape=STEP), event.moved(shape=RAMP, size=slope)]
        trials = [refine(stretch, [*others, e], [len(others)]) for e in simple]
        best = min(trials, key=lambda s: s.score)
        if best.score < own:
            kept[place] = best.event
    return kept


@dataclass(frozen=True)
class _Numbers:
    """The refined numbers of one event: an explanation, and which of its free events it is."""

    explanation: Explanation
    place: int

    @property
    def event(self) -> FaultEvent:
        """Return the event."""
        return self.explanation.free_events[self.place]


def _refined(follower: Follower) -> list[_Numbers]:
    """Return the events of the story with the numbers of all refined together, from the first one on.

    Events beyond the rows of one stretch are refined one at a time.
    """
    story = follower.story
    stretch = _stretch(follower, story[0].onset, None, _TOGETHER)
    within = [e for e in story if e.onset < stretch.data.t[-1]]
    joint = refine(stretch, within, list(range(len(within))), _AGAIN)
    refined = [_Numbers(joint, place) for place in range(len(within))]
    for place in range(len(within), len(story)):
        others = story[:place] + story[place + 1 :]
        after = story[place + 1].onset if place + 1 < len(story) else None
        alone = refine(_stretch(follower, story[place].onset, after), [*others, story[place]], [len(others)], _AGAIN)
        refined.append(_Numbers(alone, 0))
    return refined


# ---- one fault -------------------------------------------------------------------------------------------------------


def _fault(follower: Follower, place: int, numbers: _Numbers) -> RecordFault:
    """Return one event of the final story with its alternatives."""
    story, event = follower.story, numbers.event
    others = story[:place] + story[place + 1 :]
    after = [e for e in story[place + 1 :] if e.onset > event.onset]
    stretch = _stretch(follower, event.onset, min((e.onset for e in after), default=None))
    ended = next((e.onset for e in after if e.shape == END and e.channel == event.channel), None)
    at = float(follower.data.t[-1]) if ended is None else ended - 1e-9
    own = score(stretch, [*others, event], [len(others)], stretch.run([*others, event], ()).loss)
    alternatives: dict[int, Candidate] = {}
    for s in explanations(stretch, others, _near(stretch, event.onset), _taus(stretch)):
        other = s.event.channel
        if other != event.channel and s.event.shape != END and s.score - own < _CLOSE and other not in alternatives:
            alternatives[other] = _candidate(stretch, _Numbers(s, 0), at, max(s.score - own, 0.0))
    best = _candidate(stretch, numbers, at, 0.0)
    if event.onset < stretch.data.t[-1]:
        onset = _onset_interval(stretch, story, place, (best.onset.high - best.onset.low) / (2 * Z95))
        best = replace(best, onset=Estimate(event.onset, *onset))
    decision = _decision_of(follower, event)
    return RecordFault(
        best, tuple(alternatives.values()), float(follower.data.t[decision.row]), decision.statistic, ended
    )


def _decision_of(follower: Follower, event: FaultEvent) -> Decision:
    """Return the first alarm at or after an onset."""
    t = follower.data.t
    return next((d for d in follower.decisions if t[d.row] >= event.onset), follower.decisions[-1])


def _candidate(stretch: Stretch, numbers: _Numbers, t: float, behind: float) -> Candidate:
    """Return an explanation with its numbers at time t."""
    event, explanation = numbers.event, numbers.explanation
    value, std = size_at(explanation, numbers.place, t, stretch.filter.p)
    before = explanation.free_events[: numbers.place]
    row = sum(len(e.parameters()) for e in before) + event.parameters().index("onset")
    onset_std = max(float(np.sqrt(max(explanation.covariance[row, row], 0.0))), 0.25 * stretch.period)
    onset = Estimate(event.onset, event.onset - Z95 * onset_std, event.onset + Z95 * onset_std)
    slack = 0.05 * stretch.typical[event.channel]
    bounds = [float(b) for b in stretch.bounds[event.channel] if b != 0.0 and np.isfinite(b)]
    bound = next((b for b in bounds if abs(value - b) <= max(slack, std)), None)
    return Candidate(
        event,
        onset,
        Estimate(value, value - Z95 * std, value + Z95 * std),
        _rate(event, t),
        bound,
        behind,
    )


def _onset_interval(stretch: Stretch, events: Sequence[FaultEvent], place: int, std: float) -> tuple[float, float]:
    """Return the onsets that the rows do not exclude: −2 log L rises by at most the 95 % quantile of χ²₁.

    −2 log L is not smooth in an onset, so its curvature says too little. It is evaluated to first order around the
    best story for onsets around the best one, with the best size for each.
    """
    event = events[place]
    result = stretch.run(events, [event.channel])
    nu = np.nan_to_num(result.path.nu).ravel()
    t, width, typical = stretch.data.t, stretch.data.width, float(stretch.typical[event.channel])
    reach = max(_REACH * std, 3 * stretch.period)
    low = high = event.onset
    step = 0.0
    for _ in range(4):
        times = np.linspace(max(event.onset - reach, t[0]), min(event.onset + reach, t[-1]), _TIMES)
        moved = [event.moved(onset=float(x)) for x in times] + [event.moved(size=event.size + typical)]
        courses = [
            np.array([part(e) - part(event) for e in moved]) / typical
            for part in (lambda e: e.means(t, width), lambda e: e.values(t))
        ]
        channel = np.full(len(moved), event.channel)
        omega = stretch.filter.responses(stretch.data, stretch.noise, result.path, channel, *courses)
        omega = omega.reshape(len(moved), -1)
        own = omega[-1] / (np.linalg.norm(omega[-1]) or 1.0)
        left = nu - omega[:-1]
        loss = np.einsum("ij,ij->i", left, left) - (left @ own) ** 2
        kept = times[loss <= loss.min() + _ONE]
        low, high, step = float(kept.min()), float(kept.max()), float(times[1] - times[0])
        if (low > times[0] or times[0] <= t[0]) and (high < times[-1] or times[-1] >= t[-1]):
            break
        reach *= 3
    return min(low - step, event.onset), max(high + step, event.onset)


def _rate(event: FaultEvent, t: float) -> float:
    """Return the rate of change of a fault at time t, per second."""
    if event.shape == RISE:
        return event.size / event.tau * float(np.exp(-max(t - event.onset, 0.0) / event.tau))
    if event.shape == PLATEAU:
        return event.size / event.tau if t < event.onset + event.tau else 0.0
    return {RAMP: event.size, DRIFT: event.slope}.get(event.shape, 0.0)


def _merged(faults: Sequence[RecordFault]) -> list[RecordFault]:
    """Return one fault for the events of one channel that follow each other without an end."""
    merged: list[RecordFault] = []
    for fault in faults:
        channel = fault.best.event.channel
        place = next(
            (
                i
                for i, f in enumerate(merged)
                if f.best.event.channel == channel and (f.ended is None or f.ended > fault.best.onset.value)
            ),
            None,
        )
        if place is None:
            merged.append(fault)
            continue
        first = merged[place]
        merged[place] = RecordFault(
            replace(fault.best, onset=first.best.onset),
            tuple(o for o in first.others if o.event.channel in {a.event.channel for a in fault.others}),
            first.alarm,
            max(first.statistic, fault.statistic),
            fault.ended,
            (*first.changes, fault.best.event.onset),
        )
    return merged
