"""The diagnosis in one sentence: which message says most about the present verdicts,
from the worst news to the best."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from thetascope.diagnosis.evaluation.verdicts import AlarmLike, AlarmVerdict, Judgement, Presence
from thetascope.messages import Message


@dataclass(frozen=True)
class Situation:
    """Everything that the sentence depends on, at time t (s).

    Attributes:
        alarms: of the detector, in order of time; they also have `size`, `size_from`, `size_to` and `onset`.
        judgement: the verdicts on them; None without a detector.
        note: why there is no diagnosis; empty if there is one.
        settled: time in s before which nothing is judged.
        hidden: channels of which not even a typical fault can be found with this input.
        kinds: channel → "actuator", "process" or "sensor".
        observers: how many run.
        lost: (label, time in s) of those that diverged.
        broken: time in s at which the plant itself diverged.
        judged: time in s up to which the detector has judged, while it is behind; None: up to t.
    """

    t: float
    alarms: Sequence[AlarmLike]
    judgement: Judgement | None
    note: Message | str = ""
    settled: float = 0.0
    hidden: frozenset[str] = frozenset()
    kinds: Mapping[str, str] | None = None
    observers: int = 0
    lost: Sequence[tuple[str, float]] = ()
    broken: float | None = None
    judged: float | None = None


def summary(now: Situation) -> Message:
    """Return the message that sums up a situation."""
    if now.broken is not None:
        return _say("broken", at=_time(now.broken))
    if now.judgement is None or now.note:
        return _say("no-diagnosis", note=now.note)
    pairs = list(zip(now.alarms, now.judgement.alarms, strict=True))
    good = [(alarm, verdict) for alarm, verdict in pairs if verdict.state in ("acting", "covering")]
    wrong = _wrong(pairs, good, now.judgement.undetected)
    if wrong is not None:
        return wrong
    either = [alarm for alarm, _ in good if alarm.alternatives]
    if either:
        return _say("either", names=(either[-1].channel, *either[-1].alternatives))
    if now.judgement.undetected:
        return _undetected(now.judgement.undetected, len(good), now.hidden, now.judged)
    if good:
        return _found(good, now.kinds or {})
    return _quiet(now, [verdict.state for _, verdict in pairs])


def _wrong(
    pairs: Sequence[tuple[AlarmLike, AlarmVerdict]],
    good: Sequence[tuple[AlarmLike, AlarmVerdict]],
    undetected: Sequence[Presence],
) -> Message | None:
    """Return the message about an alarm that the model does not explain, or that names another fault, or none."""
    for alarm, verdict in pairs:
        if alarm.kind == "unexplained" and verdict.state not in ("cleared", "fault-over"):
            return _say("unexplained", name=_subject(alarm))
    wrong = [alarm for alarm, verdict in pairs if verdict.state == "other-fault"]
    real = [(p.name, p.kind) for p in undetected] or [(_subject(alarm), "channel") for alarm, _ in good]
    if wrong and real:
        name, kind = real[0]
        return _say(
            "misattributed" if kind == "channel" else "misattributed-for-output", name=_subject(wrong[0]), other=name
        )
    false = [alarm for alarm, verdict in pairs if verdict.state == "no-fault"]
    return _say("false-alarm", name=_subject(false[0])) if false else None


def _undetected(undetected: Sequence[Presence], found: int, hidden: frozenset[str], judged: float | None) -> Message:
    """Return the message about faults that act and that no alarm names."""
    if judged is not None and all(p.onset >= judged for p in undetected):
        if found:
            return _say("not-judged-beside", n=found, name=undetected[0].name)
        return _say("not-judged", n=len(undetected))
    first = next((p for p in undetected if p.kind == "channel"), undetected[0])
    if first.kind == "output":
        return _say("measurement", name=first.name)
    if first.name in hidden:
        return _say("hidden-beside", n=found, name=first.name) if found else _say("hidden", name=first.name)
    return _say("looking-beside", n=found, name=first.name) if found else _say("looking", n=len(undetected))


def _found(good: Sequence[tuple[AlarmLike, AlarmVerdict]], kinds: Mapping[str, str]) -> Message:
    """Return the message about faults that are all identified."""
    if len(good) == 1:
        alarm, verdict = good[0]
        about: dict[str, Any] = {
            "fault": Message(f"diagnosis.fault.{kinds.get(alarm.channel, 'process')}", name=alarm.channel),
            "size": _amount(alarm),
            "since": _time(alarm.onset),
        }
        if verdict.state == "covering":
            return _say("one-again", **about, name=alarm.channel, again=_time(verdict.covers_since or 0.0))
        return _say("one", **about) if verdict.delay is None else _say("one-found", **about, took=_span(verdict.delay))
    timed = [(alarm, verdict.delay) for alarm, verdict in good if verdict.delay is not None]
    both = "two-" if len(good) == 2 else ""
    if not timed:
        return _say(f"{both}identified", n=len(good))
    alarm, delay = timed[-1]
    return _say(f"{both}identified-found", n=len(good), name=alarm.channel, took=_span(delay))


def _quiet(now: Situation, states: Sequence[str]) -> Message:
    """Return the message for a time at which nothing acts."""
    if "fault-over" in states:
        return _say("ending")
    if now.lost:
        label, at = now.lost[-1]
        if len(now.lost) == now.observers:
            return (
                _say("lost-only", label=label, at=_time(at))
                if now.observers == 1
                else _say("lost-all", n=now.observers)
            )
        return _say("lost-one", label=label, at=_time(at)) if len(now.lost) == 1 else _say("lost-some", n=len(now.lost))
    if states:
        return _say("quiet-again")
    return _say("early", since=_time(now.settled)) if now.settled > now.t else _say("quiet")


def _say(key: str, **args: Any) -> Message:
    return Message(f"diagnosis.summary.{key}", **args)


def _subject(alarm: AlarmLike) -> str:
    return alarm.channel or alarm.output.removeprefix("y.")


def _time(t: float) -> Message:
    return Message("diagnosis.time", t=t)


def _span(seconds: float) -> Message:
    return Message("diagnosis.duration", t=seconds)


def _amount(alarm: AlarmLike) -> Message:
    """Return the size of a fault with half the width of its interval."""
    size, low, high = alarm.size, alarm.size_from, alarm.size_to
    half = None if low is None or high is None else (high - low) / 2
    return Message("diagnosis.amount", name=alarm.channel, size=size, half=half)
