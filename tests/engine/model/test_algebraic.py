"""Algebraic variables: solved in the kernel, differentiated, refused where they are not determined."""

import copy
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

from thetascope.assembly.analyses.plant_check import check_plant
from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.composite import linear_solve
from thetascope.engine.compiler.graph import Graph, evaluate
from thetascope.engine.compiler.jit import Layout, Segments, kernel
from thetascope.engine.compiler.system import Program
from thetascope.engine.errors import SpecError
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observability.taylor import Series, exact, precise
from thetascope.engine.observers.registry import kinds
from thetascope.engine.observers.support.linearisation import linearise
from thetascope.in_process import run
from thetascope_schemas import Plant

DIODE: dict[str, Any] = {
    "id": "rectifier",
    "states": [{"name": "v", "unit": "V"}],
    "inputs": [{"name": "e", "unit": "V", "default": 5.0}],
    "outputs": [{"name": "y", "expression": "v"}, {"name": "y_i", "expression": "i"}],
    "parameters": [{"name": n, "value": v} for n, v in (("R", 100.0), ("C", 1e-3), ("I_s", 1e-9), ("V_T", 0.026))],
    "algebraic": [
        {"name": "i", "equation": "i = I_s*(exp((e - v - R*i)/V_T) - 1)", "guess": "max(0, (e - v - 0.5)/R)"}
    ],
    "dynamics": {"v": "(i - v/1000)/C"},
    "channels": [{"name": "leak", "kind": "process", "enters": {"v": "-1/C"}, "unit": "A", "typical": 0.001}],
}
SPEC: dict[str, Any] = {
    "plant": DIODE,
    "inputs": {"e": {"kind": "sine", "amplitude": 5.0, "frequency": 2.0, "offset": 2.0}},
    "horizon": 1.0,
    "step": 0.0005,
    "evaluate": 0.01,
}
FOUR_BARS: dict[str, Any] = {  # three pipes that meet in a junction: flows and a pressure, one block of four unknowns
    "id": "junction",
    "states": [{"name": n, "initial": v} for n, v in (("h1", 3.0), ("h2", 1.0), ("h3", 2.0))],
    "outputs": [
        {"name": "y1", "expression": "h1"},
        {"name": "y2", "expression": "h2"},
        {"name": "q", "expression": "q1"},
    ],
    "parameters": [{"name": "r", "value": 2.0}, {"name": "k", "value": 0.5}],
    "definitions": [{"name": "sum", "expression": "q1 + q2 + q3"}, {"name": "drop", "expression": "k*q1^3 + r*q1"}],
    "algebraic": [
        {"name": "p", "equation": "sum = 0", "guess": 1},
        {"name": "q1", "equation": "drop = h1 - p"},
        {"name": "q2", "equation": "r*q2 + k*q2^3 = h2 - p"},
        {"name": "q3", "equation": "h3 - p - r*q3 - k*q3^3"},
    ],
    "dynamics": {"h1": "-q1", "h2": "-q2", "h3": "-q3"},
}


def model(plant: dict[str, Any]) -> Model:
    return Model(Plant.model_validate(plant).model_dump(mode="json"))


def of_one_state(id: str, output: str, algebraic: list[dict], rate: str) -> dict[str, Any]:
    """Return a plant with the state x, 1 at first."""
    states, outputs = [{"name": "x", "initial": 1.0}], [{"name": "y", "expression": output}]
    return {"id": id, "states": states, "outputs": outputs, "algebraic": algebraic, "dynamics": {"x": rate}}


def current(e: float, v: float) -> float:
    def residual(i: float) -> float:
        return i - 1e-9 * np.expm1(min((e - v - 100 * i) / 0.026, 700))

    return brentq(residual, -1e-8, 1, xtol=1e-18, rtol=1e-14)


def test_a_rectifier_runs_as_scipy_says_with_a_root_finder_inside():
    """States and the algebraic current equal Radau's with brentq in the right-hand side, conducting or not."""
    result = run(copy.deepcopy(SPEC))
    t = result.column("t")

    def e(t: float) -> float:
        return 2 + 5 * np.sin(4 * np.pi * t)

    found = solve_ivp(
        lambda t, x: [(current(e(t), x[0]) - x[0] / 1000) / 1e-3], (0, 1), [0.0], "Radau", t, rtol=1e-10, atol=1e-12
    )
    currents = [current(e(at), v) for at, v in zip(t, found.y[0], strict=True)]
    assert min(currents) < 0 < 0.01 < max(currents)
    np.testing.assert_allclose(result.column("x.v"), found.y[0], atol=1e-7)
    np.testing.assert_allclose(result.column("y.y_i"), currents, atol=1e-8)


def test_equations_that_belong_together_are_solved_together():
    """Three flows and a pressure with definitions of them in between equal SciPy's fsolve in the right-hand side."""
    result = run({"plant": FOUR_BARS, "horizon": 5.0, "step": 0.01, "evaluate": 0.1})

    def flows(h: np.ndarray) -> np.ndarray:
        def residual(z: np.ndarray) -> list[float]:
            p, *q = z
            return [sum(q), *(0.5 * b**3 + 2 * b - (a - p) for a, b in zip(h, q, strict=True))]

        return fsolve(residual, [1, 0, 0, 0], xtol=1e-11)[1:]

    found = solve_ivp(
        lambda _, h: -flows(h), (0, 5), [3.0, 1.0, 2.0], t_eval=result.column("t"), rtol=1e-10, atol=1e-12
    )
    for name, values in zip(("h1", "h2", "h3"), found.y, strict=True):
        np.testing.assert_allclose(result.column(f"x.{name}"), values, atol=1e-8)
    np.testing.assert_allclose(result.column("y.q")[-1], flows(found.y[:, -1])[0], atol=1e-8)


def test_independent_and_linear_equations_need_no_iteration():
    """A linear equation becomes a quotient; of a chain, each equation is solved by itself and in order."""
    chain = [
        {"name": "a", "equation": "2*a + b = x"},
        {"name": "b", "equation": "b + b^3 = c", "guess": "x"},
        {"name": "c", "equation": "x = 3*c"},
    ]
    m = model(
        {
            "id": "chain",
            "states": [{"name": "x"}],
            "outputs": [{"name": "y", "expression": "a"}],
            "algebraic": chain,
            "dynamics": {"x": "-a"},
        }
    )
    assert [d.symbol.name for d in m.definitions] == ["c", "b", "a"]
    x, b = sympy.symbols("x b", real=True)
    assert m.definitions[0].expression == x / 3
    assert m.definitions[2].expression == (x - b) / 2


def program() -> Program:
    """Return the junction's program, whose equations form one block."""
    return model(FOUR_BARS).system().lower()


def test_every_lane_has_the_bits_of_the_single_run():
    """Lanes that differ in a parameter solve equations like single runs, and a stored program is the same."""
    p = Program.from_json(program().to_json())
    assert p == program()
    states = [[3.0], [1.0], [2.0]]
    k = np.array([0.5, 0.1, 3.0, 1.0])

    def rows(lanes: int, k: np.ndarray) -> np.ndarray:
        out, one = np.empty((20, 3, lanes)), np.zeros(1)
        segments = Segments(np.array([20]), np.array([1]), one, one, np.array([0.1]))
        layout = Layout(lane_params=("p.k",), lanes=lanes) if lanes > 1 else Layout()
        shared = np.array([2.0]) if lanes > 1 else np.array([2.0, k[0]])
        more = {"lane_params": k} if lanes > 1 else {}
        kernel(p, layout)(segments, np.repeat(states, lanes, axis=1).copy(), shared, 1, out, **more)
        return out

    together = rows(4, k)
    assert np.isfinite(together).all()
    for lane in range(4):
        np.testing.assert_array_equal(together[:, :, lane], rows(1, k[lane : lane + 1])[:, :, 0])


def test_derivatives_of_roots_are_difference_quotients():
    """First and second derivatives by the implicit function theorem, in SymPy's forms and in the graph."""
    m = model(FOUR_BARS)
    p = m.system().lower()
    graph = Graph(p.graph.nodes)
    (first,) = derivatives(graph, [p.outputs["y.q"]], ["x.h1", "x.h2"])
    (second,) = derivatives(graph, [first["x.h1"]], ["x.h1"])
    point = {"x.h1": 3.0, "x.h2": 1.0, "x.h3": 2.5, "p.r": 2.0, "p.k": 0.5, "t": 0.0}
    nodes, d = [p.outputs["y.q"], first["x.h1"], first["x.h2"]], 1e-5

    def at(**change: float) -> np.ndarray:
        moved = {f"x.{n}": point[f"x.{n}"] + v for n, v in change.items()}
        return np.array([float(v) for v in evaluate(graph, nodes, point | moved)])

    _, slope1, slope2 = at()
    assert [slope1, slope2] == pytest.approx(
        [(at(**{h: d}) - at(**{h: -d}))[0] / (2 * d) for h in ("h1", "h2")], rel=1e-7
    )
    (curvature,) = evaluate(graph, [second["x.h1"]], point)
    assert curvature == pytest.approx((at(h1=d) - at(h1=-d))[1] / (2 * d), rel=1e-6)
    A = linearise(m, (), {"h1": 3.0, "h2": 1.0, "h3": 2.5}).A
    assert A[0, :2] == pytest.approx([-slope1, -slope2], rel=1e-9)


def test_power_series_of_roots_solve_the_equation():
    """The Taylor coefficients of z(t) with z + z³ = t + 1 satisfy the equation order by order."""
    m = model(
        {
            "id": "root",
            "states": [{"name": "x", "initial": 1.0}],
            "outputs": [{"name": "y", "expression": "z"}],
            "algebraic": [{"name": "z", "equation": "z + z^3 = x"}],
            "dynamics": {"x": "1"},
        }
    )
    p = m.system().lower()
    with precise():
        series = Series(p.graph, [p.outputs["y.y"]], set())
        for _ in range(6):
            series.extend(lambda name, k: exact(1.0) if k < 2 else Decimal(0))
        z = series.at[p.outputs["y.y"]]
        cube = [sum(z[a] * z[b] * z[k - a - b] for a in range(k + 1) for b in range(k + 1 - a)) for k in range(6)]
        assert all(
            abs(a + b - (1 if k < 2 else 0)) < Decimal("1e-100") for k, (a, b) in enumerate(zip(z, cube, strict=True))
        )


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 5), st.integers(0, 10_000), st.booleans())
def test_linear_equations_are_solved_whatever_the_order_of_rows(n: int, seed: int, structural: bool):
    """The nodes of A⁻¹B have NumPy's values, also with zeros on the diagonal."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n)) * 10.0 ** rng.integers(-4, 4, (n, 1))
    if structural and n > 1:
        A = A * (rng.random((n, n)) < 0.5) + np.roll(np.eye(n), 1, axis=0) * 3
    if abs(np.linalg.det(A / np.abs(A).max(axis=1, keepdims=True))) < 1e-3:
        return
    B = rng.normal(size=(n, 2))
    graph = Graph()

    def nodes(name: str, M: np.ndarray) -> list[list[int]]:
        return [
            [graph.var(f"{name}.{i}.{j}") if v else graph.const(0.0) for j, v in enumerate(r)] for i, r in enumerate(M)
        ]

    X = linear_solve(graph, nodes("a", A), nodes("b", B))
    values = {f"{name}.{i}.{j}": v for name, M in (("a", A), ("b", B)) for (i, j), v in np.ndenumerate(M)}
    found = np.array(evaluate(graph, [x for row in X for x in row], values), dtype=float).reshape(n, 2)
    np.testing.assert_allclose(found, np.linalg.solve(A, B), rtol=1e-6, atol=1e-9 * np.abs(found).max())


def test_every_kind_of_observer_runs_on_a_plant_with_algebraic_variables_or_says_why_not():
    """Those that the check calls possible find the leak; the others give a reason; the rank is decided."""
    report = check_plant(Plant.model_validate(DIODE))
    assert {entry["kind"] for entry in report["observers"]} == set(kinds())
    possible = [entry["kind"] for entry in report["observers"] if entry["possible"]]
    assert {"adaptive-kalman", "joint-ekf", "joint-ukf", "adaptive-kalman-discrete"} <= set(possible)
    assert all(entry["why"] for entry in report["observers"] if not entry["possible"])
    assert report["observability"]["decided"] and report["observability"]["rank"] == 2
    noise = {"y": {"std": 0.01, "sample_time": 0.001}, "y_i": {"std": 0.0005, "sample_time": 0.001}}
    faults = [{"channel": "leak", "shape": "step", "onset": 0.3, "size": 0.002}]
    observers = [{"label": kind, "kind": kind} for kind in possible]
    result = run(SPEC | {"observers": observers, "noise": noise, "faults": faults, "step": 0.001})
    for kind in possible:
        residuals = [name for name in result.names if name.startswith(f"{kind}.residual.")]
        if residuals:  # a kind that gives residuals estimates nothing
            assert all(np.isfinite(result.column(name)[-1]) for name in residuals)
            continue
        assert abs(result.column(f"{kind}.theta.leak")[-1] - 0.002) < 4 * result.column(f"{kind}.sigma.leak")[-1] + 1e-4


def changed(**variable: Any) -> dict[str, Any]:
    plant = copy.deepcopy(DIODE)
    plant["algebraic"][0] |= variable
    return plant


@pytest.mark.parametrize(
    ("plant", "field", "says"),
    [
        (changed(equation="e - v"), "algebraic.0.equation", "index is above 1"),
        (changed(equation="0*i = e - v"), "algebraic.0.equation", "index is above 1"),
        (changed(equation="i^2 + 1 + v^2 = 0"), "algebraic.0.equation", "no value of i"),
        (changed(equation="i^2 = 0"), "algebraic.0.equation", "singular"),
        (changed(equation="i = q"), "algebraic.0.equation", "unknown name 'q'"),
        (changed(guess="i"), "algebraic.0.guess", "unknown name 'i'"),
        (changed(equation="i = v ="), "algebraic.0.equation", "column 7"),
        (
            DIODE | {"algebraic": [{"name": "i", "equation": "i = v"}, {"name": "j", "equation": "i = e"}]},
            "algebraic.1.equation",
            "do not determine j",
        ),
        (
            DIODE | {"algebraic": [{"name": "i", "equation": "i + j = v"}, {"name": "j", "equation": "2*i + 2*j = e"}]},
            "algebraic.0.equation",
            "Jacobian is singular",
        ),
    ],
)
def test_equations_that_do_not_determine_their_variables_are_refused(plant: dict[str, Any], field: str, says: str):
    """An index above 1, a singular Jacobian, no solution at the start and unknown names are refused with the reason."""
    with pytest.raises(SpecError) as caught:
        model(plant)
    assert caught.value.field == field
    assert says in f"{caught.value.problem}; {caught.value.remedy}"
    assert caught.value.remedy.text("zh")


@pytest.mark.parametrize("in_dynamics", [True, False])
def test_a_lost_root_is_reported_with_time_and_variable(in_dynamics: bool):
    """Where an equation loses its solution the run says when and which, also if only an output shows it."""
    plant = copy.deepcopy(DIODE) | {"channels": []}
    plant["algebraic"] = [{"name": "i", "equation": "i^2 = 1 - v", "guess": "1"}]
    plant["dynamics"] = {"v": "1 + 0.1*i" if in_dynamics else "1"}
    result = run({"plant": plant, "horizon": 2.0, "step": 0.001, "evaluate": 0.01})
    assert result.diverged.time == pytest.approx(0.95 if in_dynamics else 1.0, abs=0.03)
    assert result.diverged.cause.code == "diverged.no-root"
    assert "variable i" in result.diverged.cause.text()
