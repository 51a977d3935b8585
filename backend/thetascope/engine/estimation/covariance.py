"""The uncertainty of θ̂ along recorded rows: propagate the companion's covariance S over spans of rows.

The numbers do not depend on how the rows are divided into spans.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import NEVER, Kernel, Layout, Segments, kernel
from thetascope.engine.compiler.system import Program
from thetascope.engine.estimation.covariance_equations import Shape, companion, shape_of
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import output_scales, state_scales, typical_sizes
from thetascope.engine.observers.support.time_constant import pace
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.simulation.experiment import Estimator, Experiment, Rows

QUIET = 1e-3  # of an output's scale: the noise assumed where none is declared
WIDEST = 10.0  # typical faults: the largest reported standard deviation
_RATE = 2.0  # largest ‖A‖·h in a Runge–Kutta step of S; relative to 1 this changed σ by at most 2e-5 in tests
_PIECES = 64  # most steps between two rows

Spreads = dict[tuple[str, int], np.ndarray]
"""S by observer: its label, and the base step at which it was added."""


def noise_stds(measurement: Measurement, context: Context) -> np.ndarray:
    """Return the standard deviation of each output's noise: as declared, else a thousandth of the output's scale."""
    declared = np.array(measurement.std)
    if (declared > 0).all():
        return declared
    return np.where(declared > 0, declared, QUIET * np.array(output_scales(context)))


def holds(measurement: Measurement, step: float) -> np.ndarray:
    """Return the hold time in s of each output's noise: its sample time, or the measurement's sample interval."""
    every = measurement.sample_every
    return np.maximum(measurement.sample_time, 0.0 if every is None else every * step)


def has_spread(estimator: Estimator) -> bool:
    """Return whether the observer has a θ̂ whose covariance can be computed."""
    return bool(estimator.channels) and bool(_plan(estimator.program).shape.theta)


def first_spread(estimator: Estimator) -> np.ndarray:
    """Return the initial S: the first estimates deviate by a state's scale and by a typical fault."""
    first = _scales(estimator)[0] ** 2
    return np.concatenate([np.diag(first)[np.triu_indices(len(first))], np.zeros(len(estimator.channels))])


def sigma_columns(
    experiment: Experiment, rows: Rows, values: dict, before: Spreads
) -> tuple[dict[str, np.ndarray], Spreads]:
    """Return columns ``L.sigma.<channel>`` along the rows, and each observer's S at the rows and after them (rows + 1).

    ``values``: t, signals and parameters along these very rows (simulation.row_values); observers without an S
    ``before`` begin here.
    """
    columns: dict[str, np.ndarray] = {}
    tables: Spreads = {}
    for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
        if not has_spread(estimator):
            continue
        key = (estimator.label, estimator.since)
        S = before[key] if key in before else first_spread(estimator)
        tables[key], sigma = _spread(experiment, estimator, S, rows, states, values)
        columns |= {f"{estimator.label}.sigma.{c}": v for c, v in zip(estimator.channels, sigma, strict=True)}
    return columns, tables


def latest(tables: Spreads) -> Spreads:
    """Return S after the last of the rows."""
    return {key: table[-1] for key, table in tables.items()}


@dataclass(frozen=True)
class _Plan:
    """Everything that calls share: the companion, its kernel, its inputs, the positions of the variances."""

    shape: Shape
    program: Program
    kernel: Kernel | None  # None for an observer that estimates no faults
    held: tuple[str, ...]
    params: tuple[str, ...]
    slopes: tuple[str, ...]
    wanted: tuple[str, ...]
    places: dict[str, int]  # position of each state of the observer
    variances: np.ndarray


@lru_cache(maxsize=128)
def _plan(observer: Program) -> _Plan:
    shape = shape_of(observer)
    if not shape.theta:
        return _Plan(shape, observer, None, (), (), (), (), {}, np.empty(0))
    program = companion(observer)
    n, size = len(shape.x), len(shape.x) + len(shape.theta)
    held = tuple(sorted(variables(program.graph, program.update) & set(program.inputs)))
    layout = Layout(held=held)
    slopes = tuple(f"slope.{i}.{j}" for i in range(size) for j in range(size))
    slope_inputs = variables(program.graph, [program.outputs[s] for s in slopes]) & set(program.inputs)
    i, j = np.triu_indices(size)
    return _Plan(
        shape,
        program,
        kernel(program, layout),
        held,
        layout.shared_params(program),
        slopes,
        tuple(sorted({*held, *slope_inputs})),
        {s: k for k, s in enumerate(observer.states)},
        np.flatnonzero((i == j) & (i >= n)),
    )


def _spread(
    experiment: Experiment, estimator: Estimator, S: np.ndarray, rows: Rows, states: np.ndarray, values: dict
) -> tuple[np.ndarray, np.ndarray]:
    """Return S at the rows and after them, and the standard deviations of θ̂ at the rows (p × rows)."""
    plan, index, count = _plan(estimator.program), rows.index, len(rows.index)
    inputs = _seen(plan, experiment, estimator, rows, states, values)
    interval = experiment.every * experiment.step
    if estimator.every is None:
        counts = _pieces(plan, estimator, inputs, interval, count)
        h = interval / counts
    else:
        counts = (index + experiment.every) // estimator.every - index // estimator.every
        h = np.full(count, estimator.context.period)
    moving = np.flatnonzero(counts)
    table = np.empty((count + 1, len(S)))
    table[0] = S
    if len(moving) == count:
        _carry(plan, S, index * experiment.step, counts, h, inputs, slice(None), table[1:])
    else:
        out = np.empty((len(moving) + 1, len(S)))
        out[0] = S
        if len(moving):
            _carry(plan, S, index[moving] * experiment.step, counts[moving], h[moving], inputs, moving, out[1:])
        table[:] = out[np.searchsorted(moving, np.arange(count + 1))]  # S after all steps before each row
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(np.maximum(table[:-1, plan.variances].T, 0.0))
    return table, np.minimum(sigma, WIDEST * _scales(estimator)[1][:, None])


def _seen(
    plan: _Plan, experiment: Experiment, estimator: Estimator, rows: Rows, states: np.ndarray, values: dict
) -> dict:
    """Return the inputs of the companion along the rows: the observer's states and inputs, its gains, the noise."""
    outputs = {name: k for k, name in enumerate(experiment.plant.outputs)}
    inputs = dict(estimator.parameters) | {"t": values["t"]} | _noise(experiment, estimator)
    for name in plan.wanted:
        place = plan.places.get(name)
        if place is not None:
            inputs[name] = states[:, place]
            continue
        bare = name.split(".", 1)[1] if name.startswith(("now.", "mid.", "end.")) else name
        inputs[name] = rows.y[:, outputs[bare]] if bare in outputs else values[bare]
    return inputs


def _carry(
    plan: _Plan, S: np.ndarray, t: np.ndarray, steps: np.ndarray, h: np.ndarray, seen: dict, rows, out: np.ndarray
):
    """Write S after each of the given rows into ``out``."""
    held = np.empty((len(t), max(1, len(plan.held))))
    for c, name in enumerate(plan.held):
        held[:, c] = seen[name][rows]
    params = np.array([seen[p] for p in plan.params] or [0.0])
    assert plan.kernel is not None, "an observer without estimates of faults has no covariance"
    plan.kernel(Segments(steps, steps, t, np.zeros(len(t)), h), S.copy(), params, int(NEVER), out, held=held)


def _pieces(plan: _Plan, estimator: Estimator, inputs: dict, interval: float, rows: int) -> np.ndarray:
    """Return the number of Runge–Kutta steps per row that keeps S stable, from the norm of A in units of the scales."""
    scales = _scales(estimator)[0]
    size = len(scales)
    A = np.abs(probe(plan.program, plan.slopes, inputs)).reshape(size, size, rows)
    norm = np.einsum("ijr,ij->ir", A, scales[None, :] / scales[:, None]).max(axis=0)
    steps = np.nan_to_num(interval * norm / _RATE, nan=1.0, posinf=_PIECES)
    return np.clip(np.ceil(steps), 1, _PIECES).astype(np.int64)


_known: dict[int, tuple[Context, tuple[np.ndarray, np.ndarray, float]]] = {}


def _scales(estimator: Estimator) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the scales of (x̂, θ̂) and of θ̂, and the plant's slowest rate; cached per context."""
    context = estimator.context
    cached = _known.get(id(context))
    if cached is None or cached[0] is not context:
        typical = np.array(typical_sizes(context))
        if len(_known) > 512:
            _known.clear()
        cached = _known[id(context)] = (
            context,
            (np.concatenate([state_scales(context), typical]), typical, pace(context.model)),
        )
    return cached[1]


def _noise(experiment: Experiment, estimator: Estimator) -> dict[str, float]:
    """Return the companion's R and ``memory``.

    R is variance times hold time in continuous time, else the variance of one sample. ``memory`` is the rate, per
    second or per sample, at which the recent average h is updated: the plant's slowest rate.
    """
    measurement, period = experiment.measurement, estimator.context.period
    variance, hold = noise_stds(measurement, estimator.context) ** 2, holds(measurement, experiment.step)
    R = variance * (hold if estimator.every is None else np.maximum(1.0, hold / period))
    rate = _scales(estimator)[2]
    memory = rate if estimator.every is None else min(1.0, rate * period)
    return {f"intensity.{k}": float(r) for k, r in enumerate(R)} | {"memory": memory}
