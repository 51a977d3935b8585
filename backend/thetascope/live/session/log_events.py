"""Events for the log of a live session: commands, and faults and timed commands that take effect."""

import math
from collections.abc import Iterator, Mapping, Sequence

from pydantic import JsonValue

from thetascope.assembly.analyses.record_run import alarms_on_record
from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope.messages import Argument, Message
from thetascope.runs.specs.signal_words import signal_values, signal_words
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.commands import (
    AddObserver,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    SetSubsteps,
    SetTruth,
    TimedCommand,
)
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.measurement import Truth
from thetascope_schemas.service.event import EventKind
from thetascope_schemas.service.session import (
    AddObserverNow,
    Clear,
    Event,
    Inject,
    RemoveObserverNow,
    SetGainNow,
    SetNoiseNow,
    SetSignalNow,
    SetTruthNow,
    SpecCommand,
)

_RECENT = 100  # events


def due_events(spec: ResolvedExperiment, log: Sequence[Event], first: int, last: int, record: float) -> list[Event]:
    """Return the events that the spec has planned for rows first … last − 1, without those that are in the log already.

    Faults that begin or end, and timed commands; `record`: time between rows, s.
    """
    logged: dict[tuple[str, str, int], list[JsonValue]] = {}
    for event in _since(log, first):
        logged.setdefault((event.kind, event.subject, event.row), []).append(event.value)
    events = []
    for command in spec.commands:
        row = math.ceil(command.at / record - 1e-9)
        if first <= row < last and not isinstance(command, SetSubsteps):
            event = command_event(command, row, row * record)
            if event.value not in logged.get((event.kind, event.subject, row), []):
                events.append(event)
    events += _found_in_record(spec, logged, (first, last), record)
    for id, fault in zip(fault_ids(spec.faults), spec.faults, strict=True):
        name = fault.site.name
        for kind, by_hand, row in _edges(fault, record):
            if first <= row < last and not any((by_hand, subject, row) in logged for subject in (name, "")):
                message = Text.of(Message(f"event.{kind}", fault=name))
                events.append(Event(row=row, t=row * record, kind=kind, subject=name, fault=id, message=message))
    return events


def _found_in_record(
    spec: ResolvedExperiment,
    logged: Mapping[tuple[str, str, int], list[JsonValue]],
    rows: tuple[int, int],
    record: float,
) -> Iterator[Event]:
    """Yield the alarms of a record's diagnosis in rows first … last − 1."""
    for alarm in alarms_on_record(spec):
        subject = alarm.channel or alarm.output
        row = math.ceil(alarm.t / record - 1e-9)
        if rows[0] <= row < rows[1] and ("alarm", subject, row) not in logged:
            value = alarm.model_dump(mode="json", exclude={"text"}) | {"estimate": alarm.size, "sigma": None}
            yield Event(
                row=row,
                t=row * record,
                kind="alarm",
                subject=subject,
                observer="detector",
                value=value,
                message=alarm.text,
            )


def _edges(fault: Fault, record: float) -> Iterator[tuple[EventKind, EventKind, int]]:
    """Yield for the onset and the end of a fault: the event's kind, the kind of the command that does the same,
    the row."""
    yield "fault-begins", "inject", math.ceil(fault.onset / record - 1e-9)
    if fault.end is not None:
        yield "fault-ends", "clear", math.ceil(fault.end / record - 1e-9)


def _since(log: Sequence[Event], row: int) -> list[Event]:
    """Return the events of the log from a row on. Alarms that were found late come after events of later rows."""
    begin = max(0, len(log) - _RECENT)
    while begin > 0 and log[begin - 1].row >= row:
        begin -= 1
    return [event for event in log[begin:] if event.row >= row]


def command_event(command: SpecCommand | TimedCommand, row: int, t: float, dropped: int = 0) -> Event:
    """Return the event of a command at a row, t in s; `dropped`: planned faults that a Clear has removed."""
    kind, subject, value, message = _described(command)
    if dropped > 0:
        planned = Text.of(Message("event.cleared-planned", cleared=message))
        return Event(row=row, t=t, kind=kind, subject=subject, value={"planned": dropped}, message=planned)
    return Event(row=row, t=t, kind=kind, subject=subject, value=value, message=Text.of(message))


def _described(command: SpecCommand | TimedCommand) -> tuple[EventKind, str, JsonValue, Message]:
    """Return kind, subject, value and message of a command's event."""
    match command:
        case Inject(fault=fault):
            return "inject", fault.site.name, fault.model_dump(mode="json"), _injected(fault)
        case Clear():
            name = command.channel or command.output or ""
            return "clear", name, None, Message("event.cleared", fault=name) if name else Message("event.cleared-all")
        case SetGainNow() | SetGain():
            gain: dict[str, JsonValue] = command.model_dump(mode="json", include={"gain", "value"})
            message = Message("event.gain", observer=command.observer, gain=command.gain, value=command.value)
            return "gain", command.observer, gain, message
        case SetSignalNow() | SetSignal():
            message = Message("event.signal", signal=command.name, shape=signal_words(command.signal))
            return "signal", command.name, signal_values(command.signal), message
        case SetNoiseNow() | SetNoise():
            message = Message("event.noise", output=command.output, std=command.std)
            return "noise", command.output, command.std, message
        case SetTruthNow() | SetTruth():
            return "truth", "", command.truth.model_dump(mode="json"), _truth(command.truth)
        case AddObserverNow() | AddObserver():
            label = command.observer.label
            return "observer-added", label, command.observer.kind, Message("event.observer-added", observer=label)
        case RemoveObserverNow() | RemoveObserver():
            message = Message("event.observer-removed", observer=command.label)
            return "observer-removed", command.label, None, message
    raise TypeError(type(command).__name__)


def _truth(truth: Truth) -> Message:
    if truth == Truth():
        return Message("event.truth-none")
    if truth == Truth(deviation=truth.deviation):
        return Message("event.truth-deviation", percent=100 * truth.deviation)
    return Message("event.truth")


def _injected(fault: Fault) -> Message:
    args: dict[str, Argument] = {"fault": fault.site.name, "shape": Message(f"fault.shape.{fault.shape}")}
    size = getattr(fault, "size", None)
    return Message("event.injected", **args) if size is None else Message("event.injected-size", **args, size=size)


def unlogged(alarms: Sequence[Event], log: Sequence[Event]) -> list[Event]:
    """Return the alarms that are not in the log yet: after going back, waiting rows are tested again."""
    logged = {(event.kind, event.row, event.subject) for event in log[-_RECENT:]}
    return [event for event in alarms if (event.kind, event.row, event.subject) not in logged]
