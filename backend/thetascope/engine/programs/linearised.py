"""The linear equations of a program about a point: Jacobians by automatic differentiation on the graph."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import Program
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.programs.program_store import derived


@dataclass(frozen=True)
class Jacobians:
    """Derivatives of an update (n) and outputs (m) with respect to states and inputs, and their values at the point.

    ``A`` (n × n), ``B`` (n × inputs), ``C`` (m × n), ``D`` (m × inputs), ``update`` (n,), ``outputs`` (m,).
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    update: np.ndarray
    outputs: np.ndarray


def jacobians_at(
    program: Program, states: Sequence[str], inputs: Sequence[str], values: Mapping[str, np.ndarray | float]
) -> Jacobians:
    """Return the Jacobians of a program at a point, by names of states and inputs; other states are held.

    ``values``: states, inputs, parameters and ``t``, as numbers or arrays of one row.
    """
    linear, names = _linear(program, tuple(states), tuple(inputs)), (*states, *inputs)
    n, m = len(states), len(program.outputs)
    table = probe(linear, list(linear.outputs), dict(values))[:, 0]
    slopes, level = table[: (n + m) * len(names)].reshape(n + m, len(names)), table[(n + m) * len(names) :]
    return Jacobians(slopes[:n, :n], slopes[:n, n:], slopes[n:, :n], slopes[n:, n:], level[:n], level[n:])


@lru_cache(maxsize=32)
def _linear(program: Program, states: tuple[str, ...], inputs: tuple[str, ...]) -> Program:
    """Return the program of the Jacobians, row by row, and of the values."""
    return derived(["linearised", program.digest, states, inputs], lambda: _write(program, states, inputs))


def _write(program: Program, states: tuple[str, ...], inputs: tuple[str, ...]) -> Program:
    graph, place = Graph(), {s: i for i, s in enumerate(program.states)}
    old = [*(program.update[place[s]] for s in states), *program.outputs.values()]
    moved = graph.absorb(program.graph, old)
    roots, zero = [moved[root] for root in old], graph.const(0.0)
    rows = derivatives(graph, roots, (*states, *inputs))
    outputs = {f"slope.{i}.{j}": row.get(x, zero) for i, row in enumerate(rows) for j, x in enumerate(states + inputs)}
    return Program(
        name=f"linearised {program.name}",
        time=program.time,
        states=(),
        inputs=(*program.states, *program.inputs),
        parameters=program.parameters,
        graph=graph,
        update=(),
        outputs=outputs | {f"value.{i}": root for i, root in enumerate(roots)},
    )
