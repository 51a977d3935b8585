"""Commands of a live session → the spec after them."""

from thetascope.assembly.build.timed_commands import after_commands, changed
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import MAX_POINTS
from thetascope_schemas.experiment.commands import (
    MAX_COMMANDS,
    AddObserver,
    OfTruth,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    SetTruth,
    TimedCommand,
    points_in,
)
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.figures import MAX_NOTES, Note
from thetascope_schemas.service.session import (
    AddObserverNow,
    Clear,
    Inject,
    RemoveObserverNow,
    SetGainNow,
    SetNoiseNow,
    SetSignalNow,
    SetTruthNow,
)

TimedNow = SetGainNow | SetSignalNow | SetNoiseNow | SetTruthNow | AddObserverNow | RemoveObserverNow
"""The live commands that have a timed form."""

_TIMED: dict[type[TimedNow], type[TimedCommand]] = {
    SetGainNow: SetGain,
    SetSignalNow: SetSignal,
    SetNoiseNow: SetNoise,
    SetTruthNow: SetTruth,
    AddObserverNow: AddObserver,
    RemoveObserverNow: RemoveObserver,
}


def timed_command_of(command: TimedNow, at: float) -> TimedCommand:
    """Return the timed form of a live command, at time `at` in s."""
    return _TIMED[type(command)].model_validate(command.model_dump(exclude={"id", "type"}) | {"at": at})


def with_fault(spec: ResolvedExperiment, command: Inject, at: float) -> ResolvedExperiment:
    """Return the spec with the command's fault, its onset and end counted from `at` in s.

    Raises:
        SpecError: the plant has no channel or output of that name.
    """
    _not_recorded(spec, "fault")
    fault = command.fault
    end = None if fault.end is None else at + fault.end
    fault = fault.model_copy(update={"onset": at + fault.onset, "end": end})
    _check_name(spec, fault.site.kind, f"fault.{fault.site.kind}", fault.site.name)
    return spec.model_copy(update={"faults": (*spec.faults, fault)})


def _not_recorded(spec: ResolvedExperiment, field: str) -> None:
    """Refuse a change of what a record holds."""
    if spec.truth.record is not None:
        raise SpecError(field, spec.truth.record.name, Message("session.recorded"))


def _check_name(spec: ResolvedExperiment, kind: str, field: str, name: str) -> None:
    """Refuse the name of a channel or an output that the plant does not have; kind: `channel` or `output`."""
    names = spec.plant.names(f"{kind}s")
    if name not in names:
        remedy = Message("session.name.choose", names=names) if names else Message(f"session.{kind}.none")
        raise SpecError(field, name, Message(f"session.{kind}.unknown", name=name), remedy)


def with_faults_ended(spec: ResolvedExperiment, command: Clear, at: float) -> ResolvedExperiment:
    """Return the spec in which the named faults (all, if none is named) end at `at` in s; planned ones are removed.

    Raises:
        SpecError: the plant has no channel or output of that name.
    """
    sites = [(kind, name) for kind in ("channel", "output") if (name := getattr(command, kind)) is not None]
    for kind, name in sites:
        _check_name(spec, kind, kind, name)
    kept: list[Fault] = []
    for fault in spec.faults:
        if (sites and fault.site != sites[0]) or (fault.end is not None and fault.end <= at):
            kept.append(fault)
        elif fault.onset < at:
            kept.append(fault.model_copy(update={"end": at}))
    return spec.model_copy(update={"faults": tuple(kept)})


def with_command(
    spec: ResolvedExperiment, command: TimedNow, at: float, here: ResolvedExperiment
) -> tuple[ResolvedExperiment, ResolvedExperiment]:
    """Return the spec with a timed command added, and the experiment from `at` (s) on.

    Args:
        here: the experiment before the command, without timed commands.

    Raises:
        SpecError, pydantic.ValidationError: the command does not fit the experiment.
    """
    timed = timed_command_of(command, at)
    if (too_often := spec.too_often(getattr(timed, "signal", timed))) is not None:
        field, interval, code, args = too_often
        raise SpecError(field, interval, Message(code, **args))
    if isinstance(timed, OfTruth):
        _not_recorded(spec, "command")
    if isinstance(timed, SetTruth):
        _check_truth(here, timed)
    after = changed(here, timed)
    earlier = [c for c in spec.commands if c.at <= at]
    # of a slider that is dragged, the last value within one row counts
    earlier = [c for c in earlier if c.at < timed.at or not _replaces(timed, c)]
    later = [c for c in spec.commands if c.at > at]
    return spec.model_copy(update={"commands": (*earlier, timed, *later)}), after


def _check_truth(here: ResolvedExperiment, command: SetTruth) -> None:
    """Refuse a truth that does not fit the experiment, or that has other states than the plant that is running."""
    if command.truth.states != here.truth.states:
        names = [state.name for state in command.truth.states]
        raise SpecError("truth.states", names, Message("command.truth.states"))
    here.model_copy(update={"truth": command.truth, "figures": ()}).with_plant(here.plant)


def _replaces(command: TimedCommand, other: TimedCommand) -> bool:
    """Return whether a command sets what another one sets, so that at the same time only the later one counts."""
    match command, other:
        case SetGain(), SetGain():
            return (command.observer, command.gain) == (other.observer, other.gain)
        case SetSignal(), SetSignal():
            return command.name == other.name
        case SetNoise(), SetNoise():
            return command.output == other.output
        case SetTruth(), SetTruth():
            return True
    return False


def with_note(spec: ResolvedExperiment, note: Note, t: float, margin: float) -> ResolvedExperiment:
    """Return the spec with a note, in place of the one that has its id.

    Args:
        t: the present time in s. Later notes keep their moments: those that the session began with.
        margin: time in s by which a note may be later all the same.

    Raises:
        SpecError: the note's moment has not been reached, or there are too many notes.
    """
    if note.t > t + margin and (note.id, note.t) not in _moments(spec):
        raise SpecError("note.t", note.t, Message("session.note.ahead", t=t))
    others = [other for other in spec.notes if other.id != note.id]
    if len(others) >= MAX_NOTES:
        raise SpecError("note", note.id, Message("session.notes.many", limit=MAX_NOTES))
    notes = sorted((*others, note), key=lambda one: one.t)
    return spec.model_copy(update={"notes": tuple(notes)})


def _moments(spec: ResolvedExperiment) -> set[tuple[str, float]]:
    """Return id and time in s of every note."""
    return {(note.id, note.t) for note in spec.notes}


def without_note(spec: ResolvedExperiment, id: str) -> ResolvedExperiment:
    """Return the spec without a note. Raises SpecError if it has no note of that id."""
    notes = tuple(note for note in spec.notes if note.id != id)
    if len(notes) == len(spec.notes):
        raise SpecError("note", id, Message("session.note.unknown", note=id))
    return spec.model_copy(update={"notes": notes})


def checked(spec: ResolvedExperiment, before: ResolvedExperiment) -> ResolvedExperiment:
    """Return a spec that differs from `before` in faults or commands, after checking it; its figures are not checked.

    Raises:
        SpecError, pydantic.ValidationError: the spec is refused.
    """
    if spec.faults is before.faults:  # commands are checked where they are carried out; their order is right
        if len(spec.commands) > MAX_COMMANDS:
            raise SpecError("commands", len(spec.commands), Message("session.commands.many", limit=MAX_COMMANDS))
        if spec.commands is not before.commands and (points := points_in(spec.commands)) > MAX_POINTS:
            raise SpecError("signal", points, Message("command.points.many", points=points, limit=MAX_POINTS))
        return spec
    complete = spec.model_copy(update={"figures": ()}).with_plant(spec.plant)
    return complete.model_copy(update={"figures": spec.figures})


def truncated_at(
    spec: ResolvedExperiment, start: ResolvedExperiment, faults: tuple[Fault, ...], t: float
) -> ResolvedExperiment:
    """Return the spec without anything commanded at `t` (s) or later, and without notes on what comes after it.

    Args:
        start: the spec at the start, whose own commands and notes stay.
        faults: the faults as they were before `t`.
    """
    commands = tuple(c for c in spec.commands if c.at < t or c in start.commands)
    own = _moments(start)
    notes = tuple(note for note in spec.notes if note.t <= t or (note.id, note.t) in own)
    return spec.model_copy(update={"faults": faults, "commands": commands, "notes": notes})


def without_commands(spec: ResolvedExperiment, t: float) -> ResolvedExperiment:
    """Return the experiment as its timed commands have left it at `t` (s), without any of them."""
    return after_commands(spec, t)
