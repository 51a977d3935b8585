"""A finished run diagnosed: what the detector finds in what was measured, and what each observer's estimates show."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.evaluation import observer_tests
from thetascope.diagnosis.monitor.detector import Asked, Detector, detector, healthy, kept_name, unwatchable
from thetascope.diagnosis.monitor.monitor import Watched, Watcher
from thetascope.diagnosis.residuals.innovation_filter import Filter
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
class Wanted:
    """What is asked: of the detector (`Asked`), and which test is to look at observers' estimates.

    ``key``: a hash of what the detector's calibration depends on; ``own_key``: of what that of the observers' tests does;
    ``steps``: base steps that thresholds are simulated over.
    """

    detector: Asked
    test: str
    key: str
    own_key: str
    steps: int


@dataclass(frozen=True)
class Own:
    """What the tests found in one observer's estimates; ``note``: why there is nothing."""

    label: str
    channels: tuple[str, ...]
    raised: tuple[observer_tests.Raised, ...] = ()
    judged: observer_tests.Judged | None = None
    theta: np.ndarray | None = None  # decisions × channels
    sigma: np.ndarray | None = None
    typical: tuple[float, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Diagnosed:
    """``detector`` and what it watched; None with a ``note`` where the experiment cannot be watched. What else is to be known of how it
    was watched is in ``note``, too."""

    detector: Detector | None
    watched: Watched | None
    observers: tuple[Own, ...]
    interval: float  # s between decisions
    note: str = ""


def follow(made: Watcher, watched: Watched, experiment: Experiment, rows: Rows, values: dict | None = None) -> Watched:
    """The watcher taken over recorded rows of an experiment; ``values``: signals along them, where they are known."""
    values = values or row_values(experiment, rows.index, rows.plant)
    return made.advance(watched, made.filter.table(rows.index, rows.y, values), rows.index * experiment.step)


def refitted(made: Detector, experiment: Experiment, doubt: float) -> Detector:
    """The detector with its filter for an experiment whose noise has been changed while it ran."""
    old = made.filter.experiment
    if (old.measurement.std, old.measurement.sample_time) == (
        experiment.measurement.std,
        experiment.measurement.sample_time,
    ):
        return made
    return Detector(Filter(experiment, experiment.context, doubt), made.calibrated, made.stride)


def diagnose(parts: Parts, columns: dict[str, np.ndarray], substeps: int, wanted: Wanted) -> Diagnosed:
    """Diagnose a run from its spans; ``columns`` are those of its result."""
    first = replace(parts[0][0], steps=wanted.steps)
    made, watched, note = None, None, unwatchable(first, first.context)
    if not note:
        try:
            made = detector(first, first.context, wanted.detector, wanted.key)
            watched = _watched(made, parts, wanted.detector.doubt)
        except Unwatchable as error:
            made, note = None, str(error)
    stride = made.stride if made else max(1, first.steps // first.every // 1000)
    interval = stride * first.every * first.step
    return Diagnosed(made, watched, _own(first, columns, substeps, wanted, stride), interval, note)


def _watched(made: Detector, parts: Parts, doubt: float) -> Watched:
    watched = made.begin()
    for experiment, rows in parts:
        finite = np.isfinite(rows.y).all(axis=1)
        count = int(np.argmin(finite)) if not finite.all() else len(finite)
        watched = follow(refitted(made, experiment, doubt), watched, experiment, rows.part(0, count))
        if count < len(finite):
            break
    return watched


# ---- observers' own estimates --------------------------------------------------------------------------------------------


def _own(first: Experiment, columns: dict, substeps: int, wanted: Wanted, stride: int) -> tuple[Own, ...]:
    watching = [e for e in first.estimators if has_spread(e) and e.since == 0]
    judgements = _judgements(first, watching, substeps, wanted, stride) if watching else {}
    found = []
    for estimator in first.estimators:
        label, channels = estimator.label, estimator.channels
        if estimator not in watching:
            found.append(Own(label, channels, note="it estimates no fault"))
            continue
        theta, sigma = (
            _thinned([columns[f"{label}.{what}.{c}"] for c in channels], stride) for what in ("theta", "sigma")
        )
        raised = observer_tests.alarms(_scaled(theta, sigma), judgements[label])
        typical = tuple(typical_sizes(estimator.context))
        found.append(Own(label, channels, tuple(raised), judgements[label], theta, sigma, typical))
    return tuple(found)


def _judgements(
    first: Experiment, watching: list[Estimator], substeps: int, wanted: Wanted, stride: int
) -> dict[str, observer_tests.Judged]:
    """The calibrated test of every observer's estimates: kept on disk, else from runs without faults."""
    name = kept_name(wanted.own_key)
    stored = cache.read("judgement", name)
    if stored is not None:
        return {label: observer_tests.Judged.from_json(data) for label, data in json.loads(stored).items()}
    interval = stride * first.every * first.step
    made = {}
    for label, (theta, sigma) in _quiet(first, substeps, stride).items():
        z = _scaled(theta, sigma)
        made[label] = observer_tests.prepare(z, wanted.test, interval, wanted.detector.false_alarms, _calm(z))
    cache.write("judgement", name, json.dumps({label: j.to_json() for label, j in made.items()}).encode())
    return made


def _thinned(rows: Sequence[np.ndarray], stride: int) -> np.ndarray:
    """Columns at decisions: decisions × channels."""
    return np.stack([c[stride - 1 :: stride] for c in rows], axis=-1)


def _scaled(theta: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(sigma > 0, theta / sigma, 0.0)


def _calm(z: np.ndarray) -> int:
    """The decision from which on estimates of runs without faults stay within what noise explains."""
    size = np.nanmax(np.nan_to_num(np.abs(z)), axis=(0, 2))
    count = len(size)
    loud = np.flatnonzero(size[: count // 2] > 1.5 * max(float(np.max(size[count // 2 :], initial=0.0)), 1.0))
    return min(count // 2, (int(loud[-1]) + 1 if len(loud) else 0) + max(2, count // 50))


def _quiet(first: Experiment, substeps: int, stride: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
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
