"""The detector's answer to a challenge, on the same record and with the same suspects."""

from thetascope.assembly import prepare
from thetascope.challenge.draw import Drawn
from thetascope.challenge.experiments import experiment_of
from thetascope_schemas.experiment.diagnosis import Alarm, Diagnosis
from thetascope_schemas.service.learning.challenge import MOST_ACCUSATIONS, Accusation, ChallengeAnswer

_CHECKS = 12  # times after its first alarm at which its findings are looked at
_GROWTH = 1.6  # of the time from one of them to the next, which begins with one row


def detector_answer(drawn: Drawn) -> ChallengeAnswer | None:
    """Return what the detector finds by the end of the record, and since when; None where it explains nothing.

    It revises its findings as readings arrive. Its answer is given at the first time from which it keeps to the last
    one; channels that it named alone at other times are accusations. Takes about a second of processor time.
    """
    end = drawn.setup.horizon
    final = _alarms(drawn, None)
    if not final:
        return ChallengeAnswer(verdict="none", at=end)
    active = [alarm for alarm in final if alarm.kind == "fault" and alarm.cleared is None]
    if not active:
        return None
    answer = active[0]
    named, since = _named(answer), end
    accused = {alarm.channel: alarm.t for alarm in final if alarm.kind == "fault" and alarm.channel not in named}
    kept = True
    for t in reversed(_times(drawn, min(alarm.t for alarm in final))):
        then = [alarm for alarm in _alarms(drawn, t) if alarm.kind == "fault" and alarm.cleared is None]
        kept = kept and bool(then) and _named(then[0]) == named
        since = t if kept else since
        accused |= {a.channel: t for a in then if not a.alternatives and a.channel not in named}
    blamed = tuple(Accusation(channel=channel, at=t) for channel, t in accused.items())[:MOST_ACCUSATIONS]
    if len(named) > 1:
        return ChallengeAnswer(
            verdict="cannot-be-told", alike=tuple(sorted(named)), onset=answer.onset, at=since, accused=blamed
        )
    return ChallengeAnswer(
        verdict="channel", channel=answer.channel, onset=answer.onset, size=answer.size, at=since, accused=blamed
    )


def _named(alarm: Alarm) -> frozenset[str]:
    return frozenset({alarm.channel, *alarm.alternatives})


def _times(drawn: Drawn, first: float) -> list[float]:
    """Return the times at which the findings are looked at, more of them soon after the first alarm."""
    setup, times, rows = drawn.setup, [], 0.0
    step = 1.0
    while len(times) < _CHECKS and (t := first + round(rows) * setup.record) < setup.horizon:
        times.append(t)
        rows, step = rows + step, step * _GROWTH
    return times


def _alarms(drawn: Drawn, end: float | None) -> tuple[Alarm, ...]:
    """Return the detector's findings in the record up to a time; None: in all of it."""
    setup = drawn.setup
    whole = None if end is None else max(1, round(end / setup.record)) * setup.record
    spec = experiment_of(setup, drawn.program, drawn.fault, drawn.seed, diagnosis=True, end=whole)
    result = prepare(spec).run()
    return Diagnosis.model_validate(result.diagnosis).detector.alarms if result.diagnosis else ()
