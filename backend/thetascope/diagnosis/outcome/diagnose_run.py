"""A finished run diagnosed: what the detector finds in what was measured, and what each observer's estimates show."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.evaluation import observer_tests
from thetascope.diagnosis.monitor.detector import (
    Detector,
    DetectorSettings,
    healthy,
    prepare_detector,
    stored_name,
    unwatchable,
)
from thetascope.diagnosis.monitor.monitor import Monitor, MonitorState
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.diagnosis.yield_points import pause
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Unwatchable
from thetascope.engine.estimation.covariance import Spreads, has_spread, latest, sigma_columns
from thetascope.engine.execution.run_experiment import Parts, spans_of
from thetascope.engine.observers.support.kalman_defaults import typical_sizes
from thetascope.engine.simulation.batch import with_seed
from thetascope.engine.simulation.experiment import Estimator, Experiment, Rows
from thetascope.engine.simulation.simulation import row_values

_RUNS = (4, 24)  # without faults, for the tests on estimates: at least, and at most
_TOTAL = 800_000  # base steps that they take together, about
_SEED = 8_101
_STEPS = 100_000  # base steps of one of them at most


@dataclass(frozen=True)
class DiagnosisRequest:
    """What is asked: of the detector (`DetectorSettings`), and which test is to look at observers' estimates.

    ``key``: a hash of what the detector's calibration depends on; ``estimates_key``: of what that of the observers' tests does;
    ``steps``: base steps that thresholds are simulated over.
    """

    detector: DetectorSettings
    test: str
    key: str
    estimates_key: str
    steps: int


@dataclass(frozen=True)
class EstimateDiagnosis:
    """What the tests found in one observer's estimates; ``note``: why there is nothing."""

    label: str
    channels: tuple[str, ...]
    alarms: tuple[observer_tests.EstimateAlarm, ...] = ()
    test: observer_tests.CalibratedTest | None = None
    theta: np.ndarray | None = None  # decisions × channels
    sigma: np.ndarray | None = None
    typical: tuple[float, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class RunDiagnosis:
    """``prepare_detector`` and what it watched; None with a ``note`` where the experiment cannot be watched. What else is to be known of how it
    was watched is in ``note``, too."""

    detector: Detector | None
    monitor_state: MonitorState | None
    observers: tuple[EstimateDiagnosis, ...]
    interval: float  # s between decisions
    note: str = ""


def advance_over_rows(
    detector: Monitor, monitor_state: MonitorState, experiment: Experiment, rows: Rows, values: dict | None = None
) -> MonitorState:
    """The watcher taken over recorded rows of an experiment; ``values``: signals along them, where they are known."""
    values = values or row_values(experiment, rows.index, rows.plant)
    return detector.advance(
        monitor_state, detector.filter.table(rows.index, rows.y, values), rows.index * experiment.step
    )


def with_noise_of(detector: Detector, experiment: Experiment, doubt: float) -> Detector:
    """The detector with its filter for an experiment whose noise has been changed while it ran."""
    old = detector.filter.experiment
    if (old.measurement.std, old.measurement.sample_time) == (
        experiment.measurement.std,
        experiment.measurement.sample_time,
    ):
        return detector
    return Detector(InnovationFilter(experiment, experiment.context, doubt), detector.thresholds, detector.stride)


def diagnose(parts: Parts, columns: dict[str, np.ndarray], substeps: int, request: DiagnosisRequest) -> RunDiagnosis:
    """Diagnose a run from its spans; ``columns`` are those of its result."""
    first = replace(parts[0][0], steps=request.steps)
    detector, monitor_state, note = None, None, unwatchable(first, first.context)
    if not note:
        try:
            detector = prepare_detector(first, first.context, request.detector, request.key)
            monitor_state = _monitor_run(detector, parts, request.detector.doubt)
        except Unwatchable as error:
            detector, note = None, str(error)
    stride = detector.stride if detector else max(1, first.steps // first.every // 1000)
    interval = stride * first.every * first.step
    return RunDiagnosis(
        detector, monitor_state, _diagnose_estimates(first, columns, substeps, request, stride), interval, note
    )


def _monitor_run(detector: Detector, parts: Parts, doubt: float) -> MonitorState:
    monitor_state = detector.begin()
    for experiment, rows in parts:
        finite = np.isfinite(rows.y).all(axis=1)
        count = int(np.argmin(finite)) if not finite.all() else len(finite)
        monitor_state = advance_over_rows(
            with_noise_of(detector, experiment, doubt), monitor_state, experiment, rows.part(0, count)
        )
        if count < len(finite):
            break
    return monitor_state


# ---- observers' own estimates --------------------------------------------------------------------------------------------


def _diagnose_estimates(
    first: Experiment, columns: dict, substeps: int, request: DiagnosisRequest, stride: int
) -> tuple[EstimateDiagnosis, ...]:
    with_spread = [e for e in first.estimators if has_spread(e) and e.since == 0]
    judgements = _tests_of(first, with_spread, substeps, request, stride) if with_spread else {}
    found = []
    for estimator in first.estimators:
        label, channels = estimator.label, estimator.channels
        if estimator not in with_spread:
            found.append(EstimateDiagnosis(label, channels, note="it estimates no fault"))
            continue
        theta, sigma = (
            _thinned([columns[f"{label}.{what}.{c}"] for c in channels], stride) for what in ("theta", "sigma")
        )
        raised = observer_tests.alarms(_scaled(theta, sigma), judgements[label])
        typical = tuple(typical_sizes(estimator.context))
        found.append(EstimateDiagnosis(label, channels, tuple(raised), judgements[label], theta, sigma, typical))
    return tuple(found)


def _tests_of(
    first: Experiment, with_spread: list[Estimator], substeps: int, request: DiagnosisRequest, stride: int
) -> dict[str, observer_tests.CalibratedTest]:
    """The calibrated test of every observer's estimates: kept on disk, else from runs without faults."""
    name = stored_name(request.estimates_key)
    stored = cache.read("judgement", name)
    if stored is not None:
        return {label: observer_tests.CalibratedTest.from_json(data) for label, data in json.loads(stored).items()}
    interval = stride * first.every * first.step
    detector = {}
    for label, (theta, sigma) in _healthy_runs(first, substeps, stride).items():
        z = _scaled(theta, sigma)
        detector[label] = observer_tests.prepare(
            z, request.test, interval, request.detector.false_alarms, _start_of_test(z)
        )
    cache.write("judgement", name, json.dumps({label: j.to_json() for label, j in detector.items()}).encode())
    return detector


def _thinned(rows: Sequence[np.ndarray], stride: int) -> np.ndarray:
    """Columns at decisions: decisions × channels."""
    return np.stack([c[stride - 1 :: stride] for c in rows], axis=-1)


def _scaled(theta: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(sigma > 0, theta / sigma, 0.0)


def _start_of_test(z: np.ndarray) -> int:
    """The decision from which on estimates of runs without faults stay within what noise explains."""
    size = np.nanmax(np.nan_to_num(np.abs(z)), axis=(0, 2))
    count = len(size)
    loud = np.flatnonzero(size[: count // 2] > 1.5 * max(float(np.max(size[count // 2 :], initial=0.0)), 1.0))
    return min(count // 2, (int(loud[-1]) + 1 if len(loud) else 0) + max(2, count // 50))


def _healthy_runs(first: Experiment, substeps: int, stride: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """θ̂ − θ and σ at decisions in runs without faults, by observer: runs × decisions × channels each."""
    plain = replace(healthy(first), estimators=first.estimators, steps=min(first.steps, _STEPS))
    count = int(np.clip(_TOTAL // max(plain.steps, 1), *_RUNS))
    runs = [_estimates(with_seed(plain, _SEED + k), substeps, stride) for k in range(count)]
    return {label: tuple(np.stack([run[label][k] for run in runs]) for k in (0, 1)) for label in runs[0]}


def _estimates(experiment: Experiment, substeps: int, stride: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    theta: dict[str, list[np.ndarray]] = {}
    spreads: Spreads = {}
    sigma: dict[str, list[np.ndarray]] = {}
    pause()
    for _, rows in spans_of(experiment, substeps):
        values = row_values(experiment, rows.index, rows.plant)
        columns, tables = sigma_columns(experiment, rows, values, spreads)
        spreads = latest(tables)
        for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
            if has_spread(estimator):
                place = {s: i for i, s in enumerate(estimator.program.states)}
                off = [states[:, place[f"thetah.{c}"]] - values[f"theta.{c}"] for c in estimator.channels]
                theta.setdefault(estimator.label, []).append(np.stack(off, axis=1))
                mine = [columns[f"{estimator.label}.sigma.{c}"] for c in estimator.channels]
                sigma.setdefault(estimator.label, []).append(np.stack(mine, axis=1))
    return {
        label: (np.concatenate(theta[label])[stride - 1 :: stride], np.concatenate(sigma[label])[stride - 1 :: stride])
        for label in theta
    }
