"""The detector of an experiment: a monitor with thresholds that give the accepted rate of false alarms.

It uses the measurements, not the observers' estimates, so its findings do not depend on how observers are tuned.
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
from thetascope.diagnosis.yield_points import Steps
from thetascope.engine.compiler import cache
from thetascope.engine.errors import Unwatchable
from thetascope.engine.estimation.covariance import noise_stds
from thetascope.engine.inputs.signals import constant
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.simulation.batch import with_seed
from thetascope.engine.simulation.controlled import Repeated
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.loop import LoopRows
from thetascope.engine.simulation.simulation import row_values
from thetascope.messages import Message

DECISIONS = 2000  # in the horizon, about
SEEDS = (32, 64)  # runs without faults: at least, and at most
LEAST_ROWS = 100  # of a run that can be diagnosed
_STEPS = 500_000  # base steps of all these runs together, about
_LONGEST = 200_000  # base steps of one of them, at most
_SEED = 7_001  # of the first
_SAMPLES = 2_000  # rows at which inputs are sampled
_UNRECORDED = 0.5  # share of an input's variation that may occur between rows


@dataclass(frozen=True)
class DetectorSettings:
    """Settings of the detector.

    Attributes:
        false_alarms: accepted false alarms per hour.
        doubt: see `InnovationFilter`.
    """

    false_alarms: float
    doubt: float


class Detector(Monitor):
    """A monitor prepared for an experiment; `interval`: time between decisions, s."""

    def __init__(self, filter_: InnovationFilter, thresholds: Thresholds, stride: int):
        super().__init__(filter_, thresholds, stride)
        self.interval = stride * filter_.interval


def unwatchable(experiment: Experiment, context: Context) -> Message | None:
    """Return why an experiment cannot be diagnosed, or None if it can."""
    experiment = experiment.modelled
    if not any(name.startswith("theta.") for name in experiment.plant.inputs):
        return Message("diagnosis.none.no-channels")
    if context.n > MOST_STATES:
        return Message("diagnosis.none.too-many-states", states=context.n, most=MOST_STATES)
    if experiment.steps // experiment.every < LEAST_ROWS:
        return Message("diagnosis.none.too-few-rows", least=LEAST_ROWS)
    signal = _undersampled_signal(experiment)
    if signal:
        return Message("diagnosis.none.undersampled", signal=signal, interval=experiment.every * experiment.step)
    return None


def _undersampled_signal(experiment: Experiment) -> str:
    """Return the first input or known signal that varies too much between rows, of which only the first value is used;
    or ""."""
    row = experiment.every * experiment.step
    rows = experiment.steps // experiment.every
    start = row * np.unique(np.linspace(0, rows - 1, _SAMPLES).astype(int))
    between = start + row * np.random.default_rng(0).random(len(start))
    for name, signal in experiment.signals.items():
        if name.startswith(("theta.", "r.")):
            continue
        recorded, actual = signal(start, np.nextafter(start, np.inf)), signal(between, between)
        if np.std(actual - recorded) > _UNRECORDED * max(np.std(actual), 1e-9 * np.max(np.abs(actual))):
            return name.split(".", 1)[1]
    return ""


def prepare_detector(experiment: Experiment, context: Context, settings: DetectorSettings, key: str) -> Steps[Detector]:
    """Return the detector for an experiment; its thresholds come from the cache or from simulations.

    Args:
        experiment: the experiment as it begins; of a true plant, its model.
        context: that of its plant, with all fault channels.
        settings: the settings of the detector.
        key: a hash of everything that the thresholds depend on; empty: do not cache.

    Raises:
        Unwatchable: the filter does not stay finite in runs without faults.
    """
    experiment = experiment.modelled
    stride = _stride(experiment)
    filter_ = InnovationFilter(experiment, context, settings.doubt)
    thresholds = _stored(key) if key else None
    if thresholds is None or thresholds.noise.v.shape[1] != filter_.p:
        thresholds = yield from _simulate_thresholds(experiment, filter_, settings, stride, _theta_bounds(context))
        if key:
            cache.write("calibration", stored_name(key), _packed(thresholds))
    return Detector(filter_, thresholds, stride)


def _stride(experiment: Experiment) -> int:
    """Return the rows in one decision: about DECISIONS in the horizon, and at least 200 in a simulated run."""
    rows = experiment.steps // experiment.every
    simulated = min(experiment.steps, _LONGEST) // experiment.every
    return max(1, min(rows // DECISIONS, simulated // 200))


def _theta_bounds(context: Context) -> ThetaBounds:
    limits = [c.get("bounds") or (None, None) for c in context.model["channels"]]
    return ThetaBounds(
        np.array([-np.inf if low is None else low for low, _ in limits]),
        np.array([np.inf if high is None else high for _, high in limits]),
        np.array([float(c.get("typical", 1.0)) for c in context.model["channels"]]),
    )


# ---- runs without faults ---------------------------------------------------------------------------------------------


def healthy(experiment: Experiment) -> Experiment:
    """Return the experiment without observers and without faults that begin after t = 0; earlier ones belong to the
    plant."""
    at = np.zeros(1), np.full(1, 1e-4 * experiment.step)
    constant_faults = {n: constant(float(s(*at)[0])) for n, s in experiment.signals.items() if n.startswith("theta.")}
    return replace(
        experiment,
        estimators=(),
        signals=experiment.signals | constant_faults,
        measurement=replace(experiment.measurement, faults=()),
    )


def _simulate_thresholds(
    experiment: Experiment, filter_: InnovationFilter, settings: DetectorSettings, stride: int, bounds: ThetaBounds
) -> Steps[Thresholds]:
    """Return thresholds from simulated runs without faults, one seed per step."""
    plain = _noisy(replace(healthy(experiment), steps=min(experiment.steps, _LONGEST)), filter_)
    seeds = int(np.clip(_STEPS // max(plain.steps, 10 * plain.steps // plain.every), *SEEDS))
    known = np.array([float(plain.signals[c](np.zeros(1), np.zeros(1))[0]) for c in filter_.channels])
    runs, settle, ready, count, repeated = [], 0, 0, 0, Repeated()
    for seed in range(seeds):
        yield
        table, t = _filter_inputs(with_seed(plain, _SEED + seed), filter_, repeated)
        run = filter_.run(filter_.start(), known, table, t)
        count = len(t) // stride
        rows = count * stride
        omega = run.omega[:rows].reshape(count, stride, filter_.m, filter_.p)
        nu = run.nu[:rows].reshape(count, stride, filter_.m)
        runs.append(WindowSums.empty(filter_.p, filter_.m).extended(omega, nu))
        if seed == seeds - 1:
            settle = _settling_rows(filter_, known, table, t, run.states) // stride
            ready = -(-_rows_until_settled_covariance(filter_, run.states) // stride)
    runs = [r for r in runs if np.isfinite(r.q).all()]
    if len(runs) < seeds // 2:
        raise Unwatchable(Message("diagnosis.none.filter-diverges"))
    settle = int(np.clip(settle, 2, max(2, count // 20)))
    return calibrate(runs, stride * filter_.interval, settings.false_alarms, settle, bounds, ready)


def _noisy(experiment: Experiment, filter_: InnovationFilter) -> Experiment:
    """Return the experiment with assumed noise where none is declared, so that thresholds are never zero."""
    m = experiment.measurement
    hold = [t if std > 0 else filter_.interval for t, std in zip(m.sample_time, m.std, strict=True)]
    std = tuple(float(s) for s in noise_stds(m, filter_.context))
    return replace(experiment, measurement=replace(m, std=std, sample_time=tuple(hold)))


def _filter_inputs(
    experiment: Experiment, filter_: InnovationFilter, repeated: Repeated
) -> tuple[np.ndarray, np.ndarray]:
    """Return the filter's inputs (rows, inputs) and times (rows,) of a simulated run."""
    parts = list(repeated.spans(experiment))
    index = np.concatenate([r.index for r in parts])
    loops = [r.loop for r in parts if r.loop is not None]
    loop = LoopRows.concatenated(loops) if loops else None
    values = row_values(experiment, index, np.concatenate([r.plant for r in parts]), loop)
    return filter_.table(
        index, np.concatenate([r.y for r in parts]), values, experiment.signals
    ), index * experiment.step


def _settling_rows(
    filter_: InnovationFilter, known: np.ndarray, table: np.ndarray, t: np.ndarray, states: np.ndarray
) -> int:
    """Return the rows after which Ω of a fault that has just begun is within half of Ω of an old one (median over
    channels)."""
    half = len(t) // 2
    recent = filter_.run(filter_.without_sensitivity(states[half - 1]), known, table[half:], t[half:]).omega
    old = filter_.run(states[half - 1], known, table[half:], t[half:]).omega
    size = np.abs(old).sum(axis=1)
    apart = np.abs(recent - old).sum(axis=1) > 0.5 * np.maximum(size, np.median(size, axis=0))
    return int(np.median(np.argmin(apart, axis=0)))


def _rows_until_settled_covariance(filter_: InnovationFilter, states: np.ndarray) -> int:
    """Return the rows after which all variances are at most 10 % above those of the second half.

    A large initial variance makes the estimate drift slowly, which resembles a slow fault.
    """
    variances = filter_.variances(states)
    late = variances[len(states) // 2 :].max(axis=0)
    unsettled = np.flatnonzero((variances > 1.1 * late).any(axis=1))
    return int(unsettled[-1]) + 1 if len(unsettled) else 0


# ---- cache -----------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def _source() -> str:
    """Return a hash of the source that thresholds depend on."""
    return f"{cache.package_digest()} {cache.digest_of(Path(__file__).parents[1])}"


def stored_name(key: str) -> str:
    """Return the file name of a cached calibration; it changes with the source code."""
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
        typical=c.bounds.typical,
        numbers=[c.glr, c.residual, c.hours, c.rate],
        counts=[c.begin, c.settle, c.seeds, c.noise.ready],
    )
    return file.getvalue()


def _stored(key: str) -> Thresholds | None:
    """Return cached thresholds, or None."""
    data = cache.read("calibration", stored_name(key))
    if data is None:
        return None
    with np.load(io.BytesIO(data), allow_pickle=False) as a:
        glr, residual, hours, rate = (float(v) for v in a["numbers"])
        begin, settle, seeds, ready = (int(v) for v in a["counts"])
        noise = WindowNoise(a["lengths"], a["v"], a["largest_v"], a["early_v"], ready, a["energy"], a["energy_std"])
        return Thresholds(
            noise, ThetaBounds(a["low"], a["high"], a["typical"]), glr, residual, begin, settle, seeds, hours, rate
        )
