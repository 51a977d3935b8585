"""Build the engine's experiment from a resolved experiment at one time."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from thetascope.assembly.build.observer_builder import estimator, plant_context
from thetascope.assembly.build.step_counts import multiple
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs import fault_signals, signals
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment


def engine(spec: ResolvedExperiment, since: dict[str, int] | None = None) -> Engine:
    """Build the engine's experiment for a spec without timed commands. Raises SpecError.

    ``since``: the base steps at which observers were added, by label; all others start with the run.
    """
    plant = spec.plant
    data = plant.model_dump(mode="json")
    step, steps, every = _times(spec)
    program = plant_program(data).program  # before the observers: an error in the plant's equations is the plant's
    estimators = [estimator(i, c, spec, data, step) for i, c in enumerate(spec.observers)]
    if since:
        estimators = [replace(e, since=since.get(e.label, 0)) for e in estimators]
    return Engine(
        plant=program,
        parameters={f"p.{n}": v for n, v in _parameters(spec).items()},
        x0=np.array([spec.initial.get(s.name, s.initial) for s in plant.states], dtype=float),
        signals=signals_of(spec),
        measurement=measurement(spec, step),
        estimators=tuple(estimators),
        step=step,
        steps=steps,
        every=every,
        substeps=spec.substeps,
        context=plant_context(spec, data, step),
    )


def _parameters(spec: ResolvedExperiment) -> dict[str, float]:
    return {p.name: spec.parameters.get(p.name, p.value) for p in spec.plant.parameters}


def _times(spec: ResolvedExperiment) -> tuple[float, int, int]:
    step, plant = spec.step, spec.plant
    if plant.time.kind == "discrete":
        if abs(step - plant.time.period) > 1e-9 * plant.time.period:
            raise SpecError("step", step, Message("experiment.step.not-period", period=plant.time.period, step=step))
        step = plant.time.period
    return step, multiple(spec.horizon, step, "horizon"), multiple(spec.record_interval, step, "record")


def signals_of(
    spec: ResolvedExperiment, known: Mapping[str, signals.Signal] = MappingProxyType({})
) -> dict[str, signals.Signal]:
    """Return u.*, signal.* and theta.*, in this order; those in ``known`` are reused."""
    built, plant = {}, spec.plant
    for u in plant.inputs:
        name, given = f"u.{u.name}", spec.inputs.get(u.name)
        fresh = signals.constant(u.default) if given is None else _signal(given, f"inputs.{u.name}")
        built[name] = known.get(name, fresh)
    for s in plant.signals:
        name = f"signal.{s.name}"
        built[name] = known.get(name) or _signal(spec.signals.get(s.name, s.default), f"signals.{s.name}")
    for c in plant.channels:
        name = f"theta.{c.name}"
        built[name] = known.get(name) or fault_signals.theta(c.name, _plain(spec, c.name), spec.seed)
    return built


def _plain(spec: ResolvedExperiment, channel: str) -> list[dict]:
    return [f.model_dump(mode="json") for f in spec.faults if f.site == ("channel", channel)]


def _signal(given, field: str) -> signals.Signal:
    try:
        return signals.signal(given.model_dump(mode="json"))
    except SpecError as error:
        error.field = f"{field}.{error.field}"
        raise


def measurement(spec: ResolvedExperiment, step: float) -> Measurement:
    """Return the measurement: noise, faults of the sensors, sampling."""
    outputs = spec.plant.names("outputs")
    noise = [spec.noise.get(name) for name in outputs]
    plain = [f.model_dump(mode="json") for f in spec.faults if f.site.kind == "output"]
    for fault in plain:
        fault["output"] = f"y.{fault['output']}"
    every = None
    if spec.measurement.mode == "sampled":
        every = multiple(spec.measurement.period, step, "measurement.period")
    return Measurement(
        outputs=tuple(f"y.{name}" for name in outputs),
        std=tuple(n.std if n else 0.0 for n in noise),
        sample_time=tuple(n.sample_time if n else step for n in noise),
        seed=spec.seed,
        faults=tuple(plain),
        sample_every=every,
    )
