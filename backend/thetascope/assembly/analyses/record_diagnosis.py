"""Diagnose a record of a real plant: the detector runs on the columns of a file instead of a simulation.

The noise is unknown, so it is estimated from the data: first from differences of neighbouring samples, then from those
of the filter's innovations, which no longer contain the plant's motion or constant faults. Medians are used, so that
events in a part of the record have little effect. Thresholds are computed by simulating the plant with the recorded
inputs and this noise. A model never fits a plant exactly: apparent faults in an initial stretch that is known to be
healthy (``learn``) are attributed to the model, and ``doubt`` is the assumed model error.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from pydantic import ValidationError

from thetascope.assembly.build.diagnosis_settings import calibration_key, detector_settings
from thetascope.assembly.build.prepare import prepare
from thetascope.diagnosis.detection.window_tests import WindowSums
from thetascope.diagnosis.isolation.decision_state import DecisionState
from thetascope.diagnosis.monitor.detector import Detector, prepare_detector, unwatchable
from thetascope.diagnosis.monitor.monitor import MonitorState
from thetascope.diagnosis.outcome.diagnose_run import RunDiagnosis
from thetascope.diagnosis.outcome.findings import detector_report
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.engine.errors import SpecError, Unwatchable
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import row_values
from thetascope.messages import Message
from thetascope_schemas import Plant, ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings, ObserverDiagnosis
from thetascope_schemas.service.field_error import field_errors

_FEWEST_ROWS = 200  # fewest rows of a record
_EVEN = 0.05  # tolerance for equal spacing, relative to the period; times are often rounded
_LARGEST = 1e30  # beyond the range of every sensor
_MEDIAN = 0.4549  # of the square of a standard normal number
_ROUNDS = 3  # of estimating the noise,
_SURE = 0.01  # the filter uses this share of the doubt: a filter that follows the noise would underestimate it
_LAGS = 8  # most samples for which noise may be held
_STANDS_OUT = 5.0  # ratio of squared differences where a sensor's value is new to all others
_FINEST = 20  # simulation steps per sample


@dataclass(frozen=True)
class Recording:
    """Samples at equal distances: t (rows) from 0 on, y (rows, m), inputs and known signals by name."""

    period: float
    t: np.ndarray
    y: np.ndarray
    inputs: dict[str, np.ndarray]
    signals: dict[str, np.ndarray]


def recording(plant: Plant, columns: Mapping[str, np.ndarray]) -> Recording:
    """Return the plant's columns: ``t``, inputs, signals and outputs, with or without the prefix u., signal. or y.

    Inputs and signals that are missing keep their defaults. Raises SpecError for a missing output, a missing input that
    a controller sets, uneven times and gaps.
    """
    t = _column(columns, ("t", "time"), "t")
    if len(t) < _FEWEST_ROWS:
        raise SpecError("t", len(t), Message("record.too-short", rows=len(t), least=_FEWEST_ROWS))
    period = _period(t)
    y = np.stack([_column(columns, (f"y.{n}", n), f"y.{n}") for n in plant.names("outputs")], axis=1)
    inputs_and_signals = [
        {
            n: _column(columns, (f"{prefix}.{n}", n), f"{prefix}.{n}")
            for n in plant.names(group)
            if f"{prefix}.{n}" in columns or n in columns or n in plant.controlled
        }
        for prefix, group in (("u", "inputs"), ("signal", "signals"))
    ]
    return Recording(period, np.arange(len(t)) * period, y, *inputs_and_signals)


def _period(t: np.ndarray) -> float:
    """Return the sample period in s. Raises SpecError unless samples are equally spaced up to rounding of times."""
    steps = np.diff(t)
    usual = float(np.median(steps))
    wrong = np.flatnonzero(np.abs(steps - usual) > 0.5 * max(usual, 1e-300))
    period = float(t[-1] - t[0]) / (len(t) - 1)
    if not len(wrong) and period > 0:
        off = t - t[0] - period * np.arange(len(t))
        wrong = np.flatnonzero(np.abs(off[1:]) > max(_EVEN * period, 1.01 * _resolution(t)))
    if period <= 0 or len(wrong):
        row = int(wrong[0]) + 1 if len(wrong) else 1
        raise SpecError("t", float(t[row]), Message("record.t.uneven", row=row + 1, step=usual))
    return period


def _resolution(t: np.ndarray) -> float:
    """Return the decimal place to which all times are rounded if it is a coarse one, else 0.

    Rounding shifts each time, and both ends, by at most half of it.
    """
    for place in (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        if (np.abs(t / place - np.rint(t / place)) < 1e-6 * np.maximum(1.0, np.abs(t / place))).all():
            return place if place < np.median(np.diff(t)) / 2 else 0.0
    return 0.0


def _column(columns: Mapping[str, np.ndarray], names: tuple[str, ...], field: str) -> np.ndarray:
    name = next((n for n in names if n in columns), None)
    if name is None:
        raise SpecError(field, None, Message("record.column.missing", names=names, columns=list(columns)))
    values = np.asarray(columns[name], dtype=float)
    good = np.abs(values) < _LARGEST
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        code = "record.value.too-large" if np.isfinite(values[row]) else "record.value.no-number"
        raise SpecError(field, str(values[row]), Message(code, row=row + 1))
    return values


def diagnose_columns(
    plant: Plant, columns: Mapping[str, np.ndarray], settings: DiagnosisSettings, learn: float
) -> ObserverDiagnosis:
    """Return the diagnosis of a record's columns; see `recording` and `diagnose_recording`."""
    return diagnose_recording(plant, recording(plant, columns), settings, learn)


def diagnose_recording(
    plant: Plant, record: Recording, settings: DiagnosisSettings, learn: float = 0.0
) -> ObserverDiagnosis:
    """Return the detector's findings in a record. ``learn``: seconds at its beginning that are known to be healthy.

    Raises SpecError where the plant or the record is not suitable.
    """
    record = _fresh(record)
    plant = plant.model_copy(update={"controllers": (), "references": ()})  # the record holds the applied inputs
    spec = _spec(plant, record, settings)
    experiment = prepare(spec).engine
    why = unwatchable(experiment, experiment.context)
    if why:
        raise SpecError("plant", plant.id, Message("record.no-detector", reason=why))
    if not 0 <= learn <= 0.9 * (spec.horizon or 0.0):
        raise SpecError("learn", learn, Message("record.learn.too-long", length=spec.horizon, most=0.9 * spec.horizon))
    experiment = _with_noise(experiment, record, settings.doubt)
    if not np.isfinite(experiment.measurement.std).all():
        raise SpecError("plant", plant.id, Message("record.filter.diverges"))
    noise = dict(zip(plant.names("outputs"), experiment.measurement.std, strict=True))
    measured = {n: {"std": float(s), "sample_time": record.period} for n, s in noise.items()}
    spec = ResolvedExperiment.model_validate(spec.model_dump() | {"noise": measured})
    try:
        detector = run_to_end(
            prepare_detector(experiment, experiment.context, detector_settings(spec), calibration_key(spec))
        )
    except Unwatchable as error:
        raise SpecError("plant", plant.id, Message("record.not-calibrated", reason=error.args[0])) from None
    state = _monitor_record(detector, experiment, record, learn)
    run_diagnosis = RunDiagnosis(detector, state, (), detector.interval, _defaults(plant, record))
    report = detector_report(
        run_diagnosis,
        settings.confidence,
        settings.accuracy,
        spec.horizon,
        max(_learnt_until(detector, record, learn), detector.thresholds.begin),
    )
    report["noise"] = [{"output": n, "declared": None, "estimated": float(s)} for n, s in noise.items()]
    return ObserverDiagnosis.model_validate(report)


def _spec(plant: Plant, record: Recording, settings: DiagnosisSettings) -> ResolvedExperiment:
    """Return the experiment of the plant with the recorded inputs, held between samples."""

    def held(values: np.ndarray) -> dict:
        return {"kind": "table", "times": record.t.tolist(), "values": values.tolist(), "interpolation": "hold"}

    fine = 1 if plant.time.kind == "discrete" else _FINEST
    data = {
        "plant": plant,
        "inputs": {n: held(v) for n, v in record.inputs.items()},
        "signals": {n: held(v) for n, v in record.signals.items()},
        "step": record.period / fine,
        "evaluate": record.period,
        "horizon": record.period * (len(record.t) - 1),
        "diagnosis": settings,
        "noise": {n: {"std": 1.0, "sample_time": record.period} for n in plant.names("outputs")},
    }
    try:
        return ResolvedExperiment.model_validate(data)
    except ValidationError as error:
        first = field_errors(error.errors(include_url=False))[0]
        raise SpecError(first.field, first.value, Message.from_data({"code": first.code, "args": first.args})) from None


def _with_noise(experiment: Engine, record: Recording, doubt: float) -> Engine:
    """Return the experiment with the noise estimated from the record."""
    std = _scatter(record.y)
    std = np.maximum(std, 1e-9 * np.maximum(np.abs(record.y).max(axis=0), 1e-12))
    known = np.zeros(sum(n.startswith("theta.") for n in experiment.plant.inputs))
    for _ in range(_ROUNDS):
        experiment = replace(experiment, measurement=replace(experiment.measurement, std=tuple(float(s) for s in std)))
        innovation_filter = InnovationFilter(experiment, experiment.context, _SURE * doubt)
        index, table = _table(experiment, record, innovation_filter)
        nu = innovation_filter.run(innovation_filter.start(), known, table, index * experiment.step).nu
        std = std * np.maximum(_scatter(nu), 1e-6)
    return replace(experiment, measurement=replace(experiment.measurement, std=tuple(float(s) for s in std)))


def _scatter(values: np.ndarray) -> np.ndarray:
    """Return the standard deviation of noise from differences, one number per column."""
    return np.sqrt(np.median(np.diff(values, axis=0) ** 2, axis=0) / (2 * _MEDIAN))


def _fresh(record: Recording) -> Recording:
    """Return the record without repeated samples: where sensors hold values, every n-th difference is large."""
    squares = np.diff(record.y, axis=0) ** 2
    for every in range(2, _LAGS + 1):
        phases = np.array([np.median(squares[k::every], axis=0) for k in range(every)])
        largest = int(phases.sum(axis=1).argmax())
        others = np.delete(phases, largest, axis=0).max(axis=0)
        if (phases[largest] > _STANDS_OUT * others).all():
            rows = slice((largest + 1) % every, None, every)
            thin = {name: {n: v[rows] for n, v in getattr(record, name).items()} for name in ("inputs", "signals")}
            t = record.t[rows]
            return Recording(every * record.period, t - t[0], record.y[rows], **thin)
    return record


def _table(experiment: Engine, record: Recording, innovation_filter: InnovationFilter) -> tuple[np.ndarray, np.ndarray]:
    index = np.arange(len(record.t)) * experiment.every
    values = row_values(experiment, index, np.zeros((len(index), len(experiment.plant.states))))
    return index, innovation_filter.table(index, record.y, values, experiment.signals)


def _monitor_record(detector: Detector, experiment: Engine, record: Recording, learn: float) -> MonitorState:
    """Return the monitor's state after the record, starting after the stretch that is learnt."""
    index, table = _table(experiment, record, detector.filter)
    t = index * experiment.step
    detector.filter.learn_repeats(record.y)
    first = _learnt_until(detector, record, learn)
    if first <= detector.thresholds.begin:
        return run_to_end(detector.advance(detector.begin(), table, t))
    rows = first * detector.stride
    state, base = _learnt(detector, table[:rows], t[:rows])
    detector.filter.base = base
    initial = DecisionState.initial(replace(detector.thresholds, begin=first), detector.filter.p, detector.filter.m)
    none = WindowSums.empty(detector.filter.p, detector.filter.m)
    state = MonitorState(initial, replace(none, first=first), state[None, :], table[:0], t[:0], detector.stride)
    return run_to_end(detector.advance(state, table[rows:], t[rows:]))


def _learnt_until(detector: Detector, record: Recording, learn: float) -> int:
    """Return the decision up to which a record is assumed to be healthy."""
    return min(round(learn / detector.interval), len(record.t) // detector.stride - 2)


def _defaults(plant: Plant, record: Recording) -> Message | None:
    """Return which inputs and signals are missing in the record, or None."""
    missing = [
        name
        for group, recorded in (("inputs", record.inputs), ("signals", record.signals))
        for name in plant.names(group)
        if name not in recorded
    ]
    return Message("diagnosis.record.defaults", names=missing) if missing else None


def _learnt(detector: Detector, table: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the filter after a healthy stretch, and the θ that fits it (zero where the stretch has no information)."""
    filter_, cal = detector.filter, detector.thresholds
    outputs = filter_.run(filter_.start(), np.zeros(filter_.p), table, t)
    rows = slice(cal.begin * detector.stride, None)
    omega, nu = outputs.omega[rows].reshape(-1, filter_.p), outputs.nu[rows].ravel()
    typical = np.array([float(c.get("typical", 1.0)) for c in filter_.context.model["channels"]])
    base = np.linalg.solve(omega.T @ omega + np.diag(typical**-2.0), omega.T @ nu)
    last = outputs.states[-1]
    return filter_.shifted(last, base), base
