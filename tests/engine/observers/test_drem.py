"""DREM against plain NumPy, its monotone convergence, and plants on which it shines and fails."""

import numpy as np
import pytest
import sympy

from tests.engine.observers.kalman_cases import close, columns, reference, run
from tests.engine.observers.test_constant_gains import DRIVE, DRIVEN, MOTOR, verdicts
from tests.engine.observers.test_matched_faults import LINEAR
from tests.reference import classical
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.engine.observers.classical.drem import mixed
from thetascope.engine.observers.support.matrices import Matrix


class _Plain:
    """Stands in for a Draft: names nothing."""

    @staticmethod
    def let(name: str, value: sympy.Expr) -> sympy.Expr:
        """Return the value itself."""
        return value


def test_it_follows_its_equations():
    """On the motor, with an actuator and a process fault, it equals DOP853 on the equations written out."""
    gains = {"q": [4.0, 9.0], "r": [0.01, 0.02], "p0": [0.1, 0.2], "ell": 3.0, "gamma": [8.0, 12.0]}
    result = run("dc-motor", "drem", MOTOR, gains, **DRIVE)
    numbers = {
        "Q": np.diag([4.0, 9.0]),
        "R": np.diag([0.01, 0.02]),
        "P0": np.diag([0.1, 0.2]),
        "ell": 3.0,
        "gamma": np.array([8.0, 12.0]),
        "typical": [0.1, 0.05],
    }
    expected = classical.drem(reference("dc-motor", MOTOR), DRIVEN, numbers, [1.0, 20.0])
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", MOTOR), expected["thetahat"], 1e-5)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_the_minors_are_those_of_the_matrix(size):
    """det M and adj M of a random symmetric matrix, against NumPy."""
    values = np.random.default_rng(size).normal(size=(size, size))
    values = values + values.T
    determinant, adjugate = mixed(_Plain(), Matrix(sympy.Matrix(values.tolist())))
    assert float(determinant) == pytest.approx(np.linalg.det(values), rel=1e-9)
    found = np.array(adjugate.entries.tolist(), dtype=float)
    assert found == pytest.approx(np.linalg.det(values) * np.linalg.inv(values), rel=1e-8)
    assert found == pytest.approx(classical.adjugate(values), rel=1e-9)


def test_every_error_falls_monotonically():
    """On a linear plant without noise |θ̂ − θ| never grows, for none of three faults; the gradient's does."""
    channels, sizes = ("inflow", "drain", "drive"), (0.3, -0.2, 0.1)
    faults = [{"channel": c, "shape": "step", "onset": 0.0, "size": s} for c, s in zip(channels, sizes, strict=True)]
    spec = {"horizon": 40.0, "step": 0.01, "evaluate": 0.05, "faults": faults}
    spec["inputs"] = {"u": {"kind": "prbs", "low": 0, "high": 2, "hold": 1.0, "seed": 1}}
    true = np.array(sizes)
    errors = np.abs(columns(run(LINEAR, "drem", channels, {}, **spec), "o.theta", channels) - true)
    assert np.diff(errors, axis=0).max() < 1e-9 * 0.3
    assert errors[-1].max() < 0.02
    bounded = run(LINEAR, "adaptive-kalman", channels, {}, options={"forgetting": "bounded"}, **spec)
    other = np.abs(columns(bounded, "o.theta", channels) - true)
    assert np.diff(other, axis=0).max() > 1e-4


def test_without_information_it_stands_still():
    """Where it fails: two biases of one output cannot be told apart, so θ̂ stays and the regressor's check fails."""
    channels = [{"name": c, "kind": "sensor", "enters": {"y2": "1"}, "typical": 0.5} for c in ("one", "two")]
    result = run(
        LINEAR | {"channels": channels},
        "drem",
        ("one", "two"),
        {},
        horizon=20.0,
        step=0.01,
        evaluate=0.05,
        noise={y: {"std": 0.01, "sample_time": 0.05} for y in ("y1", "y2")},
        faults=[{"channel": "one", "shape": "step", "onset": 2.0, "size": 0.5}],
    )
    assert np.abs(columns(result, "o.theta", ("one", "two"))).max() < 0.05
    assert verdicts(result)["regressor Δ excited"] == "fails"


def test_six_faults_are_refused():
    """The determinants of more than five faults are not written."""
    with pytest.raises(SpecError, match="at most 5"):
        run("dts200", "drem", ("pump1", "pump2", "leak1", "leak2", "leak3", "clog13"), {}, horizon=10.0, step=0.1)


def test_bands_are_as_wide_as_the_noise_makes_the_estimates():
    """On the motor, the spread of θ̂ over three seconds at rest is σ within a quarter, for all six observers."""
    data = library.experiment("dc-motor-observers").model_dump(mode="json")
    data |= {"figures": [], "faults": [], "record": None}
    result = simulate(library.resolve(type(library.experiment("dc-motor")).model_validate(data)))
    late = result.column("t") > 3.0
    for observer in data["observers"]:
        for channel in MOTOR:
            spread = np.std(result.column(f"{observer['label']}.theta.{channel}")[late])
            sigma = np.mean(result.column(f"{observer['label']}.sigma.{channel}")[late])
            assert spread == pytest.approx(sigma, rel=0.25), (observer["label"], channel)
