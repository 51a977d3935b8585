"""The facts of a live session at the row that is shown, by the functions that runs use."""

import math
from typing import TYPE_CHECKING

import numpy as np

from thetascope.assembly.analyses.facts import DetectorState, Losses, facts
from thetascope.assembly.analyses.record_run import alarms_on_record
from thetascope.diagnosis.evaluation.verdicts import Judgement, judge, presences
from thetascope.diagnosis.isolation.decision_state import Finding
from thetascope.diagnosis.sentences import joined
from thetascope.engine.inputs.signals import Signal
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.diagnosis import Alarm, ObserverDiagnosis
from thetascope_schemas.service.facts import Facts

if TYPE_CHECKING:
    from thetascope.live.session.session import Session

_EARLY = 1e-3  # of a row: times that differ by rounding only are the same
_CHUNK = 64  # rows of θ that are looked at first


def facts_of(session: "Session", row: int, memory: "FactsMemory", diagnosis: ObserverDiagnosis | None = None) -> Facts:
    """Return the facts of a session of which rows 0 … row − 1 have been shown.

    A fault or a command acts from the next row on: commands given while time is paused count. `diagnosis` is the
    newest report of the detector.
    """
    t = max(0, row - 1) * session.record
    return facts_with(_present_alarms(session, t, memory), session, row, memory, diagnosis)


def facts_with(
    alarms: tuple[Alarm, ...],
    session: "Session",
    row: int,
    memory: "FactsMemory",
    diagnosis: ObserverDiagnosis | None = None,
) -> Facts:
    """Return the facts when rows 0 … row − 1 have been shown, with these alarms of the detector."""
    t = max(0, row - 1) * session.record
    at = time_of_next_row(session.record, row)
    known = facts(session.spec, t, at, _detector_state(alarms, session, at, memory, diagnosis), losses(session, row))
    return known if session.spec.truth.record is None else _of_record(known, session.spec)


def _of_record(known: Facts, spec: ResolvedExperiment) -> Facts:
    """Return facts with the alarms that the diagnosis of the whole record has raised by then."""
    alarms = tuple(alarm for alarm in alarms_on_record(spec) if alarm.t <= known.t)
    if alarms:
        found = [Message.from_data(alarm.text.model_dump()) for alarm in alarms]
        summary = Message("record.summary.faults", faults=joined(found))
    else:
        summary = Message("record.summary.none", end=known.t)
    return known.model_copy(update={"alarms": alarms, "summary": Text.of(summary)})


def time_of_next_row(record: float, row: int) -> float:
    """Return the time in s at which faults and commands count as acting when rows 0 … row − 1 have been shown."""
    return (max(1, row) + _EARLY) * record


def _present_alarms(session: "Session", t: float, memory: "FactsMemory") -> tuple[Alarm, ...]:
    """Return the detector's alarms up to t (s)."""
    alarms = session.detector.alarms(session.current.detection, t, memory.alarms)
    if session.pending_detection() is not None:
        alarms = _with_logged(session, alarms, t, memory)
    memory.latest = {alarm.id: alarm for alarm in alarms}
    return alarms


def _detector_state(
    alarms: tuple[Alarm, ...],
    session: "Session",
    at: float,
    memory: "FactsMemory",
    diagnosis: ObserverDiagnosis | None,
) -> DetectorState:
    """Return the detector's alarms, judged against the faults with an onset before `at` (s)."""
    live = session.detector
    if live.detector is None:
        return DetectorState(note=live.note)
    settled = max(float(live.detector.thresholds.begin * live.detector.interval), 0.0)
    judgement = _judged(session, alarms, at, memory, settled)
    return DetectorState(alarms, judgement, diagnosis, settled, None, judged_until(session, at - session.record))


def judged_until(session: "Session", t: float) -> float | None:
    """Return the time in s up to which the detector has judged, if it is a decision or more behind at t (s)."""
    return session.detector.judged_until(session.current.detection, t)


def _with_logged(session: "Session", alarms: tuple[Alarm, ...], t: float, memory: "FactsMemory") -> tuple[Alarm, ...]:
    """Return alarms up to t (s) with those of the log that the detector has yet to find again.

    A command takes the detector back to an earlier row; the rows since then wait, and the log still has their alarms.
    """
    known = {alarm.id for alarm in alarms}
    logged = [event.value for event in session.log if event.kind == "alarm" and event.t <= t]
    ids = dict.fromkeys(str(value["id"]) for value in logged if isinstance(value, dict) and value.get("id"))
    missing = [memory.latest[id] for id in ids if id not in known and id in memory.latest]
    return tuple(sorted((*alarms, *missing), key=lambda alarm: alarm.t))


def _judged(session: "Session", alarms: tuple[Alarm, ...], at: float, memory: "FactsMemory", grace: float) -> Judgement:
    def nonzero(channel: str, start: float, end: float) -> bool:
        return memory.nonzero(session.experiment.signals[f"theta.{channel}"], channel, start, end)

    faults = session.spec.faults
    channels = {channel.name for channel in session.spec.plant.channels}
    return judge(alarms, faults, presences(faults, at, nonzero), channels, grace)


def losses(session: "Session", row: int) -> Losses:
    """Return which observers have diverged in the rows before `row`, and whether the plant has."""
    lost = [event for event in session.log if event.kind == "diverged" and event.row < row]
    plant = next((event.t for event in lost if event.subject == ""), None)
    causes: dict[str, tuple[float, Message]] = {}
    for event in lost:
        cause = event.message.args.get("cause")
        if event.subject and isinstance(cause, dict):
            causes[event.subject] = event.t, Message.from_data(cause)
    return Losses(causes, plant)


class FactsMemory:
    """Results kept between two calls: alarms by their findings, the latest alarms by id,
    and in which stretches of rows the true θ is not zero."""

    def __init__(self, record: float) -> None:
        self._record = record
        self.alarms: dict[int, tuple[Finding, Alarm]] = {}
        self.latest: dict[str, Alarm] = {}  # of the facts made last, by id
        self._known: dict[tuple[str, float], tuple[Signal, int, bool]] = {}  # signal, rows looked at, result

    def nonzero(self, signal: Signal, channel: str, start: float, end: float) -> bool:
        """Return whether θ of a channel is nonzero at some row of [start, end) in s, or has no row there."""
        first, last = (math.ceil(time / self._record - 1e-6) for time in (start, end))
        if last <= first:
            return True
        known, row, found = self._known.get((channel, start), (signal, first, False))
        if known is not signal:
            row, found = first, False
        size = _CHUNK
        while not found and row < last:
            rows = np.arange(row, min(row + size, last)) * self._record
            found = bool(np.any(signal(rows, rows)))
            row, size = row + len(rows), 4 * size
        self._known[channel, start] = signal, row, found
        return found
