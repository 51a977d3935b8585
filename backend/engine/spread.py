"""How sure θ̂ is, along recorded rows: the companion's covariance S carried a stretch at a time, the same however it is cut."""

import numpy as np

from backend.engine.companion import companion, shape_of
from backend.engine.graph import variables
from backend.engine.kernel import NEVER, Layout, Segments, kernel
from backend.engine.measurement import Measurement
from backend.engine.observers.base import Context
from backend.engine.observers.pace import pace
from backend.engine.observers.weights import output_scales, state_scales, typical_sizes
from backend.engine.probe import probe
from backend.engine.simulation import Estimator, Experiment, Rows, observed_values
from backend.engine.system import Program

QUIET = 1e-3  # of an output's scale: the noise that is assumed where none is declared
WIDEST = 10.0  # typical faults: the widest that a band is said to be
_RATE = 1.0  # of ‖A‖·h in one Runge–Kutta step of S
_PIECES = 64  # steps between two rows at most


def noise_stds(measurement: Measurement, context: Context) -> np.ndarray:
    """Standard deviation of each output's noise: as declared, else a thousandth of the output's scale."""
    declared = np.array(measurement.std)
    return np.where(declared > 0, declared, QUIET * np.array(output_scales(context)))


def holds(measurement: Measurement, step: float) -> np.ndarray:
    """Seconds for which one value of each output's noise holds: its sample time, or the sampling of the measurement."""
    every = measurement.sample_every
    return np.maximum(measurement.sample_time, 0.0 if every is None else every * step)


def has_spread(estimator: Estimator) -> bool:
    """Whether there is a θ̂ whose covariance can be followed."""
    return bool(estimator.channels) and bool(shape_of(estimator.program).theta)


def first_spread(estimator: Estimator) -> np.ndarray:
    """S at the start: how far the first estimates may be off, a state's scale and a typical fault."""
    first = _scales(estimator) ** 2
    return np.concatenate([np.diag(first)[np.triu_indices(len(first))], np.zeros(len(estimator.channels))])


Spreads = dict[tuple[str, int], np.ndarray]
"""S by observer: its label, and the base step at which it began to watch."""


def sigma_columns(experiment: Experiment, rows: Rows, values: dict, before: Spreads) -> tuple[dict[str, np.ndarray], Spreads]:
    """Columns ``L.sigma.<channel>`` of every observer of θ along recorded rows, and S of each after them.

    ``values``: t, signals and parameters along these very rows (simulation.row_values); observers without an S
    ``before`` begin here.
    """
    columns: dict[str, np.ndarray] = {}
    after: Spreads = {}
    for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
        if not has_spread(estimator):
            continue
        key = (estimator.label, estimator.since)
        seen = observed_values(experiment, estimator.parameters, values, rows.y)
        seen |= {s: states[:, j] for j, s in enumerate(estimator.program.states)}
        S = before[key] if key in before else first_spread(estimator)
        after[key], sigma = spread(experiment, estimator, S, rows.index, seen)
        columns |= {f"{estimator.label}.sigma.{c}": v for c, v in zip(estimator.channels, sigma, strict=True)}
    return columns, after


def _scales(estimator: Estimator) -> np.ndarray:
    return np.concatenate([state_scales(estimator.context), typical_sizes(estimator.context)])


def spread(
    experiment: Experiment, estimator: Estimator, S: np.ndarray, index: np.ndarray, seen: dict
) -> tuple[np.ndarray, np.ndarray]:
    """Carry S over rows (base steps ``index``): S after them, and the standard deviations of θ̂ at them (p × rows).

    ``seen``: what the observer saw and was along the rows, one array or number a name.
    """
    program, shape = companion(estimator.program), shape_of(estimator.program)
    rows = len(index)
    seen = seen | _intensities(experiment, estimator) | {"memory": _memory(estimator)}
    if estimator.every is None:
        counts = _pieces(program, estimator, seen, experiment.every * experiment.step, rows)
        h = experiment.every * experiment.step / counts
    else:
        every = experiment.every
        counts = (index + every) // estimator.every - index // estimator.every
        h = np.full(rows, estimator.context.period)
    moving = np.flatnonzero(counts)
    table = np.repeat(S[None, :], rows + 1, axis=0)
    if len(moving):
        out = _carried(program, S, index[moving] * experiment.step, counts[moving], h[moving], seen, moving)
        last = np.searchsorted(moving, np.arange(rows + 1)) - 1  # the latest move before each row
        table[last >= 0] = out[last[last >= 0]]
    n, p = len(shape.x), len(shape.theta)
    i, j = np.triu_indices(n + p)
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(np.maximum(table[:-1, np.flatnonzero((i == j) & (i >= n))].T, 0.0))
    return table[-1], np.minimum(sigma, WIDEST * np.array(typical_sizes(estimator.context))[:, None])


def _carried(program: Program, S: np.ndarray, t: np.ndarray, steps: np.ndarray, h: np.ndarray, seen: dict, rows: np.ndarray):
    """S after each of the given rows."""
    names = tuple(sorted(variables(program.graph, program.update) & set(program.inputs)))
    held = np.empty((len(rows), max(1, len(names))))
    for c, name in enumerate(names):
        value = np.asarray(seen[name])
        held[:, c] = value if value.ndim == 0 else value[rows]
    layout = Layout(held=names)
    params = np.array([_number(seen[p]) for p in layout.shared_params(program)] or [0.0])
    out = np.empty((len(rows), len(S)))
    segments = Segments(steps, steps, t, np.zeros(len(rows)), h)
    kernel(program, layout)(segments, S.copy(), params, int(NEVER), out, held=held)
    return out


def _number(value: np.ndarray | float) -> float:
    return float(value if np.ndim(value) == 0 else value[-1])


def _pieces(program: Program, estimator: Estimator, seen: dict, interval: float, rows: int) -> np.ndarray:
    """Runge–Kutta steps from each row to the next, so that S stays stable: by the norm of A in units of the scales."""
    scales = _scales(estimator)
    size = len(scales)
    A = probe(program, [f"slope.{i}.{j}" for i in range(size) for j in range(size)], seen).reshape(size, size, rows)
    norm = (np.abs(A) * scales[None, :, None] / scales[:, None, None]).sum(axis=1).max(axis=0)
    wanted = np.nan_to_num(interval * norm / _RATE, nan=1.0, posinf=_PIECES)
    return np.clip(np.ceil(wanted), 1, _PIECES).astype(np.int64)


def _memory(estimator: Estimator) -> float:
    """How fast "lately" moves on: at the plant's own pace, per second; per sample for observers at a sample period."""
    rate = pace(estimator.context.model)
    return rate if estimator.every is None else min(1.0, rate * estimator.context.period)


def _intensities(experiment: Experiment, estimator: Estimator) -> dict[str, float]:
    """R of the companion: variance times hold in continuous time; the variance of one sample otherwise."""
    measurement = experiment.measurement
    variance, hold = noise_stds(measurement, estimator.context) ** 2, holds(measurement, experiment.step)
    R = variance * (hold if estimator.every is None else np.maximum(1.0, hold / estimator.context.period))
    return {f"intensity.{k}": float(r) for k, r in enumerate(R)}
