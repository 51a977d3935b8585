"""The true plant and its sensors, from an experiment's `truth`."""

import zlib
from dataclasses import replace

import numpy as np

from thetascope.assembly.build.loop_builder import loop_of
from thetascope.assembly.build.recorded_truth import with_record
from thetascope.assembly.build.signal_builder import plant_parameters
from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.sampling import Sampling
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.model.true_plant import true_data
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.simulation.experiment import PROCESS_NOISE, Model, disturbances
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.measurement import TrueSensor, Truth


def with_truth(model: Engine, spec: ResolvedExperiment) -> Engine:
    """Return the engine's experiment with the true plant and sensors in place of the model's.

    Raises ExpressionError for a text of the truth.
    """
    truth = spec.truth
    if truth == Truth():
        return model
    if truth.record is not None:
        return with_record(model, spec)
    noise = {f"{PROCESS_NOISE}{name}": std for name, std in truth.process_noise.items() if std > 0}
    added = {name: sensor.adds for name, sensor in truth.outputs.items() if sensor.adds is not None}
    plant, data = model.plant, spec.plant.model_dump(mode="json")
    measured = true_measurement(model.measurement, spec, model.step)
    known_loop = loop_of(spec, data, model.step, measured.modelled)
    if noise or added or truth.dynamics:
        states, disturbed = [s.name for s in truth.states], [n.removeprefix(PROCESS_NOISE) for n in noise]
        data = true_data(data, states, truth.dynamics, added, disturbed)
        plant = plant_program(data).program
    loop = loop_of(spec, data, model.step, measured)
    return replace(
        model,
        plant=plant,
        loop=loop,
        parameters=true_parameters(spec),
        x0=np.concatenate([model.x0, [float(s.initial) for s in truth.states]]),
        measurement=measured,
        signals=model.signals | disturbances(noise, model.step, spec.plant.time.kind == "discrete", spec.seed),
        model=Model(model.plant, model.parameters, noise, known_loop),
    )


def true_parameters(spec: ResolvedExperiment) -> dict[str, float]:
    """Return the true plant's parameters, ``p.*``: as `truth` names them, else up or down by its `deviation`."""
    truth, values = spec.truth, plant_parameters(spec)
    for item in spec.plant.parameters:
        name = f"p.{item.name}"
        if item.name in truth.parameters:
            values[name] = truth.parameters[item.name]
        elif truth.deviation > 0:
            upwards = random_streams.uniform((spec.seed, 10, zlib.crc32(item.name.encode())), 0, 1)[0] < 0.5
            low, high = (limit if limit is None else float(limit) for limit in item.bounds)
            value = values[name] * (1 + truth.deviation if upwards else 1 - truth.deviation)
            value = value if low is None else max(value, low)
            values[name] = value if high is None else min(value, high)
    return values


def true_measurement(known: Measurement, spec: ResolvedExperiment, step: float) -> Measurement:
    """Return the measurement by the true sensors."""
    sensors = [spec.truth.outputs.get(name) for name in spec.plant.names("outputs")]
    correlation = tuple(None if sensor is None else sensor.correlation for sensor in sensors)
    samplings = tuple(
        None if sensor is None else _sampling(sensor, name, spec, step)
        for sensor, name in zip(sensors, spec.plant.names("outputs"), strict=True)
    )
    return replace(
        known,
        correlation=correlation if any(correlation) else (),
        samplings=samplings if any(samplings) else (),
    )


def _sampling(sensor: TrueSensor, output: str, spec: ResolvedExperiment, step: float) -> Sampling | None:
    period = sensor.samples_every(spec.noise.get(output), spec.measurement, spec.plant)
    return None if period is None else Sampling(round(period / step), sensor.missing, sensor.jitter / step)
