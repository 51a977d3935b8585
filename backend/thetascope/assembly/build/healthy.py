"""The healthy run of an experiment: the source of all scales, see engine/simulation/healthy_run.py."""

import numpy as np

from thetascope.assembly.build.diagnosis_settings import span
from thetascope.assembly.build.loop_builder import loop_of
from thetascope.assembly.build.signal_builder import initial_state, nominal_state, plant_parameters, signals_of
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.observers.support.scales import HealthyRun, Scales
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.simulation.healthy_run import healthy_run
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.measurement import ContinuousMeasurement, RecordedTruth, RecordSettings, Truth


def healthy_run_of(spec: ResolvedExperiment, data: dict) -> HealthyRun:
    """Return the healthy run of an experiment as it begins; it simulates when its scales are needed.

    It depends on what an observer may know: the plant with its nominal initial state, its parameters, inputs and noise,
    and the time that the diagnosis covers (`span`); not on the true initial state, the seed, faults, observers, the
    spacing of rows or the present end of a session. ``data`` is the plant as JSON.
    """

    def simulate() -> Scales:
        signals = signals_of(spec.model_copy(update={"faults": ()}))
        noise = np.array([n.std if (n := spec.noise.get(o.name)) else 0.0 for o in spec.plant.outputs])
        step = spec.plant.time.period if spec.plant.time.kind == "discrete" else spec.step
        steps = max(1, round(span(spec) / step))
        start, parameters = nominal_state(spec.plant), plant_parameters(spec)
        if spec.truth.record is not None:
            start = initial_state(spec)
        outputs = tuple(f"y.{o.name}" for o in spec.plant.outputs)
        quiet = Measurement(outputs, (0.0,) * len(outputs), (step,) * len(outputs), 0)
        loop = loop_of(spec, data, step, quiet, nominal=True)
        return healthy_run(plant_program(data).program, data, parameters, start, signals, noise, step, steps, loop)

    return HealthyRun(_key(spec), simulate)


def _key(spec: ResolvedExperiment) -> str:
    """Return the hash of everything that the healthy run depends on."""
    changes = {
        "seed": 0,
        "initial": {} if spec.truth.record is None else spec.initial,
        "horizon": span(spec),
        "record": spec.step,
        "evaluate": spec.step,
        "substeps": None,
        "measurement": ContinuousMeasurement(),
        "truth": Truth(record=_rows_only(spec.truth.record)),
        "observers": (),
        "commands": (),
        "faults": (),
        "diagnosis": DiagnosisSettings(),
        "figures": (),
    }
    return spec.model_copy(update=changes).spec_hash()


def _rows_only(record: RecordedTruth | None) -> RecordedTruth | None:
    """Return a record without the settings of its diagnosis."""
    return None if record is None else record.model_copy(update={"settings": RecordSettings(), "fitted": ()})
