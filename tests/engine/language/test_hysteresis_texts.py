"""Dead zones and hysteresis as docs/plant-format.md writes them, against plain NumPy and an independent integrator."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from tests.simulate import simulate
from thetascope import library
from thetascope.engine.compiler.graph import Graph, evaluate
from thetascope.engine.compiler.lowering import Lowering
from thetascope.engine.language.builtins import FUNCTIONS
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.parser import parse
from thetascope_schemas import Experiment


def test_dead_zone_play_and_saturation_with_play():
    """A discrete plant with all of them follows a loop over NumPy's clip, row by row."""
    plant = {
        "id": "zones",
        "time": {"kind": "discrete", "period": 0.01},
        "states": [{"name": n} for n in ("x", "z1_before", "z2_before", "q")],
        "inputs": [{"name": "u"}],
        "definitions": [
            {"name": "z1", "expression": "clip(z1_before, x - 0.3, x + 0.3)"},
            {"name": "z2", "expression": "clip(z2_before, x - 0.1, x + 0.1)"},
            {"name": "zone", "expression": "x - clip(x, -0.2, 0.2)"},
            {"name": "v", "expression": "0.5*z1 + 2*z2 + clip(z1, -0.4, 0.4) + zone"},
        ],
        "outputs": [{"name": "y", "expression": "v"}],
        "dynamics": {"x": "0.9*x + 0.1*u", "z1_before": "z1", "z2_before": "z2", "q": "0.5*q + v"},
    }
    spec = {
        "plant": plant,
        "horizon": 6.0,
        "step": 0.01,
        "inputs": {"u": {"kind": "sine", "amplitude": 2.0, "frequency": 0.4}},
    }
    run = simulate(library.resolve(Experiment.model_validate(spec)))
    z1 = z2 = 0.0
    expected = []
    for x in run.column("x.x"):
        z1, z2 = np.clip(z1, x - 0.3, x + 0.3), np.clip(z2, x - 0.1, x + 0.1)
        expected.append(0.5 * z1 + 2 * z2 + np.clip(z1, -0.4, 0.4) + x - np.clip(x, -0.2, 0.2))
    np.testing.assert_allclose(run.column("y.y"), expected, atol=1e-12)
    assert np.ptp(expected) > 3, "all operators move"


def test_bouc_wen_in_continuous_time():
    """The text of the table against DOP853 at tight tolerance, for n = 1.5."""
    values = {"A": 1.0, "beta": 0.8, "gamma": 0.4, "n": 1.5}
    plant = {
        "id": "bouc",
        "states": [{"name": "x"}, {"name": "z"}],
        "inputs": [{"name": "u"}],
        "parameters": [{"name": name, "value": value} for name, value in values.items()],
        "definitions": [{"name": "dx", "expression": "u - 0.2*x"}],
        "outputs": [{"name": "y", "expression": "x + z"}],
        "dynamics": {"x": "dx", "z": "A*dx - beta*abs(dx)*abs(z)^(n - 1)*z - gamma*dx*abs(z)^n"},
    }
    spec = {
        "plant": plant,
        "horizon": 8.0,
        "step": 0.01,
        "inputs": {"u": {"kind": "sine", "amplitude": 2.0, "frequency": 0.3}},
    }
    run = simulate(library.resolve(Experiment.model_validate(spec)))

    def rhs(t, s):
        x, z = s
        dx = 2 * np.sin(2 * np.pi * 0.3 * t) - 0.2 * x
        rise = values["A"] * dx - values["beta"] * abs(dx) * abs(z) ** (values["n"] - 1) * z
        return [dx, rise - values["gamma"] * dx * abs(z) ** values["n"]]

    exact = solve_ivp(rhs, (0, 8), [0, 0], "DOP853", run.column("t"), rtol=1e-11, atol=1e-12, max_step=0.01)
    np.testing.assert_allclose(run.column("x.z"), exact.y[1], atol=2e-6)


OPERATORS = {
    "deadzone": (("x", "d"), "x - clip(x, -d, d)"),
    "play": (("x", "z", "d"), "clip(z, x - d, x + d)"),
    "satplay": (("x", "z", "d", "limit"), "clip(clip(z, x - d, x + d), -limit, limit)"),
    "boucwen": (("v", "z", "A", "beta", "gamma", "n"), "A*v - beta*abs(v)*abs(z)^(n-1)*z - gamma*v*abs(z)^n"),
}


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_are_the_expressions_that_the_table_gives(name):
    """At 100 random points: the value of a constant, that of the program, and its derivatives by differences."""
    names, text = OPERATORS[name]
    symbols = {n: sympy.Symbol(n, real=True) for n in names}
    one, other = (parse(t, names).sympy(symbols) for t in (f"{name}({', '.join(names)})", text))
    lowering = Lowering(Graph(), set(names))
    f, g, *slopes = [lowering(e) for e in (one, other, *(derivative(one, symbols[n]) for n in names))]
    rng, smooth = np.random.default_rng(2), 0

    def at(node, point):
        return float(evaluate(lowering.graph, [node], dict(zip(names, point, strict=True)))[0])

    for _ in range(100):
        point = rng.uniform(-2, 2, len(names))
        for i, n in enumerate(names):
            point[i] = abs(point[i]) if n in ("d", "limit") else 1.2 + abs(point[i]) if n == "n" else point[i]
        value = at(f, point)
        assert value == pytest.approx(at(g, point), abs=1e-12)
        assert value == pytest.approx(FUNCTIONS[name].compute(*map(float, point)), abs=1e-12)
        for i, slope in enumerate(slopes):
            step = np.zeros(len(names))
            step[i] = 1e-6
            sides = at(f, point + step), at(f, point - step)
            if abs(sides[0] + sides[1] - 2 * value) < 1e-10:  # not at a kink
                assert at(slope, point) == pytest.approx((sides[0] - sides[1]) / 2e-6, abs=1e-4)
                smooth += 1
    assert smooth > 50 * len(names)


def test_a_plant_may_use_the_operators_in_continuous_and_discrete_time():
    """The same plants with operators and with their expressions: the same numbers, to rounding."""
    shared = {"horizon": 4.0, "step": 0.01, "inputs": {"u": {"kind": "sine", "amplitude": 2.0, "frequency": 0.4}}}
    discrete = {
        "id": "zones",
        "time": {"kind": "discrete", "period": 0.01},
        "states": [{"name": n} for n in ("x", "z")],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "deadzone(x, 0.2) + 2*play(x, z, 0.1) + satplay(x, z, 0.1, 0.4)"}],
        "dynamics": {"x": "0.9*x + 0.1*u", "z": "play(x, z, 0.1)"},
    }
    plain = discrete | {
        "outputs": [
            {
                "name": "y",
                "expression": "x - clip(x, -0.2, 0.2) + 2*clip(z, x - 0.1, x + 0.1)"
                " + clip(clip(z, x - 0.1, x + 0.1), -0.4, 0.4)",
            }
        ],
        "dynamics": {"x": "0.9*x + 0.1*u", "z": "clip(z, x - 0.1, x + 0.1)"},
    }
    bouc = {
        "id": "bouc",
        "states": [{"name": "x"}, {"name": "z"}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x + z"}],
        "dynamics": {"x": "u - 0.2*x", "z": "boucwen(u - 0.2*x, z, 1, 0.8, 0.4, 1.5)"},
    }
    text = "(u - 0.2*x) - 0.8*abs(u - 0.2*x)*abs(z)^0.5*z - 0.4*(u - 0.2*x)*abs(z)^1.5"
    for one, other in ((discrete, plain), (bouc, bouc | {"dynamics": bouc["dynamics"] | {"z": text}})):
        runs = [simulate(library.resolve(Experiment.model_validate(shared | {"plant": p}))) for p in (one, other)]
        np.testing.assert_allclose(runs[0].column("y.y"), runs[1].column("y.y"), atol=1e-9)
        assert np.ptp(runs[0].column("y.y")) > 1
