"""Tables in graphs and kernels: the same numbers everywhere, derivatives, and their cost."""

import math
from decimal import Decimal

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, evaluate, topological
from thetascope.engine.compiler.jit import NEVER, Layout, Segments, kernel
from thetascope.engine.compiler.lowering import Lowering
from thetascope.engine.compiler.system import Program, System
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.parser import parse
from thetascope.engine.language.tables import Table
from thetascope.engine.observability.taylor import Series, exact, precise

NAMES = ("x", "y", "k")
SYMBOLS = {name: sympy.Symbol(name, real=True) for name in NAMES}


def table(n: int = 9, method: str = "cubic", outside: str = "continue", seed: int = 0) -> Table:
    """Return a table over −2 … 2 with random steps and values."""
    rng = np.random.default_rng([n, seed])
    x = np.cumsum(rng.uniform(0.2, 1.0, n))
    x = -2 + 4 * (x - x[0]) / (x[-1] - x[0])
    data = {"x": list(x), "y": list(rng.normal(size=n)), "method": method, "outside": outside}
    return Table.of(data | {"name": "map"})


def program(tables: dict[str, Table]) -> Program:
    """Return a program whose rates interpolate."""
    texts = ("y - x + interp(x, a)*interp(y, b)", "k*interp(x - y, a) - 0.3*y + interp(t, b)")
    symbols = SYMBOLS | {"t": sympy.Symbol("t", real=True)}
    update = tuple(parse(text, symbols, tables=tables).sympy(symbols, tables) for text in texts)
    return System("p", "continuous", (SYMBOLS["x"], SYMBOLS["y"]), (), (SYMBOLS["k"],), update).lower()


def run(p: Program, k: np.ndarray, lanes: int, steps: int = 12, h: float = 0.05) -> np.ndarray:
    out = np.empty((steps, 2, lanes))
    layout = Layout(lane_params=("k",), lanes=lanes) if lanes > 1 else Layout()
    one = np.zeros(1)
    segments = Segments(np.array([steps]), np.array([1 if steps else NEVER]), one, one, np.array([h]))
    params = {"lane_params": k} if lanes > 1 else {}
    state = np.repeat([[0.3], [-0.4]], lanes, axis=1).copy()
    kernel(p, layout)(segments, state, np.zeros(0) if lanes > 1 else k, 1, out, **params)
    return out


@pytest.mark.parametrize(("first", "second"), [(2, 3), (8, 7), (9, 1000)])
def test_a_kernel_interpolates_as_numpy_does(first: int, second: int):
    """A run equals the Runge–Kutta scheme in NumPy, for numbers of points around powers of two; lanes have its bits."""
    p = program({"a": table(first), "b": table(second, "linear", "hold")})
    k, x, h = np.array([0.7, 1.9, -1.0, 3.0]), np.array([0.3, -0.4]), 0.05
    alone = run(p, k[:1].copy(), 1)[:, :, 0]

    def rate(z: np.ndarray, t: float) -> np.ndarray:
        return np.array([float(v) for v in p.evaluate(["d.x", "d.y"], {"x": z[0], "y": z[1], "k": k[0], "t": t})])

    for i, row in enumerate(alone):
        k1, t = rate(x, i * h), i * h
        k2 = rate(x + h / 2 * k1, t + h / 2)
        k3 = rate(x + h / 2 * k2, t + h / 2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3, t + h))
        np.testing.assert_allclose(row, x, rtol=1e-9)
    together = run(p, k.copy(), 4)
    for lane in range(4):
        np.testing.assert_array_equal(together[:, :, lane], run(p, k[lane : lane + 1].copy(), 1)[:, :, 0])


def test_a_program_with_tables_survives_storage():
    """Stored and read again, it is the same program, bit for bit."""
    p = program({"a": table(), "b": table(4, "linear")})
    again = Program.from_json(p.to_json())
    assert again == p
    assert again.graph.nodes == p.graph.nodes


def test_a_long_table_is_one_search():
    """A table of 5000 rows adds as few nodes to a graph as one of three; value and slope share the search."""
    counts = []
    for n in (3, 5000):
        graph = Graph()
        x = graph.var("x")
        root = Lowering(graph, {"x"})(parse("interp(x, a)", ["x"], tables="a").sympy(SYMBOLS, {"a": table(n)}))
        (slope,) = derivatives(graph, [root], ["x"])
        counts.append([graph.nodes[i][0] for i in topological(graph, [root, slope["x"]])])
        assert graph.nodes[x] == ("var", "x")
    assert counts[0] == counts[1]
    assert counts[0].count("locate") == 1


LEAVES = st.sampled_from(["x", "y", "x - 2*y", "0.37*x", "1.3"])


def grown(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Expressions one operation larger; most interpolate."""
    pair = st.tuples(inner, inner)
    return st.one_of(
        pair.map("({0[0]}) + ({0[1]})".format),
        pair.map("({0[0]})*({0[1]})".format),
        pair.map("interp(({0[0]})*({0[1]}), a)".format),
        inner.map("interp({}, a)".format),
        inner.map("interp({}, b)".format),
        inner.map("sin({})".format),
        inner.map("tanh(interp({}, b))".format),
    )


@settings(max_examples=80, deadline=None)
@given(
    st.recursive(LEAVES, grown, max_leaves=8),
    st.tuples(st.floats(-2.5, 2.5), st.floats(-2.5, 2.5)),
    st.integers(0, 5),
    st.sampled_from(["hold", "continue"]),
)
def test_derivatives_of_random_expressions_are_difference_quotients(
    text: str, place: tuple[float, float], seed: int, outside: str
):
    """Symbolic and graph derivatives of cubic and linear tables equal one-sided quotients away from points."""
    tables = {"a": table(7, "cubic", outside, seed), "b": table(5, "linear", outside, seed)}
    expression = parse(text, NAMES, tables=tables).sympy(SYMBOLS, tables)
    lowering = Lowering(Graph(), set(NAMES))
    root = lowering(expression)
    symbolic = lowering(derivative(expression, SYMBOLS["x"]))
    graph = lowering.graph
    (tangent,) = derivatives(graph, [root], ["x"])
    d, point = 1e-6, {"x": place[0], "y": place[1], "k": 1.0}
    roots = [root, symbolic, tangent.get("x", graph.const(0.0))]
    low, here, high = (evaluate(graph, roots, point | {"x": point["x"] + s}) for s in (-d, 0.0, d))
    left, right = (here[0] - low[0]) / d, (high[0] - here[0]) / d
    assert here[1] == pytest.approx(here[2], rel=1e-9, abs=1e-9)
    tolerance = 1e-4 * (1 + abs(left) + abs(right))
    assert min(left, right) - tolerance <= here[1] <= max(left, right) + tolerance


@pytest.mark.parametrize("text", ["interp(x, b)", "interp(-x, b)", "interp(x - 2*y, b)"])
def test_at_a_point_of_a_linear_table_the_slope_is_that_of_smaller_values(text: str):
    """There all names fall, as at every kink: the slope is the left one in x, also where the table's argument rises."""
    tables = {"b": Table((-1.0, 0.0, 1.0), ((-1, 5, 0), (-1, 5, -5), (0, 0, 3), (1, 3, 0)), "b")}
    expression = parse(text, NAMES, tables=tables).sympy(SYMBOLS, tables)
    lowering = Lowering(Graph(), set(NAMES))
    graph, roots = lowering.graph, [lowering(expression), lowering(derivative(expression, SYMBOLS["x"]))]
    (tangent,) = derivatives(graph, roots[:1], ["x", "y"])
    value, symbolic, of_graph = evaluate(graph, [*roots, tangent["x"]], {"x": 0.0, "y": 0.0, "k": 0.0})
    assert value == 0
    assert symbolic == of_graph == {"interp(x, b)": -5, "interp(-x, b)": -3, "interp(x - 2*y, b)": 3}[text]


def test_power_series_pass_through_a_table():
    """The Taylor coefficients of interp(1 + t, a)·t equal SciPy's derivatives, order by order."""
    columns = np.array([0.0, 0.7, 1.5, 2.0]), np.array([1.0, 3.0, 3.5, 5.0])
    data = {"name": "a", "x": list(columns[0]), "y": list(columns[1]), "method": "cubic", "outside": "hold"}
    reference = PchipInterpolator(*columns)
    graph = Graph()
    t = graph.var("t")
    at = Lowering(graph, {"x"})(parse("interp(x, a)", ["x"], tables="a").sympy(SYMBOLS, {"a": Table.of(data)}))
    moved = Graph()
    inner = moved.add(moved.const(1.0), moved.var("t"))
    root = moved.mul(moved.absorb(graph, [at], {"x": inner})[at], moved.var("t"))
    with precise():
        series = Series(moved, [root], set())
        for _ in range(5):
            series.extend(lambda name, k: exact(0.0) if k != 1 else Decimal(1))
    expected = [0.0] + [float(reference(1.0, nu=k)) / math.factorial(k) for k in range(4)]
    assert [float(c) for c in series.at[root]] == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert graph.nodes[t] == ("var", "t")
