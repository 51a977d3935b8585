"""Propagation of small deviations along a run: Jacobians of a program at many points, and their matrix exponentials."""

from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, evaluate, variables
from thetascope.engine.compiler.jit import Layout, Segments, kernel
from thetascope.engine.compiler.system import DISCRETE, Program

_MOST_HALVINGS = 64  # of a matrix before its exponential is a sum of powers


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
        size = np.abs(matrices).sum(axis=2).max(axis=1, initial=0.0)
        _, exponent = np.frexp(np.where(np.isfinite(size), size, 0.0))
        # each by its own size: one alone must have the same exponential as among others
        halvings = np.clip(exponent + 2, 0, _MOST_HALVINGS)
        scaled = np.ldexp(matrices, -halvings[:, None, None])
        total = term = np.broadcast_to(np.eye(matrices.shape[1]), matrices.shape)
        for k in range(1, 8):
            term = term @ scaled / k
            total = total + term
        for done in range(int(halvings.max(initial=0))):
            more = np.flatnonzero(halvings > done)
            total[more] = total[more] @ total[more]
        total[size >= 2.0**_MOST_HALVINGS] = np.inf
    return total


def accumulate(
    start: tuple[np.ndarray, float], growth: np.ndarray, added: np.ndarray, keep: np.ndarray, add: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return e (points, n) and s (points,) of e ← growth·e + added and s ← keep·s + add, one after another."""
    e, s = start
    count, n = added.shape
    if not count:
        return np.empty_like(added), np.empty(0)
    program = _accumulation(n)
    table = np.concatenate([growth.reshape(count, n * n), added, keep[:, None], add[:, None]], axis=1)
    state, out = np.append(e, s), np.empty((count, n + 1))
    ones, start_at = np.ones(1, dtype=np.int64), np.zeros(1)
    run = kernel(program, Layout(staged=program.inputs))
    run(Segments(ones * count, ones, start_at, start_at, start_at), state, start_at, 1, out, staged=table)
    return np.ascontiguousarray(out[:, :n]), np.ascontiguousarray(out[:, n])


@lru_cache(maxsize=16)
def _accumulation(n: int) -> Program:
    """Return the recursions of `accumulate` for n states as a program in discrete time."""
    graph = Graph()
    states = (*(f"e.{i}" for i in range(n)), "s")
    inputs = (
        *(f"growth.{i}.{j}" for i in range(n) for j in range(n)),
        *(f"added.{i}" for i in range(n)),
        "keep",
        "add",
    )
    node = {name: graph.var(name) for name in (*states, *inputs)}
    update = []
    for i in range(n):
        total = node[f"added.{i}"]
        for j in range(n):
            total = graph.add(graph.mul(node[f"growth.{i}.{j}"], node[f"e.{j}"]), total)
        update.append(total)
    update.append(graph.add(graph.mul(node["keep"], node["s"]), node["add"]))
    return Program("accumulation", DISCRETE, states, inputs, (), graph, tuple(update), {})
