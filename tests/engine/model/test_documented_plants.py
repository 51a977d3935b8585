"""The plants in docs/plant-format.md, as a reader copies them."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.simulate import simulate
from thetascope import library
from thetascope.runs.specs.spec_files import parse
from thetascope_schemas import Experiment, Plant

TEXT = (Path(__file__).parents[3] / "docs" / "plant-format.md").read_text(encoding="utf-8")
FENCED = [parse(block).data for block in re.findall("```yaml\n(.*?)```", TEXT, re.DOTALL)]
PLANTS = {data["id"]: data for data in FENCED if "id" in data}


def test_the_documentation_has_the_plants_that_people_bring():
    """A battery, a plant with an algebraic variable, a thermostat, a motor and a tank are complete."""
    assert set(PLANTS) == {"leaky-tank", "rectifier", "thermostat", "battery-cell", "induction-motor"}


@pytest.mark.parametrize("id", sorted(PLANTS))
def test_a_documented_plant_can_be_copied(id: str):
    """It is valid as it stands, and its simulation stays finite."""
    plant = Plant.model_validate(PLANTS[id])
    result = simulate(library.resolve(Experiment(plant=plant, horizon=0.5, step=0.001, evaluate=0.01)))
    assert result.diverged is None
    assert np.isfinite(result.data).all()


def test_the_documented_motor_starts_as_scipy_says():
    """Its speed and fluxes from standstill on 50 Hz equal those of SciPy, for equations written here anew."""
    sine = {"kind": "sine", "amplitude": 180.0, "frequency": 50.0}
    inputs = {"u_α": sine | {"phase": np.pi / 2}, "u_β": sine}
    plant = Plant.model_validate(PLANTS["induction-motor"])
    spec = Experiment.model_validate({"plant": plant, "inputs": inputs, "horizon": 0.3, "step": 1e-4, "evaluate": 1e-3})
    result = simulate(library.resolve(spec))
    R, r, L, M, J, f, p, w = 1.4, 1.2, 0.17, 0.16, 0.02, 0.002, 2, 100 * np.pi

    def rate(t: float, x: np.ndarray) -> list[float]:
        s, q, speed = x[0] + 1j * x[1], x[2] + 1j * x[3], x[4]
        leakage = 1 - M**2 / L**2
        i, j = (s - M / L * q) / (leakage * L), (q - M / L * s) / (leakage * L)
        ds, dq = 180 * np.exp(1j * w * t) - R * i, -r * j + 1j * p * speed * q
        torque = 1.5 * p * (np.conj(s) * i).imag
        return [ds.real, ds.imag, dq.real, dq.imag, (torque - 1 - f * speed) / J]

    t = result.column("t")
    found = solve_ivp(rate, (0, 0.3), np.zeros(5), t_eval=t, rtol=1e-10, atol=1e-12)
    for name, values in zip(("ψ_sα", "ψ_sβ", "ψ_rα", "ψ_rβ", "ω"), found.y, strict=True):
        np.testing.assert_allclose(result.column(f"x.{name}"), values, atol=2e-6 * np.abs(values).max())
    assert result.column("x.ω")[-1] > 100
