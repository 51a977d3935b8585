"""The uncertainty of θ̂ along recorded rows: propagate the companion's covariance S over spans of rows.

The numbers do not depend on how the rows are divided into spans.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.system import Program
from thetascope.engine.estimation.covariance_equations import Shape, companion, shape_of
from thetascope.engine.estimation.discretisation import propagate, transitions
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, state_scales, typical_sizes
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.simulation.experiment import Estimator, Experiment, Rows

QUIET = 1e-3  # of an output's scale: the noise assumed where none is declared
WIDEST = 10.0  # typical faults: the largest reported standard deviation

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
    return np.maximum(measurement.sample_time, [0.0 if s is None else s.every * step for s in measurement.sampled_by])


def has_spread(estimator: Estimator) -> bool:
    """Return whether the observer has a θ̂ whose covariance can be computed."""
    return bool(estimator.channels) and bool(_plan(estimator.program).shape.theta)


def first_spread(estimator: Estimator) -> np.ndarray:
    """Return the initial S: the first estimates deviate by a state's scale and by a typical fault."""
    first = np.array(_scales(estimator)[3]) ** 2
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
    """Everything that calls share: the companion, its outputs and inputs, the positions of the observer's states."""

    shape: Shape
    program: Program
    outputs: tuple[str, ...]  # A and B, row by row
    wanted: tuple[str, ...]  # inputs of the outputs
    places: dict[str, int]

    @property
    def size(self) -> int:
        """Return the number of estimates."""
        return len(self.shape.estimates)


@lru_cache(maxsize=128)
def _plan(observer: Program) -> _Plan:
    shape = shape_of(observer)
    if not shape.theta:
        return _Plan(shape, observer, (), (), {})
    program = companion(observer)
    used = variables(program.graph, list(program.outputs.values())) & set(program.inputs)
    places = {s: k for k, s in enumerate(observer.states)}
    return _Plan(shape, program, tuple(program.outputs), tuple(sorted(used)), places)


def _spread(
    experiment: Experiment, estimator: Estimator, S: np.ndarray, rows: Rows, states: np.ndarray, values: dict
) -> tuple[np.ndarray, np.ndarray]:
    """Return S at the rows and after them, and the standard deviations of θ̂ at the rows (p × rows)."""
    plan, index, count = _plan(estimator.program), rows.index, len(rows.index)
    n, p = plan.size, len(plan.shape.theta)
    scales, typical, slowest, _ = _scales(estimator)
    A, root = _linear(plan, experiment, estimator, _seen(plan, experiment, estimator, rows, states, values), count)
    if estimator.every is None:
        interval, end = experiment.every * experiment.step, 0.5
        steps = np.ones(count, dtype=np.int64)
        F, Q = transitions(A, root, np.full(count, interval))
        memory, follow = slowest, -np.expm1(-slowest * interval)
    else:
        steps = (index + experiment.every) // estimator.every - index // estimator.every
        interval, end, F, Q = 1.0, 0.0, A, root @ root.transpose(0, 2, 1)
        memory = follow = min(1.0, slowest * estimator.context.period)
    W = np.square(root[:, n - p :]).sum(axis=2)
    unit = np.ldexp(1.0, np.frexp(scales)[1])
    in_units = np.concatenate([np.outer(unit, unit)[np.triu_indices(n)], np.ones(p)])
    table = propagate(F, Q, W, S / in_units, steps, (interval, memory, follow, end)) * in_units
    variances = np.flatnonzero(np.equal(*np.triu_indices(n)))[n - p :]
    sigma = np.sqrt(np.maximum(table[:-1, variances].T, 0.0))
    estimates = states[:, [plan.places[s] for s in plan.shape.estimates]]
    sigma[:, ~np.isfinite(estimates).all(axis=1)] = np.nan
    return table, np.minimum(sigma, WIDEST * typical[:, None])


def _seen(
    plan: _Plan, experiment: Experiment, estimator: Estimator, rows: Rows, states: np.ndarray, values: dict
) -> dict:
    """Return the inputs of the companion along the rows: the observer's states and inputs, and its gains."""
    outputs = {name: k for k, name in enumerate(experiment.plant.outputs)}
    inputs = dict(estimator.parameters) | {"t": values["t"]}
    for name in plan.wanted:
        place = plan.places.get(name)
        if place is not None:
            inputs[name] = states[:, place]
            continue
        if name in inputs:
            continue
        bare = name.split(".", 1)[1] if name.startswith(("now.", "mid.", "end.")) else name
        inputs[name] = rows.y[:, outputs[bare]] if bare in outputs else values[bare]
    return inputs


def _linear(
    plan: _Plan, experiment: Experiment, estimator: Estimator, inputs: dict, rows: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return A (rows × n × n) and B R^½ (rows × n × m), in units of the scales; zero in rows without finite values."""
    n = plan.size
    linear = probe(plan.program, plan.outputs, inputs).T
    unit = np.ldexp(1.0, np.frexp(_scales(estimator)[0])[1])
    A = linear[:, : n * n].reshape(rows, n, n) * (unit / unit[:, None])
    root = linear[:, n * n :].reshape(rows, n, -1) * (np.sqrt(_intensity(experiment, estimator)) / unit[:, None])
    lost = ~(np.isfinite(A).all(axis=(1, 2)) & np.isfinite(root).all(axis=(1, 2)))
    if lost.any():
        A[lost] = 0.0 if estimator.every is None else np.eye(n)
        root[lost] = 0.0
    return A, root


_Sizes = tuple[np.ndarray, np.ndarray, float, np.ndarray]
_known: dict[int, tuple[Context, _Sizes]] = {}


def _scales(estimator: Estimator) -> _Sizes:
    """Return the scales of the estimates and of θ̂, the plant's slowest rate, and the deviations of the first
    estimates; cached per context."""
    context = estimator.context
    cached = _known.get(id(context))
    if cached is None or cached[0] is not context:
        typical = np.array(typical_sizes(context))
        if len(_known) > 512:
            _known.clear()
        x = np.array(state_scales(context) if _plan(estimator.program).shape.x else [])
        carried = np.reshape(estimator.kind.carried(context), (-1, 2))
        scales, first = np.concatenate([x, carried[:, 0], typical]), np.concatenate([x, carried[:, 1], typical])
        cached = _known[id(context)] = context, (scales, typical, pace(context), first)
    return cached[1]


def _intensity(experiment: Experiment, estimator: Estimator) -> np.ndarray:
    """Return R (m,): variance times hold time in continuous time, else the variance of one sample."""
    measurement, period = experiment.measurement, estimator.context.period
    variance, hold = noise_stds(measurement, estimator.context) ** 2, holds(measurement, experiment.step)
    return variance * (hold if estimator.every is None else np.maximum(1.0, hold / period))
