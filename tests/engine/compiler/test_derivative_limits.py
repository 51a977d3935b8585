"""Derivatives of random expressions at kinks and roots, against limits in high precision."""

from itertools import product

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, evaluate
from thetascope.engine.compiler.lowering import Lowering
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.lazy_sympy import numerical
from thetascope.engine.language.parser import parse
from thetascope.engine.language.tables import Table

SYMBOLS = {name: sympy.Symbol(name, real=True) for name in ("x", "y", "n")}
HAT = {"x": [-1, 0, 1, 2], "y": [0, 1, 0.25, 0.25], "method": "linear", "outside": "continue"}
TABLES = {
    "hat": Table.of(HAT | {"name": "hat"}),
    "hill": Table.of(HAT | {"name": "hill", "method": "cubic"}),
    "held": Table.of(HAT | {"name": "held", "method": "cubic", "outside": "hold"}),
}
EXPONENT = 1.5
DIRECTIONS = [(1, 0), (0, 1), (1, 1), (1, -1)]


def numbers(expression: sympy.Expr, point: dict) -> tuple[float, list[float], list[float]]:
    """The value, the symbolic gradient and the gradient of the graph at a point."""
    slopes = [derivative(expression, SYMBOLS[name]) for name in "xy"]
    lowering = Lowering(Graph(), set(SYMBOLS))
    roots = [lowering(e) for e in (expression, *slopes)]
    value, *symbolic = (float(v) for v in evaluate(lowering.graph, roots, point))
    (tangent,) = derivatives(lowering.graph, roots[:1], ("x", "y"))
    nodes = [tangent.get(name, lowering.graph.const(0.0)) for name in "xy"]
    return value, symbolic, [float(v) for v in evaluate(lowering.graph, nodes, point)]


def signed_power(x, a):
    """spow in high precision."""
    return mpmath.sign(x) * abs(x) ** a


NUMERIC = [
    {"Abs": abs, "Min": min, "Max": max, "SignedPower": signed_power, "atan2": mpmath.atan2, "sign": mpmath.sign},
    {"Less": lambda a, b: a < b, "LessEqual": lambda a, b: a <= b, "Where": lambda c, a, b: a if c else b},
    {name: table.value for name, table in TABLES.items()},
    "mpmath",
]


def gradient(expression: sympy.Expr, point: dict) -> list[float] | None:
    """The gradient where the expression is differentiable, from quotients in 300 digits; None elsewhere."""
    called = expression.replace(numerical.Interp, lambda x, table, side: sympy.Function(table.table.name)(x))
    f = sympy.lambdify([SYMBOLS[n] for n in "xyn"], called, NUMERIC)
    slopes = []
    with mpmath.workdps(300):
        x, y, n = (mpmath.mpf(point[name]) for name in "xyn")
        for (a, b), sign, size in product(DIRECTIONS, (1, -1), ("1e-40", "1e-90")):
            h = sign * mpmath.mpf(size)
            slopes.append(mpmath.re((f(x + a * h, y + b * h, n) - f(x, y, n)) / h))
        slopes = np.array([float(s) for s in slopes]).reshape(len(DIRECTIONS), 4)
    limit = slopes[:, 1]
    if not np.isfinite(slopes).all() or np.abs(slopes - limit[:, None]).max() > 1e-3:
        return None
    differentiable = abs(limit[0] + limit[1] - limit[2]) + abs(limit[0] - limit[1] - limit[3]) < 1e-6
    return list(limit[:2]) if differentiable else None


POWERS = st.sampled_from(["0.5", "0.3", "1.5", "2", "2.4", "3", "n"])
LEAVES = st.sampled_from(["x", "y", "x - y", "1", "2", "-1", "0.5", "x + 1"])


def grown(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Expressions one operation larger."""
    pair = st.tuples(inner, inner)
    return st.one_of(
        pair.map("({0[0]}) + ({0[1]})".format),
        pair.map("({0[0]})*({0[1]})".format),
        pair.map("max({0[0]}, {0[1]})".format),
        pair.map("min({0[0]}, {0[1]})".format),
        pair.map("sqrt(({0[0]})^2 + ({0[1]})^2)".format),
        inner.map("abs({})".format),
        inner.map("sqrt(abs({}))".format),
        inner.map("sqrt(({})^2)".format),
        inner.map("clip({}, -1, 1)".format),
        inner.map("tanh({})".format),
        inner.map("exp(-abs({}))".format),
        st.tuples(inner, POWERS).map("abs({0[0]})^{0[1]}".format),
        st.tuples(inner, POWERS).map("spow({0[0]}, {0[1]})".format),
        inner.map("({0})*sign({0})".format),
        st.tuples(inner, st.sampled_from(sorted(TABLES))).map("interp({0[0]}, {0[1]})".format),
    )


@settings(max_examples=120, deadline=None)
@given(st.recursive(LEAVES, grown, max_leaves=6), st.sampled_from([0.0, 1.0, -1.0]), st.sampled_from([0.0, 1.0]))
def test_derivatives_are_limits_where_there_is_one(text: str, x: float, y: float):
    """Symbolic and graph derivatives are finite everywhere, and equal the limit where the expression is smooth."""
    expression = parse(text, list(SYMBOLS), "f", tables=TABLES).sympy(SYMBOLS, TABLES)
    point = {"x": x, "y": y, "n": EXPONENT}
    value, symbolic, of_graph = numbers(expression, point)
    assert np.isfinite([value, *symbolic, *of_graph]).all()
    limit = gradient(expression, point)
    assume(limit is not None)
    assert symbolic == pytest.approx(limit, rel=1e-9, abs=1e-9)
    assert of_graph == pytest.approx(limit, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "curvature"),
    [
        ("x^2*sqrt(abs(x))", 0),
        ("abs(x)^2.5", 0),
        ("abs(x)^(n + 1)", 0),
        ("spow(x, n + 1)", 0),
        ("x^2*abs(x)", 0),
        ("(x^2 + y^2)^1.5", 0),
        ("exp(-1/x^2)", 0),
        ("sqrt(x^4)", 2),
        ("abs(x)*spow(x, 1)*sign(x) + y*abs(x)^n*x", 2),
        ("max(x, 0)^2 + min(x, 0)^2", 2),
        ("cos(abs(x))", -1),
        ("x^2*interp(x, hat)", 2),
        ("x^2*interp(x - 1, held)", 0),
    ],
)
def test_second_derivatives_are_limits(text: str, curvature: float):
    """At 0 the second derivative, symbolic and of the graph, is that of the smooth function."""
    expression = parse(text, list(SYMBOLS), "f", tables=TABLES).sympy(SYMBOLS, TABLES)
    x, point = SYMBOLS["x"], {"x": 0.0, "y": 0.0, "n": EXPONENT}
    lowering = Lowering(Graph(), set(SYMBOLS))
    root, symbolic = lowering(expression), lowering(derivative(derivative(expression, x), x))
    graph = lowering.graph
    (slope,) = derivatives(graph, [root], ("x",))
    (twice,) = derivatives(graph, [slope["x"]], ("x",))
    assert [float(v) for v in evaluate(graph, [symbolic, twice["x"]], point)] == pytest.approx([curvature] * 2)
