"""A record in place of the simulated plant: its inputs, its readings and the observers that use them."""

from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.recording import Recording
from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs.readings import Readings, input_between, on_grid
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.programs.recorded_programs import at_rest, over_intervals, predicting
from thetascope.engine.simulation.experiment import Estimator, Model
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis


@dataclass(frozen=True, eq=False)
class RecordRows:
    """The rows of the record of an experiment (its `readings`), and the record's diagnosis where it is known."""

    recording: Recording
    diagnosis: RecordDiagnosis | None = None
    _made: dict[tuple, Readings] = field(default_factory=dict)

    def times(self, step: float, discrete: bool) -> np.ndarray:
        """Return the times in s (rows,) after the first row; of a discrete plant, whole steps."""
        return on_grid(self.recording.t - self.recording.t[0], step, discrete)

    def readings(self, spec: ResolvedExperiment) -> Readings:
        """Return the readings on the base steps of an experiment; the same object for the same steps."""
        discrete, outputs = spec.plant.time.kind == "discrete", tuple(f"y.{o.name}" for o in spec.plant.outputs)
        key = (spec.step, discrete, outputs)
        if key not in self._made:
            self._made[key] = Readings(self.times(spec.step, discrete), self.recording.y, outputs, spec.step)
        return self._made[key]


def rows_of(spec: ResolvedExperiment) -> RecordRows:
    """Return the rows of an experiment's record. Raises SpecError where they were not read."""
    if not isinstance(spec.readings, RecordRows):
        id = spec.truth.record.id if spec.truth.record else ""
        raise SpecError("truth.record.id", id, Message("record.unknown", id=id))
    return spec.readings


def recorded_signals(spec: ResolvedExperiment) -> dict[str, Signal]:
    """Return u.* and signal.* of an experiment with a record."""
    rows, record = rows_of(spec), spec.truth.record
    assert record is not None, "an experiment with rows has a record"
    t = rows.times(spec.step, spec.plant.time.kind == "discrete")
    names = [f"u.{u.name}" for u in spec.plant.inputs] + [f"signal.{s.name}" for s in spec.plant.signals]
    columns = zip(names, rows.recording.u.T, strict=True)
    return {name: input_between(t, values, record.between) for name, values in columns}


def with_record(model: Engine, spec: ResolvedExperiment) -> Engine:
    """Return the engine's experiment with the record in place of the model's plant and its sensors."""
    readings = rows_of(spec).readings(spec)
    return replace(
        model,
        plant=at_rest(model.plant),
        measurement=replace(model.measurement, readings=readings),
        signals=model.signals | readings.present | readings.fresh,
        model=Model(model.plant, model.parameters, {}, None),
    )


def on_record(estimator: Estimator, spec: ResolvedExperiment, chosen_period: bool) -> Estimator:
    """Return an observer as it runs on the record of an experiment, if there is one.

    It corrects only with readings that are there. At samples, it works at the true times of the rows, unless its
    period was chosen (`chosen_period`).
    """
    if spec.truth.record is None:
        return estimator
    readings, program = rows_of(spec).readings(spec), estimator.program
    flags = readings.present if program.time != DISCRETE or estimator.every is None else readings.fresh
    present = {name.partition(".")[2]: name for name in flags}
    if present:
        program = predicting(program, readings.outputs, present)
    instants = None
    if estimator.every is not None and not chosen_period and spec.plant.time.kind != "discrete":
        instants = readings.instants
    if instants is not None:
        program = over_intervals(program)
    return replace(estimator, program=program, instants=instants)
