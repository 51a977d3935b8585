"""The facts of a live session as they were at an earlier row: with the alarms that had been raised by then.

An alarm is shown as the log has it: with the size and the channel of its newest event by then. What the detector has
learnt of it since is not used.
"""

from typing import TYPE_CHECKING

from thetascope.live.facts.session_facts import FactsMemory, facts_with
from thetascope_schemas.experiment.diagnosis import Alarm, ObserverDiagnosis
from thetascope_schemas.service.facts import Facts

if TYPE_CHECKING:
    from thetascope.live.session.session import Session

_OF_EVENTS = ("estimate", "sigma")  # what an event has beside its alarm


def past_facts(session: "Session", row: int, diagnosis: ObserverDiagnosis | None = None) -> Facts:
    """Return the facts when rows 0 … row − 1 had been shown; `diagnosis`: the newest report of the detector."""
    t = max(0, row - 1) * session.record
    return facts_with(alarms_by(session, t), session, row, FactsMemory(session.record), diagnosis)


def alarms_by(session: "Session", t: float) -> tuple[Alarm, ...]:
    """Return the alarms raised up to t (s), each as it was at that time, in order of time."""
    alarms: dict[str, Alarm] = {}
    for event in sorted(session.log, key=lambda event: event.row):
        if event.t > t + session.record / 2 or not isinstance(event.value, dict):
            continue
        if event.kind in ("alarm", "alarm-over"):
            known = alarms.get(str(event.value["id"]))
            text = known.text if known is not None and event.kind == "alarm-over" else event.message
            fields = {name: value for name, value in event.value.items() if name not in _OF_EVENTS}
            alarms[str(event.value["id"])] = Alarm.model_validate({**fields, "text": text})
    return tuple(sorted(alarms.values(), key=lambda alarm: alarm.t))
