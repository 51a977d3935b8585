"""Derivatives of graphs, against finite differences."""

import numpy as np
import pytest

from thetascope.engine.compiler.autodiff import SLOPES, derivatives
from thetascope.engine.compiler.graph import Graph, evaluate

OPERATIONS = [*SLOPES, "mul", "fma", "abs", "min", "max", "where"]
ARITY = {"fma": 3, "where": 3} | dict.fromkeys(("add", "sub", "mul", "div", "pow", "spow", "atan2", "min", "max"), 2)


@pytest.mark.parametrize("op", OPERATIONS)
def test_the_derivative_of_every_operation_equals_the_difference_quotient(op: str):
    """So does that of i·sin i with it inside, at 200 random points."""
    graph, arity = Graph(), ARITY.get(op, 1)
    arguments = [graph.var(f"v{k}") for k in range(arity)]
    if op == "where":
        arguments[0] = graph.call("lt", arguments[0], graph.const(0.5))
    inner = graph.raw(op, *arguments)
    root = graph.mul(inner, graph.call("sin", inner))
    (found,) = derivatives(graph, [root], [f"v{k}" for k in range(arity)])
    rng, d = np.random.default_rng(0), 1e-6
    at = {f"v{k}": rng.uniform(0.1, 0.9, 200) for k in range(arity)}
    assert found or op in ("floor", "sign")
    for name, node in found.items():
        up, down = (evaluate(graph, [root], at | {name: at[name] + s})[0] for s in (d, -d))
        assert evaluate(graph, [node], at)[0] == pytest.approx((up - down) / (2 * d), abs=1e-6, rel=1e-6)
