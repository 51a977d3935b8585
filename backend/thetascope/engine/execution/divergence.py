"""The bound beyond which a state has diverged, in multiples of the plant's scales.

States and estimates diverge at EXPLODED times their size, covariances at EXPLODED times their size or their initial
value, coordinates that start from the estimates at EXPLODED times the change that the states' scales cause in them.
Any other state of an observer has no scale: it diverges where its square is no longer finite.
"""

from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.graph import equations, evaluate, topological
from thetascope.engine.compiler.system import CONTINUOUS, Program
from thetascope.engine.observers.support.kalman_defaults import typical_sizes
from thetascope.engine.observers.support.scales import HealthyRun
from thetascope.engine.simulation.experiment import Estimator, Experiment, leading_rows
from thetascope.engine.simulation.simulation import row_values
from thetascope.messages import Message

EXPLODED = 1e12  # times the scale
_PLACES = 31  # points between two rows at which a lost root is searched
_INFINITE = 1e150  # the square of a larger number is not finite
_COVARIANCES = {"P": "p0", "Gamma": "gamma0", "S": "gamma0"}  # matrix → the gain with its initial diagonal


def finite_plant_rows(experiment: Experiment, states: np.ndarray) -> int:
    """Return the number of leading rows (rows, n) of the plant that are finite and have not diverged."""
    limits = EXPLODED * np.array(experiment.context.scales.extents)
    beyond = states.shape[1] - len(limits)  # states of the true plant that the model, and so its scales, lack
    return leading_rows(states, np.concatenate([limits, np.full(beyond, _INFINITE)]) if beyond else limits)


def end_of_plant(
    experiment: Experiment, index: np.ndarray, states: np.ndarray, y: np.ndarray
) -> tuple[int, Message | None]:
    """Return the number of leading rows in which the plant has finite values, and the cause where that is not all.

    Args:
        experiment: the experiment.
        index: base steps of the rows (rows,).
        states: the plant's states (rows, n).
        y: its measured outputs (rows, m), which an algebraic variable without a value makes NaN before any state.
    """
    ended = finite_plant_rows(experiment, states)
    solves = _solves(experiment.plant)
    if solves:
        ended = min(ended, leading_rows(y, np.full(y.shape[1], np.inf)))
    if ended == len(states):
        return ended, None
    lost = _lost_root(experiment, solves, index, states, ended) if solves else None
    return ended, lost or Message("diverged.plant")


@lru_cache(maxsize=256)
def _solves(program: Program) -> tuple[int, ...]:
    """Return the nodes of a program that solve equations."""
    nodes = topological(program.graph, [*program.update, *program.outputs.values()])
    return tuple(i for i in nodes if program.graph.nodes[i][0] == "solve")


def _lost_root(
    experiment: Experiment, solves: tuple[int, ...], index: np.ndarray, states: np.ndarray, row: int
) -> Message | None:
    """Return the algebraic variable that has no value at a row, or between it and the row before; None if all have."""
    e, graph = experiment, experiment.plant.graph
    last = max(row - 1, 0)
    at = row_values(e, index[[last]], states[[last]]) | {"t": index[[row]] * e.step}
    span = (index[row] - index[last]) * e.step
    rates = np.array([float(np.ravel(v)[0]) for v in evaluate(graph, list(e.plant.update), at)])
    rates = np.where(np.isfinite(rates), rates, 0.0) * (e.plant.time == CONTINUOUS)
    path = states[last] + np.linspace(0.0, 1.5, _PLACES)[:, None] * span * rates
    at |= dict(zip(e.plant.states, path.T, strict=True))
    for i, roots in zip(solves, evaluate(graph, list(solves), at), strict=True):
        if not np.isfinite(roots).all():
            names = equations(graph.nodes[graph.nodes[i][1]][1]).names
            return Message("diverged.no-root", names=list(names))
    return None


def finite_observer_rows(estimator: Estimator, states: np.ndarray) -> int:
    """Return the number of leading rows (rows, observer states) that are finite and have not diverged."""
    context = estimator.context
    assert context.healthy is not None, "an observer of an experiment has scales"
    names = tuple(s["name"] for s in context.model["states"])
    typical = tuple(zip(estimator.channels, typical_sizes(context), strict=True)) if estimator.channels else ()
    gains = tuple(estimator.parameters.items())
    return leading_rows(states, _limits(estimator.program, context.healthy, names, typical, gains))


@lru_cache(maxsize=256)
def _limits(
    program: Program,
    healthy: HealthyRun,
    plant_states: tuple[str, ...],
    typical: tuple[tuple[str, float], ...],
    parameters: tuple[tuple[str, float], ...],
) -> np.ndarray:
    """Return the bound (observer states,) of each state of an observer."""
    scales, gains = healthy.scales, dict(parameters)
    x, y, theta = scales.states, scales.outputs, [size for _, size in typical]
    sizes = _coordinates(program, dict(zip(plant_states, x, strict=True)), gains)
    sizes |= {f"xh.{n}": extent for n, extent in zip(plant_states, scales.extents, strict=True)}
    sizes |= {f"thetah.{n}": size for n, size in typical}

    in_states = any(
        name.startswith("P.") for name in program.states
    )  # without P, Υ is in a canonical form's coordinates

    def limit(name: str) -> float:
        if name in sizes:
            return EXPLODED * sizes[name]
        matrix, *place = name.split(".")
        i, j = (int(k) for k in place) if len(place) == 2 else (0, 0)
        if matrix in _COVARIANCES:
            return EXPLODED * _covariance(matrix, i, j, [*x, *theta] if matrix == "P" else theta, gains, len(x))
        if matrix in ("Upsilon", "Omega") and in_states:
            return EXPLODED * (x if matrix == "Upsilon" else y)[i] / theta[j]
        return _INFINITE

    return np.array([min(limit(name), _INFINITE) for name in program.states])


def _coordinates(program: Program, x: dict[str, float], parameters: dict[str, float]) -> dict[str, float]:
    """Return the change of each initial state of an observer when the initial estimates change by their scales; only of
    those that change."""
    roots = [program.outputs[f"init.{s}"] for s in program.states]
    given = dict.fromkeys(program.inputs, 0.0) | {"t": 0.0} | parameters
    moved = [given | {f"x0.{n}": given.get(f"x0.{n}", 0.0) + scale} for n, scale in x.items()]
    first, *others = (np.array([float(v) for v in evaluate(program.graph, roots, g)]) for g in (given, *moved))
    change = np.sum([np.abs(other - first) for other in others], axis=0)
    return {s: float(c) for s, c in zip(program.states, change, strict=True) if np.isfinite(c) and c > 0}


def _covariance(matrix: str, i: int, j: int, scale: list[float], gains: dict[str, float], n: int) -> float:
    """Return the size of an entry of a covariance: its scale, at least its initial size; without a scale the latter."""

    def size(k: int) -> float:
        gain, place = ("gamma0", k - n) if matrix == "P" and k >= n else (_COVARIANCES[matrix], k)
        if f"g.{gain}" in gains:  # one number for a matrix whose unit is not that of a fault
            return gains[f"g.{gain}"]
        return max(scale[k] ** 2, gains.get(f"g.{gain}.{place}", 0.0))

    return float((size(i) * size(j)) ** 0.5)
