"""The detector of an experiment: the filter for its plant and noise, with thresholds for the false alarms asked for.

It watches what is measured, not the observers: what it finds does not depend on how they are tuned.
"""

import hashlib
import io
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds, calibrate
from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowNoise, WindowSums
from thetascope.diagnosis.monitor.monitor import Monitor
from thetascope.diagnosis.residuals.innovation_filter import MOST_STATES, InnovationFilter
from thetascope.diagnosis.yield_points import pause
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Unwatchable
from thetascope.engine.estimation.covariance import noise_stds
from thetascope.engine.inputs.signals import constant
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.simulation.batch import with_seed
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.simulation import Simulation, row_values

DECISIONS = 2000  # in the horizon, about
SEEDS = (32, 64)  # runs without faults: at least, and at most
_STEPS = 500_000  # base steps that they take together, about
_LONGEST = 200_000  # base steps of one of them
_SEED = 7_001  # the first of theirs
_LOOKS = 2_000  # rows at which inputs are looked at
_UNRECORDED = 0.5  # of what an input does may go on between rows


@dataclass(frozen=True)
class DetectorSettings:
    """What is asked of a detector: false alarms per hour, and the doubt about the model (`InnovationFilter`)."""

    false_alarms: float
    doubt: float


class Detector(Monitor):
    """A watcher made ready for an experiment."""

    def __init__(self, filter_: InnovationFilter, thresholds: Thresholds, stride: int):
        super().__init__(filter_, thresholds, stride)
        self.interval = stride * filter_.interval  # s between decisions


def unwatchable(experiment: Experiment, context: Context) -> str:
    """Why an experiment cannot be watched; empty if it can."""
    if not any(name.startswith("theta.") for name in experiment.plant.inputs):
        return "the plant has no fault channels"
    if context.n > MOST_STATES:
        return f"the plant has {context.n} states, and at most {MOST_STATES} are looked at"
    if experiment.steps // experiment.every < 100:
        return "the run has fewer than a hundred rows"
    missed = _unrecorded(experiment)
    if missed:
        return (
            f"{missed} changes too much between two rows, {experiment.every * experiment.step:g} s apart, of which only the first is "
            "seen: record more often"
        )
    return ""


def _unrecorded(experiment: Experiment) -> str:
    """The first input or known signal whose values at the rows say little about it: what it does within rows, against all that it does."""
    row = experiment.every * experiment.step
    rows = experiment.steps // experiment.every
    start = row * np.unique(np.linspace(0, rows - 1, _LOOKS).astype(int))
    later = start + row * np.random.default_rng(0).random(len(start))
    for name, signal in experiment.signals.items():
        if name.startswith("theta."):
            continue
        seen, there = signal(start, np.nextafter(start, np.inf)), signal(later, later)
        if np.std(there - seen) > _UNRECORDED * max(np.std(there), 1e-9 * np.max(np.abs(there))):
            return name.split(".", 1)[1]
    return ""


def prepare_detector(experiment: Experiment, context: Context, settings: DetectorSettings, key: str) -> Detector:
    """Make the detector for an experiment as it begins. ``key``: what its calibration depends on, as a hash (`cached`)."""
    stride = _stride(experiment)
    filter_ = InnovationFilter(experiment, context, settings.doubt)
    bounds = _theta_bounds(context)
    thresholds = _stored(key) if key else None
    if thresholds is None or thresholds.noise.v.shape[1] != filter_.p:
        thresholds = _simulate_thresholds(experiment, filter_, settings, stride, bounds)
        if key:
            cache.write("calibration", stored_name(key), _packed(thresholds))
    return Detector(filter_, thresholds, stride)


def _stride(experiment: Experiment) -> int:
    """Rows in a decision: about DECISIONS in the horizon, and enough of them in what is simulated."""
    rows = experiment.steps // experiment.every
    simulated = min(experiment.steps, _LONGEST) // experiment.every
    return max(1, min(rows // DECISIONS, simulated // 200))


def _theta_bounds(context: Context) -> ThetaBounds:
    limits = [c.get("bounds") or (None, None) for c in context.model["channels"]]
    return ThetaBounds(
        np.array([-np.inf if low is None else low for low, _ in limits]),
        np.array([np.inf if high is None else high for _, high in limits]),
    )


# ---- without faults ------------------------------------------------------------------------------------------------------


def healthy(experiment: Experiment) -> Experiment:
    """The experiment without observers and without any fault that begins later than at the very start.

    What is there from the first instant on is taken to belong to the plant.
    """
    at = np.zeros(1), np.full(1, 1e-4 * experiment.step)
    still = {n: constant(float(s(*at)[0])) for n, s in experiment.signals.items() if n.startswith("theta.")}
    return replace(
        experiment,
        estimators=(),
        signals=experiment.signals | still,
        measurement=replace(experiment.measurement, faults=()),
    )


def _simulate_thresholds(
    experiment: Experiment, filter_: InnovationFilter, settings: DetectorSettings, stride: int, bounds: ThetaBounds
) -> Thresholds:
    plain = _noisy(replace(healthy(experiment), steps=min(experiment.steps, _LONGEST)), filter_)
    seeds = int(np.clip(_STEPS // max(plain.steps, 10 * plain.steps // plain.every), *SEEDS))
    known = np.array([float(plain.signals[c](np.zeros(1), np.zeros(1))[0]) for c in filter_.channels])
    runs = []
    for seed in range(seeds):
        pause()
        table, t = _rows(with_seed(plain, _SEED + seed), filter_)
        seen = filter_.run(filter_.start(), known, table, t)
        count = len(t) // stride
        rows = count * stride
        omega, nu = (
            seen.omega[:rows].reshape(count, stride, filter_.m, filter_.p),
            seen.nu[:rows].reshape(count, stride, filter_.m),
        )
        runs.append(WindowSums.empty(filter_.p, filter_.m).extended(omega, nu))
    runs = [r for r in runs if np.isfinite(r.q).all()]
    if len(runs) < seeds // 2:
        raise Unwatchable("the filter does not stay finite along this plant's runs")
    settle = _settling_rows(filter_, known, table, t, seen.states) // stride
    ready = -(-_rows_until_sure(filter_, seen.states) // stride)
    return calibrate(
        runs,
        stride * filter_.interval,
        settings.false_alarms,
        int(np.clip(settle, 2, max(2, count // 20))),
        bounds,
        ready,
    )


def _noisy(experiment: Experiment, filter_: InnovationFilter) -> Experiment:
    """With the noise that is assumed where none is declared, so that thresholds are never zero."""
    m = experiment.measurement
    hold = [t if std > 0 else filter_.interval for t, std in zip(m.sample_time, m.std, strict=True)]
    std = tuple(float(s) for s in noise_stds(m, filter_.context))
    return replace(experiment, measurement=replace(m, std=std, sample_time=tuple(hold)))


def _rows(experiment: Experiment, filter_: InnovationFilter) -> tuple[np.ndarray, np.ndarray]:
    """What the filter is given along a run."""
    parts = [rows for _, rows in Simulation(experiment, experiment.substeps or 1).spans(experiment.steps + 1)]
    index = np.concatenate([r.index for r in parts])
    values = row_values(experiment, index, np.concatenate([r.plant for r in parts]))
    return filter_.table(index, np.concatenate([r.y for r in parts]), values), index * experiment.step


def _settling_rows(
    filter_: InnovationFilter, known: np.ndarray, table: np.ndarray, t: np.ndarray, states: np.ndarray
) -> int:
    """Rows after which Ω of a fault that has just begun is that of one that has long been there, within a half."""
    half = len(t) // 2
    fresh = filter_.run(filter_.without_sensitivity(states[half - 1]), known, table[half:], t[half:]).omega
    long = filter_.run(states[half - 1], known, table[half:], t[half:]).omega
    size = np.abs(long).sum(axis=1)
    apart = np.abs(fresh - long).sum(axis=1) > 0.5 * np.maximum(size, np.median(size, axis=0))
    return int(np.median(np.argmin(apart, axis=0)))


def _rows_until_sure(filter_: InnovationFilter, states: np.ndarray) -> int:
    """Rows after which the filter's variances are what they are later, within a tenth: what it is less sure of at first moves slowly,
    and would be taken for a fault that does."""
    variances = filter_.variances(states)
    late = variances[len(states) // 2 :].max(axis=0)
    unsure = np.flatnonzero((variances > 1.1 * late).any(axis=1))
    return int(unsure[-1]) + 1 if len(unsure) else 0


# ---- kept on disk --------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def _source() -> str:
    """Hash of the source that decides calibrations."""
    return f"{cache.package_digest()} {cache.digest_of(Path(__file__).parents[1])}"


def stored_name(key: str) -> str:
    """The name of a file with a calibration: never found again after the code has changed."""
    return hashlib.sha256(f"{key} {_source()}".encode()).hexdigest()


def _packed(c: Thresholds) -> bytes:
    file = io.BytesIO()
    np.savez(
        file,
        lengths=c.noise.lengths,
        v=c.noise.v,
        largest_v=c.noise.largest_v,
        early_v=c.noise.early_v,
        energy=c.noise.energy,
        energy_std=c.noise.energy_std,
        low=c.bounds.low,
        high=c.bounds.high,
        numbers=[c.glr, c.residual, c.hours, c.rate],
        counts=[c.begin, c.settle, c.seeds, c.noise.ready],
    )
    return file.getvalue()


def _stored(key: str) -> Thresholds | None:
    found = cache.read("calibration", stored_name(key))
    if found is None:
        return None
    with np.load(io.BytesIO(found), allow_pickle=False) as a:
        glr, residual, hours, rate = (float(v) for v in a["numbers"])
        begin, settle, seeds, ready = (int(v) for v in a["counts"])
        noise = WindowNoise(a["lengths"], a["v"], a["largest_v"], a["early_v"], ready, a["energy"], a["energy_std"])
        return Thresholds(noise, ThetaBounds(a["low"], a["high"]), glr, residual, begin, settle, seeds, hours, rate)
