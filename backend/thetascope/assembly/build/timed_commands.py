"""Apply timed commands to an experiment."""

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
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
from thetascope_schemas.experiment.controllers import set_reference
from thetascope_schemas.experiment.experiment import Noise
from thetascope_schemas.texts.refusal import suggestion


def changed(spec: ResolvedExperiment, command: TimedCommand) -> ResolvedExperiment:
    """Return the experiment after a command, which is not recorded in it. Raises SpecError where it does not fit."""
    return _APPLY[type(command)](spec, command)


def after_commands(spec: ResolvedExperiment, at: float) -> ResolvedExperiment:
    """Return the experiment after its timed commands up to a time in s, without the commands."""
    current = spec.model_copy(update={"commands": ()})
    for command in spec.commands:
        if command.at <= at:
            current = changed(current, command)
    return current


def _with(spec: ResolvedExperiment, **fields: object) -> ResolvedExperiment:
    return spec.model_copy(update=fields)


def _labelled(spec: ResolvedExperiment, label: str, field: str) -> int:
    labels = [o.label for o in spec.observers]
    if label not in labels:
        hint = Message.from_data(suggestion(label, labels))
        raise SpecError(field, label, Message("command.observer.unknown", label=label), hint)
    return labels.index(label)


def _set_gain(spec: ResolvedExperiment, command: SetGain) -> ResolvedExperiment:
    i = _labelled(spec, command.observer, "observer")
    observer = spec.observers[i]
    observer = observer.model_copy(update={"gains": {**observer.gains, command.gain: command.value}})
    return _with(spec, observers=(*spec.observers[:i], observer, *spec.observers[i + 1 :]))


def _set_signal(spec: ResolvedExperiment, command: SetSignal) -> ResolvedExperiment:
    plant = spec.plant
    commanded = tuple(item.name for item in plant.commanded)
    if command.name in plant.controlled:
        remedy = Message.from_data(set_reference(plant.names("references")))
        raise SpecError("name", command.name, Message("controller.input.set", name=command.name), remedy)
    if command.name in commanded:
        return _with(spec, inputs={**spec.inputs, command.name: command.signal})
    if command.name in plant.names("signals"):
        return _with(spec, signals={**spec.signals, command.name: command.signal})
    hint = Message.from_data(suggestion(command.name, (*commanded, *plant.names("signals"))))
    raise SpecError("name", command.name, Message("command.signal.unknown", name=command.name), hint)


def _set_noise(spec: ResolvedExperiment, command: SetNoise) -> ResolvedExperiment:
    if command.output not in spec.plant.names("outputs"):
        hint = Message.from_data(suggestion(command.output, spec.plant.names("outputs")))
        raise SpecError("output", command.output, Message("plant.output.unknown", name=command.output), hint)
    noise = Noise(std=command.std, sample_time=command.sample_time)
    return _with(spec, noise={**spec.noise, command.output: noise})


def _set_truth(spec: ResolvedExperiment, command: SetTruth) -> ResolvedExperiment:
    return _with(spec, truth=command.truth)


def _add_observer(spec: ResolvedExperiment, command: AddObserver) -> ResolvedExperiment:
    if command.observer.label in [o.label for o in spec.observers]:
        label = command.observer.label
        raise SpecError("observer.label", label, Message("command.label.taken", label=label))
    return _with(spec, observers=(*spec.observers, command.observer))


def _remove_observer(spec: ResolvedExperiment, command: RemoveObserver) -> ResolvedExperiment:
    i = _labelled(spec, command.label, "label")
    return _with(spec, observers=(*spec.observers[:i], *spec.observers[i + 1 :]))


def _set_substeps(spec: ResolvedExperiment, command: SetSubsteps) -> ResolvedExperiment:
    return _with(spec, substeps=command.substeps)


_APPLY = {
    SetGain: _set_gain,
    SetSignal: _set_signal,
    SetNoise: _set_noise,
    SetTruth: _set_truth,
    AddObserver: _add_observer,
    RemoveObserver: _remove_observer,
    SetSubsteps: _set_substeps,
}
