"""Commands of a live session → the spec they leave behind and the words for the log."""

import math

from backend.assembly.timeline import changed
from backend.engine.errors import SpecError
from shared import Experiment
from shared.commands import (
    MAX_COMMANDS,
    AddObserver,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    SetSubsteps,
    TimedCommand,
)
from shared.faults import Fault
from shared.session import (
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


def timed(command: object, at: float) -> TimedCommand | None:
    """The timed command that a live one becomes at time ``at``; None for those that change faults."""
    fields = command.model_dump(exclude={"id", "type"}) | {"at": at}
    kinds = {
        SetGainNow: SetGain,
        SetSignalNow: SetSignal,
        SetNoiseNow: SetNoise,
        AddObserverNow: AddObserver,
        RemoveObserverNow: RemoveObserver,
    }
    kind = kinds.get(type(command))
    return None if kind is None else kind.model_validate(fields)


def injected(spec: Experiment, command: Inject, at: float) -> Experiment:
    """The spec with a fault whose onset (and end) were counted from ``at``. Raises SpecError for unknown names."""
    fault = command.fault
    end = None if fault.end is None else at + fault.end
    fault = fault.model_copy(update={"onset": at + fault.onset, "end": end})
    where = "output" if hasattr(fault, "output") else "channel"
    _known(spec, where, f"fault.{where}", getattr(fault, where))
    return spec.model_copy(update={"faults": (*spec.faults, fault)})


def _known(spec: Experiment, where: str, field: str, name: str) -> None:
    """Refuse the name of a channel or an output that the plant does not have."""
    known = spec.plant.names(f"{where}s")
    if name not in known:
        raise SpecError(field, name, f"the plant has no {where} of that name",
                        f"choose from {', '.join(known) or 'none: it has none'}")  # fmt: skip


def cleared(spec: Experiment, command: Clear, at: float) -> Experiment:
    """The spec in which the named faults (all, if none is named) end at ``at``; those still to come are taken out.

    Raises SpecError for unknown names.
    """
    for where in ("channel", "output"):
        if (name := getattr(command, where)) is not None:
            _known(spec, where, where, name)
    everything = command.channel is None and command.output is None
    kept = []
    for fault in spec.faults:
        mine = everything or (
            getattr(fault, "channel", None) == command.channel
            if command.channel is not None
            else getattr(fault, "output", None) == command.output
        )
        if not mine or (fault.end is not None and fault.end <= at):
            kept.append(fault)
        elif fault.onset < at:
            kept.append(fault.model_copy(update={"end": at}))
    return spec.model_copy(update={"faults": tuple(kept)})


def changed_now(spec: Experiment, command: object, at: float, here: Experiment) -> tuple[Experiment, Experiment]:
    """The spec with a timed command noted at its end, and the experiment as it is from ``at`` on; ``here``: as it was."""
    note = timed(command, at)
    if (too_often := spec.too_often(getattr(note, "signal", note))) is not None:
        raise SpecError(*too_often)
    after = changed(here, note)
    rest = [c for c in spec.commands if c.at <= at]
    if isinstance(note, SetGain):  # a slider that is dragged: within one row the last value counts
        rest = [
            c
            for c in rest
            if not (isinstance(c, SetGain) and c.at == at and (c.observer, c.gain) == (note.observer, note.gain))
        ]
    later = [c for c in spec.commands if c.at > at]
    return spec.model_copy(update={"commands": (*rest, note, *later)}), after


def checked(spec: Experiment, before: Experiment) -> Experiment:
    """A spec whose faults or commands differ from those ``before``; figures are not looked at, which they do not concern.

    Raises SpecError, or pydantic.ValidationError.
    """
    if spec.faults is before.faults:  # commands are checked where they are carried out; their order is right
        if len(spec.commands) > MAX_COMMANDS:
            raise SpecError("commands", len(spec.commands), f"an experiment has at most {MAX_COMMANDS} timed commands",
                            "save the session, and go on in another")  # fmt: skip
        return spec
    complete = spec.model_copy(update={"figures": ()}).with_plant(spec.plant)
    return complete.model_copy(update={"figures": spec.figures})


def given_up_from(spec: Experiment, start: Experiment, faults: tuple[Fault, ...], t: float) -> Experiment:
    """The spec without what was done at ``t`` or later: its ``faults`` as they were then, and the commands before."""
    commands = tuple(c for c in spec.commands if c.at < t or c in start.commands)
    return spec.model_copy(update={"faults": faults, "commands": commands})


def scheduled(spec: Experiment, log: list[Event], first: int, last: int, record: float) -> list[Event]:
    """Faults that begin or end, and timed commands that act, by themselves in rows first … last − 1; not those the log tells already."""
    told: dict[tuple[str, str, int], list[object]] = {}  # values
    for e in _since(log, first):
        told.setdefault((e.kind, e.subject, e.row), []).append(e.value)
    found = []
    for command in spec.commands:
        row = math.ceil(command.at / record - 1e-9)
        if first <= row < last and not isinstance(command, SetSubsteps):
            made = event(command, row, row * record)
            if made.value not in told.get((made.kind, made.subject, row), []):
                found.append(made)
    for fault in spec.faults:
        name = getattr(fault, "channel", None) or fault.output
        for kind, when, by_hand in (("fault-begins", fault.onset, ("inject",)), ("fault-ends", fault.end, ("clear",))):
            row = None if when is None else math.ceil(when / record - 1e-9)
            if row is None or not first <= row < last:
                continue
            if not any((hand, subject, row) in told for hand in by_hand for subject in (name, "")):
                word = "begins" if kind == "fault-begins" else "ends"
                text = f"the fault {name} {word}"
                found.append(Event(row=row, t=row * record, kind=kind, subject=name, text=text))
    return found


def _since(log: list[Event], row: int) -> list[Event]:
    """Events of the log from a row on. What was found of late stands behind events of later rows."""
    begin = max(0, len(log) - _LATELY)
    while begin > 0 and log[begin - 1].row >= row:
        begin -= 1
    return [e for e in log[begin:] if e.row >= row]


def without_commands(spec: Experiment, t: float) -> Experiment:
    """The experiment as its timed commands have left it at ``t``, and without them."""
    current = spec.model_copy(update={"commands": ()})
    for command in spec.commands:
        if command.at <= t:
            current = changed(current, command)
    return current


def event(command: object, row: int, t: float, given_up: int = 0) -> Event:
    """What the log says of a command; ``given_up``: faults that were planned and do not come any more."""
    kind, subject, value, text = _told(command)
    if given_up > 0:
        value, text = {"planned": given_up}, f"{text}, and what was planned"
    return Event(row=row, t=t, kind=kind, subject=subject, value=value, text=text)


def _told(command: object) -> tuple[str, str, object, str]:
    match command:
        case Inject(fault=fault):
            name = getattr(fault, "channel", None) or fault.output
            size = getattr(fault, "size", None)
            amount = "" if size is None else f" = {size:g}"
            return "inject", name, fault.model_dump(mode="json"), f"you injected {name}{amount}, {fault.shape}"
        case Clear():
            name = command.channel or command.output or ""
            return "clear", name, None, f"you cleared {name or 'all faults'}"
        case SetGainNow() | SetGain():
            value = list(command.value) if isinstance(command.value, tuple) else command.value
            return "gain", command.observer, {"gain": command.gain, "value": value}, (
                f"{command.observer}: {command.gain} = {value}"
            )  # fmt: skip
        case SetSignalNow() | SetSignal():
            return "signal", command.name, command.signal.model_dump(mode="json"), f"{command.name} changed"
        case SetNoiseNow() | SetNoise():
            return "noise", command.output, command.std, f"noise of {command.output}: σ = {command.std:g}"
        case AddObserverNow() | AddObserver():
            return "observer-added", command.observer.label, command.observer.kind, f"{command.observer.label} added"
        case RemoveObserverNow() | RemoveObserver():
            return "observer-removed", command.label, None, f"{command.label} removed"
    raise TypeError(type(command).__name__)


def new(found: list[Event], log: list[Event]) -> list[Event]:
    """Of what was found those events that are not told yet: rows that waited are looked at again after going back."""
    told = {(e.kind, e.row, e.subject) for e in log[-_LATELY:]}
    return [e for e in found if (e.kind, e.row, e.subject) not in told]
