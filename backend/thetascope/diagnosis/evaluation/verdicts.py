"""Verdicts: which faults an alarm found, and which it missed. This is the only definition; all others show its results.

A fault is *present* from its onset to its end. On an output that is all. In a channel it is present between two
consecutive events (onset or end of any fault of that channel) unless the true θ is zero throughout: two steps that
cancel are not a fault. An alarm carries the time t at which it was raised and, for the time at which its fault began,
the interval from `onset_from` to `onset_to`.

**Naming.** An alarm names a fault if its channel is the fault's (first choice) or one of its alternatives is. A fault
for which the observer has no channel, above all one on a measurement, is named by an alarm "not explained by the
model" whose output is the fault's, or that has no output.

**Found.** A fault is found by the first alarm that names it, is raised at the onset or later, and refers to it: it is
raised before the fault is over, or the interval for its onset begins before that. The delay is t − onset.

    A fault lasts from 20 s to 25 s; an alarm raised at 26 s puts the onset at 20.1 s. The fault is found, 6 s late. A
    window test needs samples, so an alarm for a short fault often comes after the fault; what an engineer asks is
    "was there a fault, when and where?", and the alarm answers this correctly. The delay says that it was late. To
    count the alarm as false and the fault as missed would punish it twice for a correct answer. An alarm at 26 s that
    puts the onset after 25 s does not refer to this fault: the fault is missed.

**Covered.** If no alarm finds the fault, but one that has the fault's channel as its first choice was raised before
the onset and is still on then, the fault is covered, neither found nor missed: the alarm for that channel is already
on, so that a detector cannot raise it.

    An alarm on since 10 s names channel a; it has b as an alternative only. A fault in b begins at 20 s. It is not
    covered: the alternatives say which causes an *earlier* change may have had. There is no alarm for b, so a detector
    can raise one, and an operator who sees none learns nothing about the new fault. Otherwise a detector that lists
    all channels as alternatives would never miss a fault. For the same reason an alarm raised *after* the onset that
    has b as an alternative does find the fault: then the new fault is one of the causes that it offers.

**Missed.** A fault neither found nor covered. While the fault is still present this reads "not found yet".

**False alarm, isolation error.** An alarm is false if no fault was present in the time to which it refers, from
`onset_from` to t, nor within the grace before t, which estimates need to return after a fault. If there was one and
the alarm names none, it is an isolation error. All other alarms are correct, and so is every alarm that found a fault.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, Protocol

import numpy as np

from thetascope.diagnosis.evaluation.instants import earlier
from thetascope.diagnosis.evaluation.metrics import FaultOverTime, event_times

Outcome = Literal["found", "covered", "missed"]
FOUND, COVERED, MISSED = "found", "covered", "missed"
Verdict = Literal["correct", "isolation-error", "false"]
CORRECT, ISOLATION_ERROR, FALSE = "correct", "isolation-error", "false"
State = Literal["acting", "covering", "other-fault", "no-fault", "fault-over", "cleared"]
"""Seconds by which times of the same row may differ."""

Nonzero = Callable[[str, float, float], bool]
"""Whether the true θ of a channel is nonzero at some row of [start, end), or has no row there."""


class AlarmLike(Protocol):
    """An alarm of any detector: the schema's `Alarm`, or anything of that shape."""

    @property
    def id(self) -> str:
        """Its id."""
        ...

    @property
    def t(self) -> float:
        """Time in s at which it was raised."""
        ...

    @property
    def kind(self) -> str:
        """ "fault", or "unexplained"."""
        ...

    @property
    def channel(self) -> str:
        """The channel that it names first; "" for none."""
        ...

    @property
    def output(self) -> str:
        """The output that it concerns; "" for none."""
        ...

    @property
    def alternatives(self) -> Sequence[str]:
        """Channels that could explain it too."""
        ...

    @property
    def onset(self) -> float:
        """Estimated onset in s."""
        ...

    @property
    def onset_from(self) -> float:
        """Earliest onset in s that the data permit."""
        ...

    @property
    def size(self) -> float | None:
        """Estimated size; None where none was estimated."""
        ...

    @property
    def size_from(self) -> float | None:
        """Lower end of the size's interval."""
        ...

    @property
    def size_to(self) -> float | None:
        """Upper end of the size's interval."""
        ...

    @property
    def cleared(self) -> float | None:
        """Time in s at which it ended; None: it is still on."""
        ...


@dataclass(frozen=True)
class Presence:
    """The time [onset, until) in which a fault is present; `until` is infinite while it stays.

    Attributes:
        ids: of the faults that act then (`fault_ids`), first the one that began there.
        kind: "channel" or "output".
        name: of the channel or output.
    """

    ids: tuple[str, ...]
    kind: str
    name: str
    onset: float
    until: float


@dataclass(frozen=True)
class FaultVerdict:
    """The outcome for one fault.

    Attributes:
        id: of the fault (`fault_ids`).
        kind, name: its site.
        onset: in s.
        until: in s, the end of the time in which it is present; None: it stays.
        outcome: found, covered or missed.
        delay: seconds from onset to alarm; None unless found.
        alternative: whether the alarm that found it has it as an alternative only.
        alarm: id of the alarm that found or covers it; empty for a missed fault.
    """

    id: str
    kind: str
    name: str
    onset: float
    until: float | None
    outcome: Outcome
    delay: float | None = None
    alternative: bool = False
    alarm: str = ""


@dataclass(frozen=True)
class AlarmVerdict:
    """The verdict on one alarm, and its state at the time of judging.

    Attributes:
        id: of the alarm.
        verdict: correct, isolation-error or false: as it was raised, whatever happens later.
        state: at the time of judging. cleared: the alarm is over. While it is on, acting: a fault that it names acts;
            covering: the fault that acts began later and is covered; other-fault: another fault than those named acts;
            fault-over: the fault has ended, and the alarm is about to clear; no-fault: none acted (a false alarm).
        found: ids of the faults that it was the first to find.
        delay: seconds from the newest of these to the alarm; None if it found none.
        covers_since: onset of the newest fault that it covers and that still acts; None if it covers none.
    """

    id: str
    verdict: Verdict
    state: State
    found: tuple[str, ...] = ()
    delay: float | None = None
    covers_since: float | None = None


@dataclass(frozen=True)
class Judgement:
    """All verdicts on one detector, in order of time.

    `undetected`: of the faults that act at the time of judging those that no alarm that is on names,
    the newest of each site.
    """

    faults: tuple[FaultVerdict, ...]
    alarms: tuple[AlarmVerdict, ...]
    undetected: tuple[Presence, ...] = ()

    def count(self, verdict: str) -> int:
        """Return how many faults have this outcome, or alarms this verdict."""
        return sum(f.outcome == verdict for f in self.faults) + sum(a.verdict == verdict for a in self.alarms)


# ---- faults ----------------------------------------------------------------------------------------------------------


def fault_ids(faults: Sequence[FaultOverTime]) -> tuple[str, ...]:
    """Return an id for each fault: its site and onset, as in `theta3@20.0`; equal ones are counted (`theta3@20.0#2`).

    Neither changes while a session runs (clearing sets the end only), so that the id stays, and the run of the
    session's spec has the same.
    """
    ids: list[str] = []
    for fault in faults:
        id = base = f"{fault.site.name}@{float(fault.onset)!r}"
        number = 1
        while id in ids:
            number += 1
            id = f"{base}#{number}"
        ids.append(id)
    return tuple(ids)


def presences(faults: Sequence[FaultOverTime], horizon: float, nonzero: Nonzero) -> tuple[Presence, ...]:
    """Return when each fault with an onset before `horizon` (s) is present, in order of time.

    An end at the horizon or later counts as none. `nonzero` tells whether θ of a channel differs from zero.
    """
    known = list(zip(fault_ids(faults), faults, strict=True))
    channels = sorted({f.site.name for f in faults if f.site.kind == "channel"})
    found = [
        Presence((id,), f.site.kind, f.site.name, f.onset, _end(f, horizon))
        for id, f in known
        if f.site.kind == "output"
    ]
    for name in channels:
        mine = [(id, f) for id, f in known if (f.site.kind, f.site.name) == ("channel", name)]
        edges = [at for at in event_times([f for _, f in mine]) if at < horizon] + [np.inf]
        for start, end in pairwise(edges):
            acting = [(f.onset != start, id) for id, f in mine if f.onset <= start < _end(f, horizon)]
            if acting and nonzero(name, float(start), min(float(end), horizon)):
                ids = tuple(id for _, id in sorted(acting, key=lambda one: one[0]))
                found.append(Presence(ids, "channel", name, float(start), float(end)))
    return tuple(sorted((p for p in found if p.onset < horizon), key=lambda p: (p.onset, p.kind, p.name)))


def _end(fault: FaultOverTime, horizon: float) -> float:
    return np.inf if fault.end is None or fault.end >= horizon else float(fault.end)


def faults_to_find(faults: Sequence[FaultOverTime], present: Sequence[Presence]) -> list[Presence]:
    """Return the presences that begin with the onset of a fault, each once: the faults that a detector should find.

    A fault on an output is to be found before the next one on that output begins.
    """
    begun = {(f.site.kind, f.site.name, f.onset) for f in faults}
    found: dict[tuple[str, str, float], Presence] = {}
    for p in present:
        site = (p.kind, p.name)
        if (*site, p.onset) in begun and (*site, p.onset) not in found:
            later = [onset for kind, name, onset in begun if (kind, name) == site and onset > p.onset]
            found[*site, p.onset] = Presence(p.ids, *site, p.onset, min([p.until, *later]))
    return list(found.values())


# ---- alarms against faults -------------------------------------------------------------------------------------------


def naming(alarm: AlarmLike, fault: Presence, own: set[str]) -> Literal["first", "alternative", ""]:
    """Return how an alarm names a fault: as its first choice, as an alternative, or not at all ("").

    own: the channels that the observer estimates.
    """
    if fault.kind == "channel" and fault.name in own:
        if alarm.channel == fault.name:
            return "first"
        return "alternative" if fault.name in alarm.alternatives else ""
    if alarm.kind != "unexplained":
        return ""
    return "first" if fault.kind == "channel" or _output(alarm) in ("", fault.name) else ""


def _output(alarm: AlarmLike) -> str:
    return alarm.output.removeprefix("y.")


def fault_verdict(alarms: Sequence[AlarmLike], fault: Presence, own: set[str]) -> FaultVerdict:
    """Return the outcome for one fault; `alarms` in order of time."""
    until = fault.until if np.isfinite(fault.until) else None
    about = (fault.ids[0], fault.kind, fault.name, fault.onset, until)
    covering = ""
    for alarm in alarms:
        how = naming(alarm, fault, own)
        if earlier(alarm.t, fault.onset):
            if how == "first" and (alarm.cleared is None or earlier(fault.onset, alarm.cleared)):
                covering = alarm.id
        elif how and earlier(min(alarm.t, alarm.onset_from), fault.until):
            delay = max(0.0, float(alarm.t - fault.onset))
            return FaultVerdict(*about, FOUND, delay, how == "alternative", alarm.id)
    return FaultVerdict(*about, COVERED if covering else MISSED, alarm=covering)


def alarm_verdict(alarm: AlarmLike, present: Sequence[Presence], own: set[str], grace: float) -> Verdict:
    """Return whether an alarm is correct, an isolation error or false; `grace` in s."""
    related = related_faults(alarm, present, grace)
    if not related:
        return FALSE
    return CORRECT if any(naming(alarm, p, own) for p in related) else ISOLATION_ERROR


def related_faults(alarm: AlarmLike, present: Sequence[Presence], grace: float) -> list[Presence]:
    """Return the faults that were present in the time to which an alarm refers, or within the grace (s) before it."""
    begin = min(alarm.t - grace, alarm.onset_from)
    return [p for p in present if not earlier(alarm.t, p.onset) and not earlier(p.until, begin)]


def judge(
    alarms: Iterable[AlarmLike],
    faults: Sequence[FaultOverTime],
    present: Sequence[Presence],
    own: set[str],
    grace: float,
) -> Judgement:
    """Return the verdicts on all faults and alarms, as they are at the horizon of `present`.

    Args:
        alarms: of one observer or of the detector, up to the time of judging.
        faults: of the experiment.
        present: their `presences` up to the time of judging.
        own: names of the channels that the observer estimates; of the detector, all channels.
        grace: seconds after a fault in which an alarm is not false.
    """
    ordered = sorted(alarms, key=lambda alarm: alarm.t)
    outcomes = tuple(fault_verdict(ordered, fault, own) for fault in faults_to_find(faults, present))
    acting = [p for p in present if np.isinf(p.until)]
    ids = frozenset(id for p in acting for id in p.ids)
    verdicts = tuple(_alarm(alarm, outcomes, present, ids, own, grace) for alarm in ordered)
    undetected = [p for p in acting if not any(_seen(p, a, present, own, grace) for a in ordered)]
    newest = {(p.kind, p.name): p for p in undetected}
    return Judgement(outcomes, verdicts, tuple(newest.values()))


def _seen(fault: Presence, alarm: AlarmLike, present: Sequence[Presence], own: set[str], grace: float) -> bool:
    """Return whether an alarm that is on names a fault that acts, or covers it."""
    if alarm.cleared is not None or not (how := naming(alarm, fault, own)):
        return False
    if earlier(alarm.t, fault.onset) and how == "first":
        return True
    return any(not set(fault.ids).isdisjoint(p.ids) for p in related_faults(alarm, present, grace))


def _alarm(
    alarm: AlarmLike,
    outcomes: Sequence[FaultVerdict],
    present: Sequence[Presence],
    acting: frozenset[str],
    own: set[str],
    grace: float,
) -> AlarmVerdict:
    """Return the verdict on an alarm; `acting`: ids of the faults that act at the time of judging."""
    mine = [f for f in outcomes if f.alarm == alarm.id]
    found = [f for f in mine if f.outcome == FOUND]
    covered = [f for f in mine if f.outcome == COVERED and f.until is None]
    verdict = alarm_verdict(alarm, present, own, grace)
    related = related_faults(alarm, present, grace)
    state: State
    if alarm.cleared is not None:
        state = "cleared"
    elif any(naming(alarm, p, own) and not acting.isdisjoint(p.ids) for p in related):
        state = "acting"
    elif covered:
        state = "covering"
    elif verdict == FALSE:
        state = "no-fault"
    else:
        state = "fault-over" if all(acting.isdisjoint(p.ids) for p in related) else "other-fault"
    return AlarmVerdict(
        alarm.id,
        verdict,
        state,
        tuple(f.id for f in found),
        found[-1].delay if found else None,
        covered[-1].onset if covered else None,
    )
