"""Carry out a run whose truth is a record: its rows, its diagnosis and the observers on it."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thetascope.assembly.analyses.record_diagnosis import diagnose_recording
from thetascope.assembly.analyses.record_inspection import inspected_file, recording_in
from thetascope.assembly.build.prepare import Prepared
from thetascope.assembly.build.recorded_truth import RecordRows, rows_of
from thetascope.engine.errors import Cancelled, SpecError
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment, ObserverConfig, Plant, ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import Alarm
from thetascope_schemas.experiment.measurement import ColumnMapping, Noise, RecordedTruth, RecordSettings, Truth
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis, RecordFault

_SCAN = 0.5  # of the progress of a run


@dataclass(frozen=True, eq=False)
class RecordBytes:
    """The file of an experiment's record, and its diagnosis where it is known."""

    name: str
    data: bytes
    diagnosis: RecordDiagnosis | None = None


def with_rows(spec: ResolvedExperiment) -> ResolvedExperiment:
    """Return an experiment with the rows of its record, read from the file that it carries (`RecordBytes`).

    Raises SpecError for a file that cannot be read.
    """
    file, record = spec.readings, spec.truth.record
    if record is None or not isinstance(file, RecordBytes):
        return spec
    recording = recording_in(inspected_file(file.name, file.data, spec.plant, record.mapping))
    return spec.with_readings(RecordRows(recording, file.diagnosis))


def with_rows_and_diagnosis(spec: ResolvedExperiment) -> ResolvedExperiment:
    """Return an experiment with the rows of its record and the record's diagnosis, for a replay.

    Raises SpecError for a file that cannot be read. A record that cannot be diagnosed has no diagnosis.
    """
    spec = with_rows(spec)
    rows = spec.readings
    if not isinstance(rows, RecordRows) or rows.diagnosis is not None or not spec.diagnosis.enabled:
        return spec
    try:
        return spec.with_readings(RecordRows(rows.recording, _diagnosis(spec, None, None)))
    except SpecError:
        return spec


def record_experiment(
    id: str,
    file: RecordBytes,
    plant: Plant,
    mapping: ColumnMapping,
    settings: RecordSettings,
    observers: Sequence[ObserverConfig],
) -> tuple[Experiment, RecordDiagnosis]:
    """Return the experiment that runs observers on a record, and the diagnosis of the record.

    Observers get the plant with the parameters that the diagnosis fitted, and the noise, the state in the first row and
    the course of the inputs that it found. Base steps are the usual interval from row to row.

    Raises SpecError as `with_rows` and `diagnose_recording`.
    """
    recording = recording_in(inspected_file(file.name, file.data, plant, mapping))
    diagnosis = file.diagnosis or diagnose_recording(plant, recording, settings)
    step, horizon = _steps(plant, recording.t)
    fitted = {p.name: p.value for p in diagnosis.fit.parameters if not p.held}
    noise = {o.output: Noise(std=o.noise, sample_time=step) for o in diagnosis.fit.outputs if o.noise > 0}
    record = RecordedTruth(
        id=id,
        name=file.name[:200],
        mapping=mapping,
        settings=settings,
        between=diagnosis.between,
        fitted=tuple(fitted),
    )
    return Experiment(
        id="record",
        title=file.name[:200],
        plant=plant,
        parameters=fitted,
        initial=diagnosis.initial,
        noise=noise,
        horizon=horizon,
        step=step,
        truth=Truth(record=record),
        observers=tuple(observers),
    ), diagnosis


def _steps(plant: Plant, t: np.ndarray) -> tuple[float, float]:
    """Return base step and horizon in s for rows at the times t."""
    length = float(t[-1] - t[0])
    if plant.time.kind == "discrete":
        return plant.time.period, max(1, round(length / plant.time.period)) * plant.time.period
    count = max(1, round(length / float(np.median(np.diff(t)))))
    step = float(f"{length / count:.12g}")
    return step, count * step


def carry_out(
    prepared: Prepared,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Result:
    """Return the result of an experiment; of a record, with its diagnosis. Raises Cancelled, SpecError."""
    spec = prepared.spec
    if spec.truth.record is None:
        return prepared.run(progress, cancelled)
    begin = time.perf_counter()
    diagnosis, problem = None, None
    if spec.diagnosis.enabled:
        try:
            diagnosis = _diagnosis(spec, progress, cancelled)
        except SpecError as error:
            problem = error.problem
    seconds = time.perf_counter() - begin
    share = _SCAN if diagnosis is not None else 0.0
    result = prepared.run(progress and (lambda done: progress(share + (1 - share) * done)), cancelled)
    data = None if diagnosis is None else diagnosis.model_dump(mode="json")
    notes = result.notes if problem is None else (*result.notes, problem)
    return replace(result, record=data, notes=notes, seconds=result.seconds | {"diagnose": seconds})


def _diagnosis(
    spec: ResolvedExperiment,
    progress: Callable[[float], None] | None,
    cancelled: Callable[[], bool] | None,
) -> RecordDiagnosis:
    """Return the diagnosis of an experiment's record. Raises SpecError as `diagnose_recording`, or Cancelled."""
    rows, record = rows_of(spec), spec.truth.record
    assert record is not None, "an experiment with rows has a record"
    if rows.diagnosis is not None:
        return rows.diagnosis

    def judged(row: int) -> None:
        if cancelled is not None and cancelled():
            raise Cancelled("the run was cancelled")
        if progress is not None:
            progress(_SCAN * row / len(rows.recording))

    return diagnose_recording(diagnosed_plant(spec), rows.recording, record.settings, judged)


def diagnosed_plant(spec: ResolvedExperiment) -> Plant:
    """Return the plant with which an experiment's record is diagnosed: with its parameters, except those fitted on
    this record."""
    fitted = spec.truth.record.fitted if spec.truth.record is not None else ()
    values = {name: value for name, value in spec.parameters.items() if name not in fitted}
    if not values:
        return spec.plant
    parameters = [p.model_copy(update={"value": values.get(p.name, p.value)}) for p in spec.plant.parameters]
    return spec.plant.model_copy(update={"parameters": tuple(parameters)})


def alarms_of(diagnosis: RecordDiagnosis) -> tuple[Alarm, ...]:
    """Return the confirmed faults of a record as alarms, in the order of time."""
    confirmed = [fault for fault in diagnosis.faults if fault.confirmed]
    return tuple(sorted((_alarm(fault, diagnosis.threshold or 0.0) for fault in confirmed), key=lambda a: a.t))


def alarms_on_record(spec: ResolvedExperiment) -> tuple[Alarm, ...]:
    """Return the alarms of an experiment's record; none without a record, or where its diagnosis is not known."""
    rows = spec.readings
    return _alarms_of(rows) if isinstance(rows, RecordRows) else ()


@lru_cache(maxsize=64)
def _alarms_of(rows: RecordRows) -> tuple[Alarm, ...]:
    return () if rows.diagnosis is None else alarms_of(rows.diagnosis)


def _alarm(fault: RecordFault, threshold: float) -> Alarm:
    best = fault.best
    return Alarm(
        id=fault.id,
        observer="",
        t=fault.alarm,
        kind="fault" if best.channel else "unexplained",
        channel=best.channel,
        alternatives=tuple(o.channel for o in fault.alternatives if o.channel and not o.separable),
        onset=best.onset.value,
        onset_from=best.onset.low,
        onset_to=best.onset.high,
        size=best.size.value,
        size_from=best.size.low,
        size_to=best.size.high,
        test="glr",
        statistic=fault.statistic,
        threshold=threshold,
        cleared=fault.ended,
        text=fault.text,
    )
