"""The accuracy of runs against SciPy's Radau at 1e-11, on plants that a fixed step gets wrong or cannot run at all."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.model.result import TOLERANCE, Result
from thetascope.engine.programs.propagation import exponentials
from thetascope_schemas import Experiment

Slopes = Callable[[float, np.ndarray], list[float]]


@dataclass(frozen=True)
class Case:
    """A plant as states with initial values and dynamics, a horizon, steps to offer, and its equations in Python."""

    states: dict[str, tuple[float, str]]
    horizon: float
    steps: tuple[float, ...]
    slopes: Slopes
    record: float
    inputs: dict[str, float] = field(default_factory=dict)

    def run(self, step: float) -> Result:
        """Return the run with one step."""
        first = next(iter(self.states))
        plant = {
            "id": "case",
            "states": [{"name": n, "initial": v} for n, (v, _) in self.states.items()],
            "inputs": [{"name": n, "default": v} for n, v in self.inputs.items()],
            "outputs": [{"name": "out", "expression": first}],
            "dynamics": {n: text for n, (_, text) in self.states.items()},
        }
        spec = {"id": "case", "plant": plant, "horizon": self.horizon, "step": step, "record": self.record}
        return prepare(library.resolve(Experiment.model_validate(spec))).run()

    def exact(self) -> np.ndarray:
        """Return the states at the recorded rows (rows, states), by Radau."""
        t = np.arange(round(self.horizon / self.record) + 1) * self.record
        start = [v for v, _ in self.states.values()]
        exact = solve_ivp(self.slopes, (0, t[-1]), start, method="Radau", rtol=1e-11, atol=1e-15, t_eval=t)
        return exact.y.T


def _reactor(_: float, x: np.ndarray) -> list[float]:
    rate = 7.2e10 * np.exp(-8750 / x[1]) * x[0]
    return [1 - x[0] - rate, 350 - x[1] + 209.2 * rate + 2.09 * (305 - x[1])]


def _tram(_: float, x: np.ndarray) -> list[float]:
    return [0.8 * 600 * 150 / (35000 * max(x[0], 1e-3)) - (0.01 + 1e-3 * x[0] + 1e-4 * x[0] ** 2)]


def _cylinder(_: float, x: np.ndarray) -> list[float]:
    v, p, q = x
    flows = 3e-8 * np.sqrt(2e7 - p) - 1e-3 * v, 1e-3 * v - 3e-8 * np.sqrt(abs(q))
    return [((p - q) * 1e-3 - 500 * v) / 50, 1.4e9 / 2e-4 * flows[0], 1.4e9 / 4e-4 * flows[1]]


CASES = {
    "a tram that starts at a kink": Case(
        {"v": (0.0, "0.8*600*150/(35000*max(v, 0.001)) - (0.01 + 0.001*v + 0.0001*v^2)")}, 2, (0.01, 0.1), _tram, 0.1
    ),
    "a reactor that ignites": Case(
        {
            "c": (0.9, "1 - c - 7.2e10*exp(-8750/T)*c"),
            "T": (305.0, "350 - T + 209.2*7.2e10*exp(-8750/T)*c + 2.09*(305 - T)"),
        },
        6,
        (0.01,),
        _reactor,
        0.1,
    ),
    "Van der Pol, μ = 1000": Case(
        {"x": (1.05, "v"), "v": (-0.01, "1000*(1 - x^2)*v - x")},
        5,
        (0.5,),
        lambda _, x: [x[1], 1000 * (1 - x[0] ** 2) * x[1] - x[0]],
        1.0,
    ),
    "Robertson": Case(
        {
            "a": (1.0, "-0.04*a + 1e4*b*c"),
            "b": (0.0, "0.04*a - 1e4*b*c - 3e7*b^2"),
            "c": (0.0, "3e7*b^2"),
        },
        10,
        (1.0,),
        lambda _, x: [
            -0.04 * x[0] + 1e4 * x[1] * x[2],
            0.04 * x[0] - 1e4 * x[1] * x[2] - 3e7 * x[1] ** 2,
            3e7 * x[1] ** 2,
        ],
        1.0,
    ),
    "a lag of 10 μs": Case(
        {"x": (0.0, "(u - x)/1e-5")}, 0.5, (0.01,), lambda _, x: [(1 - x[0]) / 1e-5], 0.01, {"u": 1.0}
    ),
    "a converter": Case(
        {"i": (0.0, "(12 - v - 0.01*i)/1e-5"), "v": (0.0, "(i - v/2)/1e-4")},
        0.01,
        (1e-3,),
        lambda _, x: [(12 - x[1] - 0.01 * x[0]) / 1e-5, (x[0] - x[1] / 2) / 1e-4],
        1e-3,
    ),
    "Lotka and Volterra": Case(
        {"a": (10.0, "1.1*a - 0.4*a*b"), "b": (5.0, "0.1*a*b - 0.4*b")},
        30,
        (0.1,),
        lambda _, x: [1.1 * x[0] - 0.4 * x[0] * x[1], 0.1 * x[0] * x[1] - 0.4 * x[1]],
        0.5,
    ),
    "dry friction": Case(
        {"x": (0.0, "v"), "v": (1.0, "-x - 0.5*tanh(v/0.001) + sin(2*t)")},
        5,
        (0.01,),
        lambda t, x: [x[1], -x[0] - 0.5 * np.tanh(x[1] / 1e-3) + np.sin(2 * t)],
        0.1,
    ),
    "an orbit in metres": Case(
        {
            "x": (7e6, "vx"),
            "y": (0.0, "vy"),
            "vx": (0.0, "-3.986004418e14*x/(x^2 + y^2)^1.5"),
            "vy": (7546.0, "-3.986004418e14*y/(x^2 + y^2)^1.5"),
        },
        6000,
        (10.0, 100.0),
        lambda _, x: [
            x[2],
            x[3],
            -3.986004418e14 * x[0] / np.hypot(x[0], x[1]) ** 3,
            -3.986004418e14 * x[1] / np.hypot(x[0], x[1]) ** 3,
        ],
        100.0,
    ),
    "a hydraulic cylinder in pascals": Case(
        {
            "v": (0.0, "((p - q)*1e-3 - 500*v)/50"),
            "p": (5e6, "1.4e9/2e-4*(3e-8*sqrt(2e7 - p) - 1e-3*v)"),
            "q": (5e6, "1.4e9/4e-4*(1e-3*v - 3e-8*sqrt(abs(q)))"),
        },
        0.5,
        (0.01,),
        _cylinder,
        0.01,
    ),
    "a ball on a stiff floor": Case(
        {"x": (1.0, "v"), "v": (0.0, "-9.81 + 1e6*max(-x, 0)")},
        1.2,
        (0.01,),
        lambda _, x: [x[1], -9.81 + 1e6 * max(-x[0], 0.0)],
        0.1,
    ),
}


@pytest.mark.parametrize(("name", "step"), [(name, step) for name, case in CASES.items() for step in case.steps])
def test_the_plant_is_right_at_every_offered_step(name: str, step: float):
    """Each state agrees with Radau to the tolerance of its scale, and the run states an accuracy."""
    case = CASES[name]
    result, exact = case.run(step), case.exact()
    for j, state in enumerate(case.states):
        error = np.abs(result.column(f"x.{state}") - exact[:, j]).max() / np.abs(exact[:, j]).max()
        assert error < TOLERANCE, (state, error)
    assert result.accuracy is not None and result.accuracy_message is not None


def test_the_stated_accuracy_covers_a_kept_error():
    """The stated error of an oscillation without damping, which keeps every error, is within a factor of three."""
    case = CASES["Lotka and Volterra"]
    result, exact = case.run(0.1), case.exact()
    columns = np.stack([result.column(f"x.{s}") for s in case.states], axis=1)
    error = (np.abs(columns - exact).max(axis=0) / np.abs(exact).max(axis=0)).max()
    assert result.accuracy is not None
    assert error / 3 < result.accuracy.plant < 10 * error


def test_the_growth_of_errors_does_not_depend_on_the_rest_of_a_span():
    """The exponential of a matrix is SciPy's, and the same bits beside a matrix of 1e40 as alone."""
    small = np.random.default_rng(0).normal(size=(20, 3, 3))
    together = exponentials(np.concatenate([small, np.full((1, 3, 3), 1e40)]))
    np.testing.assert_array_equal(together[:-1], exponentials(small))
    np.testing.assert_allclose(together[:-1], expm(small), rtol=1e-6, atol=1e-9)
    assert np.isinf(together[-1]).all()


def test_the_implicit_method_has_order_five_and_is_stiffly_accurate():
    """The coefficients satisfy the order conditions to the precision with which they are published."""
    A = np.zeros((8, 8))
    for i, row in enumerate(implicit_method.A):
        A[i, : len(row)] = row
        A[i, i] = implicit_method.GAMMA if i else 0.0
    b, c = A[-1], np.array(implicit_method.C)
    conditions = {
        1.0: b,
        1 / 2: b * c,
        1 / 3: b * c**2,
        1 / 6: b * (A @ c),
        1 / 4: b * c**3,
        1 / 8: b * c * (A @ c),
        1 / 12: b * (A @ c**2),
        1 / 24: b * (A @ A @ c),
        1 / 5: b * c**4,
        1 / 20: b * (A @ c**3),
        1 / 60: b * (A @ A @ c**2),
        1 / 120: b * (A @ A @ A @ c),
    }
    assert np.abs(A.sum(axis=1) - c).max() < 1e-9 and c[-1] == 1
    for value, terms in conditions.items():
        assert terms.sum() == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("rows", [1, 7, 40])
def test_splitting_a_run_changes_no_number(rows: int):
    """Substeps are chosen alike however many rows each call advances, where they change often."""
    from thetascope.engine.simulation.controlled import simulation_of

    case = CASES["a reactor that ignites"]
    spec = {
        "id": "case",
        "plant": {
            "id": "case",
            "states": [{"name": n, "initial": v} for n, (v, _) in case.states.items()],
            "outputs": [{"name": "y", "expression": "T"}],
            "dynamics": {n: text for n, (_, text) in case.states.items()},
        },
        "horizon": 3,
        "step": 0.01,
        "record": 0.02,
    }
    e = prepare(library.resolve(Experiment.model_validate(spec))).engine
    whole = np.concatenate([r.plant for _, r in simulation_of(e).spans(e.steps)])
    state, parts = simulation_of(e).initial(), []
    while state.k < e.steps:
        state, part = simulation_of(e).advance(state, min(rows * e.every, e.steps - state.k))
        parts.append(part.plant)
    np.testing.assert_array_equal(np.concatenate(parts), whole)
