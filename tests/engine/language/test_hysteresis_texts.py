"""Dead zones and hysteresis as docs/plant-format.md writes them, against plain NumPy and an independent integrator."""

import numpy as np
from scipy.integrate import solve_ivp

from tests.simulate import simulate
from thetascope import library
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
