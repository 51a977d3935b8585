"""Power series of a program's graph, against SymPy's derivatives."""

from decimal import Decimal

import pytest
import sympy as sp

from thetascope.engine.compiler.graph import UNARY_FUNCTIONS, Graph
from thetascope.engine.observability.taylor import Series, exact, precise

t = sp.Symbol("t")
X = sp.Rational(3, 10) + t / 5 + t**2 / 7
Y = sp.Rational(1, 2) - t / 3
SMOOTH = [name for name in UNARY_FUNCTIONS if name not in ("floor", "abs")]
ORDERS = 6


def coefficients(build) -> list[Decimal]:
    """Return the Taylor coefficients of the result of ``build`` on the nodes x and y."""
    graph = Graph()
    node = build(graph, graph.var("x"), graph.var("y"))
    with precise():
        known = {"x": [Decimal(3) / 10, Decimal(1) / 5, Decimal(1) / 7], "y": [Decimal(1) / 2, Decimal(-1) / 3]}
        series = Series(graph, [node], set())
        for _ in range(ORDERS):
            series.extend(lambda name, k: known[name][k] if k < len(known[name]) else Decimal(0))
    return series.at[node]


def agree(found: list[Decimal], function: sp.Expr) -> bool:
    """Whether coefficients are those of a function of t, to fifty digits."""
    true = [(sp.diff(function, t, k) / sp.factorial(k)).subs(t, 0).evalf(60) for k in range(ORDERS)]
    return all(abs(sp.Float(str(a), 60) - b) < sp.Float("1e-50") for a, b in zip(found, true, strict=True))


@pytest.mark.parametrize("name", SMOOTH)
def test_every_function_has_its_series(name: str):
    """Each function's coefficients are its derivatives over factorials."""
    assert agree(coefficients(lambda g, x, y: g.raw(name, x)), getattr(sp, name)(X))


@pytest.mark.parametrize(
    ("build", "function"),
    [
        (lambda g, x, y: g.raw("div", x, y), X / Y),
        (lambda g, x, y: g.raw("pow", x, y), X**Y),
        (lambda g, x, y: g.raw("spow", g.raw("neg", x), y), -(X**Y)),
        (lambda g, x, y: g.raw("atan2", x, y), sp.atan(X / Y)),
        (lambda g, x, y: g.raw("fma", x, y, x), X * Y + X),
        (lambda g, x, y: g.raw("abs", g.raw("sub", x, y)), Y - X),
        (lambda g, x, y: g.raw("where", g.raw("lt", x, y), g.raw("mul", x, x), y), X**2),
        (lambda g, x, y: g.raw("max", x, y), Y),
    ],
)
def test_operations_and_branches(build, function: sp.Expr):
    """Binary operations follow their recurrences; a branch is that of the expansion point."""
    assert agree(coefficients(build), function)


def test_decimal_numbers_are_exact():
    """0.1 + 0.2 − 0.3 is zero."""
    assert exact(0.1) + exact(0.2) - exact(0.3) == 0
