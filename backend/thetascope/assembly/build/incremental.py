"""Update an engine's experiment after a change of its spec, reusing all parts that the change does not affect.

A command of a live session changes one number and must take effect within milliseconds. Reused parts are the identical
objects, so that comparing two experiments finds the differences quickly.
"""

from collections.abc import Iterator
from dataclasses import replace

from thetascope.assembly.build.experiment_builder import engine, measurement
from thetascope.assembly.build.loop_builder import loop_of
from thetascope.assembly.build.observer_builder import estimator, with_gains
from thetascope.assembly.build.signal_builder import signals_of
from thetascope.assembly.build.truth_builder import with_truth
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.simulation.experiment import Estimator
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope_schemas import ResolvedExperiment

_FIXED = ("parameters", "initial", "seed", "step", "horizon", "record", "evaluate", "measurement", "noise")


def adapted(spec: ResolvedExperiment, since: dict[str, int], before: ResolvedExperiment, built: Engine) -> Engine:
    """Return ``engine(spec, since, healthy)``, given the engine's experiment for ``before``, from which the healthy run
    is taken: scales and defaults do not change while an experiment runs. Raises SpecError."""
    if spec.plant is not before.plant or any(getattr(spec, name) != getattr(before, name) for name in _FIXED):
        return engine(spec, since, built.context.healthy)
    same_faults = _faults(spec, "output", None) == _faults(before, "output", None)
    known = built.modelled
    measured, loop = known.measurement, known.loop
    if not same_faults:
        measured = measurement(spec, built.step)
        if loop is not None:
            loop = loop_of(spec, spec.plant.model_dump(mode="json"), built.step, measured)
    model = replace(
        known,
        signals=signals_of(spec, _kept_signals(spec, before, built)),
        measurement=measured,
        loop=loop,
        estimators=tuple(_estimators(spec, since, before, built)),
        substeps=spec.substeps,
    )
    return with_truth(model, spec)


def _faults(spec: ResolvedExperiment, kind: str, name: str | None) -> list:
    """Return the faults on a channel or an output; on all of them if no name is given."""
    return [f for f in spec.faults if f.site.kind == kind and name in (None, f.site.name)]


def _kept_signals(spec: ResolvedExperiment, before: ResolvedExperiment, built: Engine) -> dict[str, Signal]:
    """Return the signals that both experiments share."""
    plant = spec.plant
    commanded = {f"u.{n}" for n in plant.names("inputs")} | {f"r.{n}" for n in plant.names("references")}
    same = [n for n in built.signals if n in commanded and spec.inputs.get(n[2:]) == before.inputs.get(n[2:])]
    same += [f"signal.{n}" for n in plant.names("signals") if spec.signals.get(n) == before.signals.get(n)]
    same += [
        f"theta.{n}" for n in plant.names("channels") if _faults(spec, "channel", n) == _faults(before, "channel", n)
    ]
    return {name: built.signals[name] for name in same}


def _estimators(
    spec: ResolvedExperiment, since: dict[str, int], before: ResolvedExperiment, built: Engine
) -> Iterator[Estimator]:
    known = {c.label: (c, e) for c, e in zip(before.observers, built.estimators, strict=True)}
    data = None
    for index, config in enumerate(spec.observers):
        present = None
        if config.label in known:
            old_config, present = known[config.label]
            if old_config != config:
                only_gains = old_config.model_copy(update={"gains": config.gains}) == config
                present = with_gains(index, config, old_config, present) if only_gains else None
        if present is None:
            data = data or spec.plant.model_dump(mode="json")
            assert built.context.healthy is not None, "an experiment has a healthy run"
            present = estimator(index, config, spec, data, built.step, built.context.healthy)
        begun = since.get(config.label, 0)
        yield present if present.since == begun else replace(present, since=begun)
