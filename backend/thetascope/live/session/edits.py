"""Commands of a live session → the spec that they leave behind."""

from thetascope.assembly.build.timed_commands import after_commands, changed
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.commands import (
    MAX_COMMANDS,
    AddObserver,
    RemoveObserver,
    SetGain,
    SetNoise,
    SetSignal,
    TimedCommand,
)
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.service.session import (
    AddObserverNow,
    Clear,
    Inject,
    RemoveObserverNow,
    SetGainNow,
    SetNoiseNow,
    SetSignalNow,
)


def timed_command_of(command: object, at: float) -> TimedCommand | None:
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


def with_fault(spec: Experiment, command: Inject, at: float) -> Experiment:
    """The spec with a fault whose onset (and end) were counted from ``at``. Raises SpecError for unknown names."""
    fault = command.fault
    end = None if fault.end is None else at + fault.end
    fault = fault.model_copy(update={"onset": at + fault.onset, "end": end})
    where, name = fault.site
    _known(spec, where, f"fault.{where}", name)
    return spec.model_copy(update={"faults": (*spec.faults, fault)})


def _known(spec: Experiment, where: str, field: str, name: str) -> None:
    """Refuse the name of a channel or an output that the plant does not have."""
    known = spec.plant.names(f"{where}s")
    if name not in known:
        raise SpecError(
            field,
            name,
            f"the plant has no {where} of that name",
            f"choose from {', '.join(known) or 'none: it has none'}",
        )


def with_faults_ended(spec: Experiment, command: Clear, at: float) -> Experiment:
    """The spec in which the named faults (all, if none is named) end at ``at``; those still to come are taken out.

    Raises SpecError for unknown names.
    """
    sites = [(where, name) for where in ("channel", "output") if (name := getattr(command, where)) is not None]
    for where, name in sites:
        _known(spec, where, where, name)
    kept = []
    for fault in spec.faults:
        if (sites and fault.site != sites[0]) or (fault.end is not None and fault.end <= at):
            kept.append(fault)
        elif fault.onset < at:
            kept.append(fault.model_copy(update={"end": at}))
    return spec.model_copy(update={"faults": tuple(kept)})


def with_command(spec: Experiment, command: object, at: float, here: Experiment) -> tuple[Experiment, Experiment]:
    """The spec with a timed command noted at its end, and the experiment as it is from ``at`` on; ``here``: as it was."""
    note = timed_command_of(command, at)
    if (too_often := spec.too_often(getattr(note, "signal", note))) is not None:
        field, interval, code, args = too_often
        raise SpecError(field, interval, Message(code, **args))
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
            raise SpecError(
                "commands",
                len(spec.commands),
                f"an experiment has at most {MAX_COMMANDS} timed commands",
                "save the session, and go on in another",
            )
        return spec
    complete = spec.model_copy(update={"figures": ()}).with_plant(spec.plant)
    return complete.model_copy(update={"figures": spec.figures})


def truncated_at(spec: Experiment, start: Experiment, faults: tuple[Fault, ...], t: float) -> Experiment:
    """The spec without what was done at ``t`` or later: its ``faults`` as they were then, and the commands before."""
    commands = tuple(c for c in spec.commands if c.at < t or c in start.commands)
    return spec.model_copy(update={"faults": faults, "commands": commands})


def without_commands(spec: Experiment, t: float) -> Experiment:
    """Return the experiment as its timed commands have left it at ``t``, and without them."""
    return after_commands(spec, t)
