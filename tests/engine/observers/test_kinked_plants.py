"""Observers of plants whose equations contain roots and powers of |x|, which vanish at the start."""

import numpy as np
import pytest

from tests.simulate import simulate
from thetascope import library
from thetascope_schemas import Experiment

KINDS = ("joint-ekf", "adaptive-kalman")
BOUC_WEN = {"z": "v - 2*abs(v)*spow(z, n) - v*abs(z)^n", "v": "u - 0.3*v - 2.7*x - 6.3*z", "x": "v"}
PLANTS = {
    "root": {"x": "u - x*abs(x)^0.5"},
    "bouc-wen": BOUC_WEN,
}


@pytest.mark.parametrize("plant", PLANTS)
def test_estimates_and_bands_are_finite_from_the_start(plant: str):
    """An observer estimates the fault within four standard deviations, with a finite band in every row."""
    dynamics = PLANTS[plant]
    spec = {
        "id": plant,
        "plant": {
            "id": plant,
            "states": [{"name": name, "domain": [-20, 20]} for name in dynamics],
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y", "expression": "x"}],
            "parameters": [{"name": "n", "value": 1.5}],
            "dynamics": dynamics,
            "channels": [
                {"name": "a", "kind": "actuator", "enters": {"v" if "v" in dynamics else "x": 1}, "typical": 1}
            ],
        },
        "inputs": {"u": {"kind": "sine", "amplitude": 4, "frequency": 0.3}},
        "horizon": 8,
        "step": 0.01,
        "noise": {"y": {"std": 0.002, "sample_time": 0.01}},
        "faults": [{"channel": "a", "shape": "step", "onset": 2, "size": 1}],
        "observers": [{"label": kind, "kind": kind} for kind in KINDS],
    }
    result = simulate(library.resolve(Experiment.model_validate(spec)))
    columns = dict(zip(result.names, result.data, strict=True))
    for kind in KINDS:
        theta, sigma = columns[f"{kind}.theta.a"], columns[f"{kind}.sigma.a"]
        assert np.isfinite([theta, sigma]).all()
        assert abs(theta[-1] - 1) < 4 * sigma[-1]
