"""What the log of a live session tells: commands, faults and what was found, as events."""

import math

from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.commands import (
    AddObserver,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    SetSubsteps,
)
from thetascope_schemas.service.session import (
    AddObserverNow,
    Clear,
    Event,
    Inject,
    RemoveObserverNow,
    SetGainNow,
    SetNoiseNow,
    SetSignalNow,
)

_LATELY = 100  # events


def due_events(spec: Experiment, log: list[Event], first: int, last: int, record: float) -> list[Event]:
    """Faults that begin or end, and timed commands that act, by themselves in rows first … last − 1; not those the log tells already."""
    told: dict[tuple[str, str, int], list[object]] = {}  # values
    for e in _since(log, first):
        told.setdefault((e.kind, e.subject, e.row), []).append(e.value)
    found = []
    for command in spec.commands:
        row = math.ceil(command.at / record - 1e-9)
        if first <= row < last and not isinstance(command, SetSubsteps):
            made = command_event(command, row, row * record)
            if made.value not in told.get((made.kind, made.subject, row), []):
                found.append(made)
    for id, fault in zip(fault_ids(spec.faults), spec.faults, strict=True):
        name = fault.site.name
        for kind, when, by_hand in (("fault-begins", fault.onset, ("inject",)), ("fault-ends", fault.end, ("clear",))):
            row = None if when is None else math.ceil(when / record - 1e-9)
            if row is None or not first <= row < last:
                continue
            if not any((hand, subject, row) in told for hand in by_hand for subject in (name, "")):
                word = "begins" if kind == "fault-begins" else "ends"
                text = f"the fault {name} {word}"
                found.append(Event(row=row, t=row * record, kind=kind, subject=name, fault=id, text=text))
    return found


def _since(log: list[Event], row: int) -> list[Event]:
    """Events of the log from a row on. What was found of late stands behind events of later rows."""
    begin = max(0, len(log) - _LATELY)
    while begin > 0 and log[begin - 1].row >= row:
        begin -= 1
    return [e for e in log[begin:] if e.row >= row]


def command_event(command: object, row: int, t: float, given_up: int = 0) -> Event:
    """What the log says of a command; ``given_up``: faults that were planned and do not come any more."""
    kind, subject, value, text = _told(command)
    if given_up > 0:
        value, text = {"planned": given_up}, f"{text}, and what was planned"
    return Event(row=row, t=t, kind=kind, subject=subject, value=value, text=text)


def _told(command: object) -> tuple[str, str, object, str]:
    match command:
        case Inject(fault=fault):
            name = fault.site.name
            size = getattr(fault, "size", None)
            amount = "" if size is None else f" = {size:g}"
            return "inject", name, fault.model_dump(mode="json"), f"you injected {name}{amount}, {fault.shape}"
        case Clear():
            name = command.channel or command.output or ""
            return "clear", name, None, f"you cleared {name or 'all faults'}"
        case SetGainNow() | SetGain():
            value = list(command.value) if isinstance(command.value, tuple) else command.value
            return (
                "gain",
                command.observer,
                {"gain": command.gain, "value": value},
                (f"{command.observer}: {command.gain} = {value}"),
            )
        case SetSignalNow() | SetSignal():
            return "signal", command.name, command.signal.model_dump(mode="json"), f"{command.name} changed"
        case SetNoiseNow() | SetNoise():
            return "noise", command.output, command.std, f"noise of {command.output}: σ = {command.std:g}"
        case AddObserverNow() | AddObserver():
            return "observer-added", command.observer.label, command.observer.kind, f"{command.observer.label} added"
        case RemoveObserverNow() | RemoveObserver():
            return "observer-removed", command.label, None, f"{command.label} removed"
    raise TypeError(type(command).__name__)


def unseen(found: list[Event], log: list[Event]) -> list[Event]:
    """Of what was found those events that are not told yet: rows that waited are looked at again after going back."""
    told = {(e.kind, e.row, e.subject) for e in log[-_LATELY:]}
    return [e for e in found if (e.kind, e.row, e.subject) not in told]
