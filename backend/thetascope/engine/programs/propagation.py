"""Propagation of small deviations along a run: Jacobians of a program at many points, and their matrix exponentials."""

from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, evaluate, variables
from thetascope.engine.compiler.system import Program


@lru_cache(maxsize=64)
def _slopes(program: Program) -> tuple[Graph, tuple[tuple[int, int, int], ...]]:
    """Return a graph with ∂(update)/∂(states), and (row, column, node) of the elements that are not always zero."""
    graph = Graph()
    moved = graph.absorb(program.graph, program.update)
    rows = derivatives(graph, [moved[u] for u in program.update], program.states)
    column = {name: j for j, name in enumerate(program.states)}
    return graph, tuple((i, column[name], node) for i, row in enumerate(rows) for name, node in row.items())


@lru_cache(maxsize=64)
def is_linear(program: Program) -> bool:
    """Return whether ∂(update)/∂(states) depends on no state, so that deviations never change how they grow."""
    graph, elements = _slopes(program)
    return not variables(graph, [node for _, _, node in elements]) & set(program.states)


def jacobians(program: Program, values: dict[str, np.ndarray | float], count: int) -> np.ndarray:
    """Return ∂(update)/∂(states) at ``count`` points: shape (count, states, states); 0 where it is not finite."""
    graph, elements = _slopes(program)
    n = len(program.states)
    result = np.zeros((count, n, n))
    for (i, j, _), value in zip(elements, evaluate(graph, [node for _, _, node in elements], values), strict=True):
        result[:, i, j] = value
    return np.where(np.isfinite(result), result, 0.0)


def exponentials(matrices: np.ndarray) -> np.ndarray:
    """Return the exponentials of matrices (count, n, n) by scaling and squaring, to about 1e-8.

    They are infinite where they overflow.
    """
    with np.errstate(all="ignore"):
        size = float(np.abs(matrices).sum(axis=2).max(initial=0.0))
        halvings = max(0, int(np.ceil(np.log2(size))) + 2) if 0 < size < np.inf else 0
        scaled = matrices * 0.5**halvings
        total = term = np.broadcast_to(np.eye(matrices.shape[1]), matrices.shape)
        for k in range(1, 8):
            term = term @ scaled / k
            total = total + term
        for _ in range(halvings):
            total = total @ total
    return total


def accumulate(
    start: tuple[np.ndarray, float], growth: np.ndarray, added: np.ndarray, keep: np.ndarray, add: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return e (points, n) and s (points,) of e ← growth·e + added and s ← keep·s + add, one after another."""
    e, s = start
    errors, recent = np.empty_like(added), np.empty(len(keep))
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(len(keep)):
            e = growth[i] @ e + added[i]
            s = keep[i] * s + add[i]
            errors[i], recent[i] = e, s
    return errors, recent
