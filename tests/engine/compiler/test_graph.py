"""The expression graph: sharing, folding, multiply-adds, and evaluation."""

import math

import numpy as np
import pytest
import sympy

from thetascope.engine.compiler.graph import Graph, contract, evaluate, topological, variables
from thetascope.engine.compiler.lowering import Lowering
from thetascope.engine.compiler.system import Program, System


def lowered(text: str, *names: str) -> tuple[Graph, int]:
    symbols = {n: sympy.Symbol(n, real=True) for n in names}
    lowering = Lowering(Graph(), set(names))
    return lowering.graph, lowering(sympy.sympify(text, locals=symbols))


def test_equal_expressions_are_one_node():
    """x·y computed twice is stored once."""
    graph, root = lowered("sin(x*y) + cos(x*y)", "x", "y")
    assert sum(graph.nodes[i][0] == "mul" for i in topological(graph, [root])) == 1


def test_the_sign_of_zero_is_kept():
    """0.0 and −0.0 are two constants, although they are equal in Python."""
    graph = Graph()
    assert graph.const(0.0) != graph.const(-0.0)
    assert math.copysign(1.0, graph.nodes[graph.const(-0.0)][1]) == -1.0


@pytest.mark.parametrize(
    ("text", "ops"),
    [
        ("x**2", ["mul"]),
        ("x**8", ["mul"] * 3),
        ("sqrt(x)", ["sqrt"]),
        ("x/4", ["mul"]),
        ("1/x**2", ["mul", "div"]),
        ("x + 0", []),
        ("-(-x)", []),
        ("x/3", ["mul"]),
        ("x - y", ["sub"]),
    ],
)
def test_expressions_are_simplified(text: str, ops: list[str]):
    """Powers become products, halves square roots, neutral elements vanish."""
    graph, root = lowered(text, "x", "y")
    assert [graph.nodes[i][0] for i in topological(graph, [root]) if graph.nodes[i][0] not in ("var", "const")] == ops


def test_products_used_once_are_fused_and_shared_ones_are_not():
    """a·b + c becomes one fma; a product that is used elsewhere stays a product."""
    graph, _ = lowered("x", "x")
    a, b, c = graph.var("a"), graph.var("b"), graph.var("c")
    product = graph.mul(a, b)
    fused, roots = contract(graph, [graph.add(product, c)])
    assert fused.nodes[roots[0]][0] == "fma"
    shared, roots = contract(graph, [graph.add(product, c), product])
    assert shared.nodes[roots[0]][0] == "add"


def test_evaluation_agrees_with_numpy_on_every_function():
    """Each operation gives NumPy's value, on arrays."""
    x = np.linspace(0.1, 0.9, 7)
    text = (
        "sin(x)+cos(x)*tan(x)-asin(x)/acos(x)+atan(x)*sinh(x)-cosh(x)+tanh(x)*exp(x)-log(x)+floor(3*x)+sqrt(x)+x**2.3"
    )
    graph, root = lowered(text, "x")
    expected = (
        np.sin(x)
        + np.cos(x) * np.tan(x)
        - np.arcsin(x) / np.arccos(x)
        + np.arctan(x) * np.sinh(x)
        - np.cosh(x)
        + np.tanh(x) * np.exp(x)
        - np.log(x)
        + np.floor(3 * x)
        + np.sqrt(x)
        + x**2.3
    )
    np.testing.assert_allclose(evaluate(graph, [root], {"x": x})[0], expected, rtol=1e-14)


def test_unknown_symbols_are_refused():
    """A symbol without a value cannot reach the compiler."""
    with pytest.raises(ValueError, match="'z'"):
        Lowering(Graph(), {"x"})(sympy.Symbol("z"))


def test_a_program_survives_serialisation():
    """to_json and from_json give the same digest, constants bit for bit."""
    x, u = sympy.symbols("x u", real=True)
    program = System("p", "continuous", (x,), (u,), (), (-x / 3 + sympy.Float(0.1) * u,), {"y": x}).lower()
    again = Program.from_json(program.to_json())
    assert again.digest == program.digest
    assert variables(again.graph, again.update) == {"x", "u"}
