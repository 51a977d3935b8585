"""Diagnose a finished run: the detector's findings in its measurements, and the tests on each observer's estimates."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.evaluation import observer_tests
from thetascope.diagnosis.evaluation.observer_tests import CalibratedTest
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
from thetascope.diagnosis.yield_points import Steps
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Unwatchable
from thetascope.engine.estimation.covariance import Spreads, has_spread, latest, sigma_columns
from thetascope.engine.execution.run_experiment import Parts
from thetascope.engine.observers.support.kalman_defaults import typical_sizes
from thetascope.engine.simulation.batch import with_seed
from thetascope.engine.simulation.controlled import Repeated
from thetascope.engine.simulation.experiment import Estimator, Experiment, Rows
from thetascope.engine.simulation.simulation import row_values
from thetascope.messages import Message

_RUNS = (4, 24)  # runs without faults for the tests on estimates: at least, and at most
_TOTAL = 800_000  # base steps of all of them together, about
_SEED = 8_101
_STEPS = 100_000  # base steps of one of them, at most


@dataclass(frozen=True)
class DiagnosisRequest:
    """How a run is to be diagnosed.

    Attributes:
        detector: the settings of the detector.
        test: the test on the observers' estimates (`observer_tests`).
        key: a hash of everything that the detector's thresholds depend on.
        estimates_key: the same for the tests on estimates.
        steps: base steps of the runs that thresholds are simulated over.
    """

    detector: DetectorSettings
    test: str
    key: str
    estimates_key: str
    steps: int


@dataclass(frozen=True)
class TestedEstimates:
    """One observer's estimates at decisions, and the alarms of the test on them.

    Attributes:
        alarms: in order of time.
        test: the test with its threshold.
        theta, sigma: (decisions, channels), estimates and their standard deviations.
        typical: (channels,), typical sizes of faults.
    """

    alarms: tuple[observer_tests.EstimateAlarm, ...]
    test: CalibratedTest
    theta: np.ndarray
    sigma: np.ndarray
    typical: tuple[float, ...]


@dataclass(frozen=True)
class EstimateDiagnosis:
    """The diagnosis by one observer's estimates; `tested` is None, and `note` says why, if it estimates no fault."""

    label: str
    channels: tuple[str, ...]
    tested: TestedEstimates | None = None
    note: Message | None = None


@dataclass(frozen=True)
class RunDiagnosis:
    """The diagnosis of a run.

    Attributes:
        detector, monitor_state: the detector and its final state; None if the experiment cannot be diagnosed.
        observers: by observer, in the order of the experiment.
        interval: time between decisions, s.
        note: why there is no detector, or under which assumptions it worked.
    """

    detector: Detector | None
    monitor_state: MonitorState | None
    observers: tuple[EstimateDiagnosis, ...]
    interval: float
    note: Message | None = None


def advance_over_rows(
    monitor: Monitor,
    state: MonitorState,
    experiment: Experiment,
    rows: Rows,
    values: dict[str, np.ndarray | float] | None = None,
) -> Steps[MonitorState]:
    """Return the monitor's state after recorded rows; `values`: signals along them by name, if they are available."""
    signals = values or row_values(experiment, rows.index, rows.plant, rows.loop)
    table = monitor.filter.table(rows.index, rows.y, signals, experiment.signals, experiment.measurement)
    return (yield from monitor.advance(state, table, rows.index * experiment.step))


def with_noise_of(detector: Detector, experiment: Experiment, doubt: float) -> Detector:
    """Return the detector with a filter for the experiment's present noise, which may have changed during the run."""
    old, new = detector.filter.experiment.measurement, experiment.measurement.modelled
    if (old.std, old.sample_time, old.samplings) == (new.std, new.sample_time, new.samplings):
        return detector
    filter_ = InnovationFilter(experiment, detector.filter.context, doubt)
    return Detector(filter_, detector.thresholds, detector.stride)


def diagnose(parts: Parts, columns: dict[str, np.ndarray], request: DiagnosisRequest) -> Steps[RunDiagnosis]:
    """Return the diagnosis of a run.

    Args:
        parts: its spans, each with the experiment as it was then.
        columns: the columns of its result by name (rows,).
        request: the settings.
    """
    first = replace(parts[0][0].modelled, steps=request.steps)
    detector, state, note = None, None, unwatchable(first, first.context)
    if note is None:
        try:
            detector = yield from prepare_detector(first, first.context, request.detector, request.key)
            state = yield from _monitor_run(detector, parts, request.detector.doubt)
        except Unwatchable as error:
            detector, note = None, error.reason
    stride = detector.stride if detector else max(1, first.steps // first.every // 1000)
    observers = yield from _diagnose_estimates(first, columns, request, stride)
    return RunDiagnosis(detector, state, observers, stride * first.every * first.step, note)


def _monitor_run(detector: Detector, parts: Parts, doubt: float) -> Steps[MonitorState]:
    """Return the detector's state after a run, or after its last row of finite measurements."""
    state = detector.begin()
    for experiment, rows in parts:
        finite = np.asarray(np.isfinite(rows.y).all(axis=1))
        count = int(np.argmin(finite)) if not finite.all() else len(finite)
        monitor = with_noise_of(detector, experiment, doubt)
        state = yield from advance_over_rows(monitor, state, experiment, rows.part(0, count))
        if count < len(finite):
            break
    return state


# ---- observers' own estimates ----------------------------------------------------------------------------------------


def _diagnose_estimates(
    first: Experiment, columns: dict[str, np.ndarray], request: DiagnosisRequest, stride: int
) -> Steps[tuple[EstimateDiagnosis, ...]]:
    """Return the diagnosis by each observer's estimates; observers that were added later have none."""
    tested = [e for e in first.estimators if has_spread(e) and e.since == 0]
    tests: dict[str, CalibratedTest] = {}
    if tested:
        tests = yield from _calibrated_tests(first, request, stride)
    diagnoses = []
    for estimator in first.estimators:
        label, channels = estimator.label, estimator.channels
        if estimator not in tested:
            diagnoses.append(EstimateDiagnosis(label, channels, note=Message("diagnosis.none.no-estimate")))
            continue
        theta, sigma = (
            _thinned([columns[f"{label}.{kind}.{c}"] for c in channels], stride) for kind in ("theta", "sigma")
        )
        alarms = observer_tests.alarms(_normalised(theta, sigma), tests[label])
        typical = tuple(typical_sizes(estimator.context))
        estimates = TestedEstimates(tuple(alarms), tests[label], theta, sigma, typical)
        diagnoses.append(EstimateDiagnosis(label, channels, estimates))
    return tuple(diagnoses)


def _calibrated_tests(first: Experiment, request: DiagnosisRequest, stride: int) -> Steps[dict[str, CalibratedTest]]:
    """Return the test of each observer's estimates by label, from the cache or from runs without faults."""
    name = stored_name(request.estimates_key)
    stored = cache.read("judgement", name)
    if stored is not None:
        return {label: CalibratedTest.from_json(data) for label, data in json.loads(stored).items()}
    interval, rate = stride * first.every * first.step, request.detector.false_alarms
    tests = {}
    runs = yield from _healthy_runs(first, stride)
    for label, (theta, sigma) in runs.items():
        z = _normalised(theta, sigma)
        tests[label] = observer_tests.prepare(z, request.test, interval, rate, _start_of_test(z))
    cache.write("judgement", name, json.dumps({label: test.to_json() for label, test in tests.items()}).encode())
    return tests


def _thinned(rows: Sequence[np.ndarray], stride: int) -> np.ndarray:
    """Return columns at decisions (decisions, channels)."""
    return np.stack([c[stride - 1 :: stride] for c in rows], axis=-1)


def _normalised(theta: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Return θ/σ, 0 where σ is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(sigma > 0, theta / sigma, 0.0)


def _start_of_test(z: np.ndarray) -> int:
    """Return the decision from which on estimates without faults (runs, decisions, channels) have settled to their
    noise."""
    size = np.nanmax(np.nan_to_num(np.abs(z)), axis=(0, 2))
    count = len(size)
    loud = np.flatnonzero(size[: count // 2] > 1.5 * max(float(np.max(size[count // 2 :], initial=0.0)), 1.0))
    return min(count // 2, (int(loud[-1]) + 1 if len(loud) else 0) + max(2, count // 50))


Estimates = dict[str, tuple[np.ndarray, np.ndarray]]  # θ̂ − θ and σ by observer


def _healthy_runs(first: Experiment, stride: int) -> Steps[Estimates]:
    """Return θ̂ − θ and σ (runs, decisions, channels) of runs without faults, one run per step."""
    plain = replace(healthy(first), estimators=first.estimators, steps=min(first.steps, _STEPS))
    count = int(np.clip(_TOTAL // max(plain.steps, 1), *_RUNS))
    runs, repeated = [], Repeated()
    for k in range(count):
        yield
        runs.append(_estimates(with_seed(plain, _SEED + k), stride, repeated))
    return {
        label: (np.stack([run[label][0] for run in runs]), np.stack([run[label][1] for run in runs]))
        for label in runs[0]
    }


def _estimates(experiment: Experiment, stride: int, repeated: Repeated) -> Estimates:
    """Return θ̂ − θ and σ (decisions, channels) of one simulated run."""
    theta: dict[str, list[np.ndarray]] = {}
    spreads: Spreads = {}
    sigma: dict[str, list[np.ndarray]] = {}
    for rows in repeated.spans(experiment):
        values = row_values(experiment, rows.index, rows.plant, rows.loop)
        columns, tables = sigma_columns(experiment, rows, values, spreads)
        spreads = latest(tables)
        for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
            if has_spread(estimator):
                theta.setdefault(estimator.label, []).append(_errors(estimator, states, values))
                deviations = [columns[f"{estimator.label}.sigma.{c}"] for c in estimator.channels]
                sigma.setdefault(estimator.label, []).append(np.stack(deviations, axis=1))
    return {
        label: (np.concatenate(theta[label])[stride - 1 :: stride], np.concatenate(sigma[label])[stride - 1 :: stride])
        for label in theta
    }


def _errors(estimator: Estimator, states: np.ndarray, values: dict[str, np.ndarray | float]) -> np.ndarray:
    """Return θ̂ − θ (rows, channels) from an observer's states (rows, states)."""
    place = {s: i for i, s in enumerate(estimator.program.states)}
    errors = [states[:, place[f"thetah.{c}"]] - values[f"theta.{c}"] for c in estimator.channels]
    return np.stack(errors, axis=1)
