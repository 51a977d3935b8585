"""The adaptive Kalman observer against independent implementations and against theory."""

import numpy as np
import pytest

from tests.engine.observers.kalman_cases import close, columns, reference, run
from tests.reference import kalman
from tests.reference.integration import Scenario, constant, sine, steps
from tests.simulate import simulate
from thetascope import library
from thetascope_schemas import Experiment

MOTOR = ("gain_loss", "load_torque", "current_bias")
TANKS = ("pump1", "leak2", "level1")


def test_dc_motor_follows_the_equations():
    """On the motor (two outputs; actuator, process and sensor fault) it equals DOP853 on the equations written out."""
    gains = {"q": [4.0, 9.0], "r": [0.01, 0.02], "p0": [0.1, 0.2], "lambda": 3.0, "gamma0": [1e-3, 1e-4, 0.01]}
    result = run(
        "dc-motor",
        "adaptive-kalman",
        MOTOR,
        gains,
        initial={"current": 1, "speed": 20, "current_bias": 0.1},
        horizon=2.0,
        step=0.0005,
        evaluate=0.01,
        inputs={"voltage": {"kind": "sine", "amplitude": 4, "frequency": 1.5, "offset": 12}},
        faults=[
            {"channel": "gain_loss", "shape": "step", "onset": 0.5, "size": 0.15},
            {"channel": "load_torque", "shape": "step", "onset": 1.0, "size": 0.1},
            {"channel": "current_bias", "shape": "step", "onset": 1.5, "size": 0.5},
        ],
    )
    expected = kalman.continuous(
        reference("dc-motor", MOTOR),
        Scenario(
            2.0,
            0.01,
            [sine(4, 1.5, offset=12)],
            [constant(0)],
            [steps([0.5], [0, 0.15]), steps([1.0], [0, 0.1]), steps([1.5], [0, 0.5])],
        ),
        kalman.Gains(
            np.diag([4.0, 9.0]),
            np.diag([0.01, 0.02]),
            np.diag([0.1, 0.2]),
            np.diag([1e-3, 1e-4, 0.01]),
            3.0,
            np.array([1.0, 20.0]),
            np.array([0, 0, 0.1]),
        ),
    )
    close(columns(result, "x", ("current", "speed")), expected["x"], 1e-7)
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", MOTOR), expected["thetahat"], 1e-5)


def test_quadruple_tank_follows_the_equations():
    """On the quadruple tank (faults that enter two equations, Φ that depends on x̂) it equals DOP853."""
    gains = {"q": 0.01, "r": 0.02, "p0": 0.05, "lambda": 0.05, "gamma0": [0.01, 1e-5, 0.01]}
    result = run(
        "quadruple-tank",
        "adaptive-kalman",
        TANKS,
        gains,
        initial={"h1": 10, "h2": 11, "h3": 2, "h4": 2},
        horizon=100,
        step=0.05,
        evaluate=1,
        inputs={"v1": {"kind": "sine", "amplitude": 1, "frequency": 0.02, "offset": 3}},
        faults=[
            {"channel": "pump1", "shape": "step", "onset": 20, "size": 0.1},
            {"channel": "leak2", "shape": "ramp", "onset": 50, "size": 0.005, "duration": 50},
        ],
    )
    n, p = 4, 3
    expected = kalman.continuous(
        reference("quadruple-tank", TANKS),
        Scenario(
            100,
            1,
            [sine(1, 0.02, offset=3), constant(3)],
            [],
            [steps([20], [0, 0.1]), _ramp(50, 0.005 / 50), constant(0)],
        ),
        kalman.Gains(
            0.01 * np.eye(n),
            0.02 * np.eye(2),
            0.05 * np.eye(n),
            np.diag([0.01, 1e-5, 0.01]),
            0.05,
            np.array([10.0, 11, 2, 2]),
            np.zeros(p),
        ),
    )
    close(columns(result, "o.x", ("h1", "h2", "h3", "h4")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", TANKS), expected["thetahat"], 1e-5)


def _ramp(onset: float, slope: float):
    from tests.reference.integration import Signal

    return Signal(lambda t, inside: slope * (t - onset) if inside > onset else 0.0, lambda horizon: [onset], True)


def test_the_claimed_deviation_is_the_spread_of_the_estimates():
    """With noise according to Q and R, θ̂ spreads over 60 seeds as the observer claims (√(Γ/2)), within 20 %."""
    spread, claimed, times = [], [], [0.05 * k for k in range(400)]
    for seed in range(60):
        white = np.random.default_rng(seed).normal(
            scale=(0.04 / 0.05) ** 0.5, size=400
        )  # intensity 0.04, held for 0.05 s
        result = run(
            LAG,
            "adaptive-kalman",
            ("theta",),
            {"q": 0.04, "r": 0.0001, "lambda": 0.5, "p0": 0.002, "gamma0": 0.01},
            initial={"x": 0},
            horizon=20,
            step=0.01,
            evaluate=0.1,
            seed=seed,
            noise={"y": {"std": 0.1, "sample_time": 0.01}},
            faults=[
                {
                    "channel": "w",
                    "shape": "table",
                    "onset": 0,
                    "times": times,
                    "values": white.tolist(),
                    "interpolation": "hold",
                }
            ],
        )
        spread.append(result.column("o.theta.theta")[100:])
        claimed.append(result.column("o.claimed.theta")[100:])
    assert np.std(spread) == pytest.approx(np.mean(claimed), rel=0.2)


LAG = {
    "id": "lag",
    "states": [{"name": "x"}],
    "outputs": [{"name": "y", "expression": "x"}],
    "dynamics": {"x": "-x"},
    "channels": [
        {"name": "theta", "kind": "actuator", "enters": {"x": "1"}, "typical": 0.1},
        {"name": "w", "kind": "process", "enters": {"x": "1"}, "typical": 1.0},
    ],
}


def test_the_library_motor_distinguishes_four_faults():
    """At the end of each phase every estimate is within three of its σ, and every assumption holds."""
    result = simulate(library.resolve(library.experiment("dc-motor")))
    t = result.column("t")
    for label in ("adaptive", "sampled"):
        for channel in ("gain_loss", "load_torque", "friction_increase", "current_bias"):
            error = result.column(f"{label}.theta.{channel}") - result.column(f"theta.{channel}")
            for a, b in ((4, 5), (9, 10), (14.5, 15), (19, 20), (24, 25)):
                late = (t > a) & (t < b)
                assert abs(error[late].mean()) < 3 * result.column(f"{label}.sigma.{channel}")[late].mean(), (
                    label,
                    channel,
                    b,
                )
    for report in result.observers:
        assert {str(c.name): c.verdict for c in report.checks if c.verdict != "holds"} == {}


def test_works_in_coordinates_without_canonical_form():
    """In physical coordinates it finds the three faults to 1e-6 without noise, as the canonical observer does."""
    spec = library.experiment("contois-physical").model_dump(mode="json") | {"noise": {}, "figures": []}
    result = simulate(library.resolve(Experiment.model_validate(spec)))
    end = result.column("t") > 90
    for label in ("adaptive", "kalman"):
        for channel, size in (("theta1", 0.01), ("theta2", 0.015), ("theta3", 0.02)):
            assert np.abs(result.column(f"{label}.theta.{channel}")[end] - size).max() < 1e-6


def test_two_biases_of_one_output_lose_excitation():
    """Two channels that enter the output alike cannot be distinguished: the excitation is zero and the check fails."""
    channels = [{"name": c, "kind": "sensor", "enters": {"y": "1"}, "typical": 0.5} for c in ("one", "two")]
    result = run(
        {**LAG, "channels": channels},
        "adaptive-kalman",
        ("one", "two"),
        {"r": 1e-4, "lambda": 0.5, "window": 2},
        horizon=20,
        step=0.01,
        evaluate=0.1,
    )
    check = next(c for c in result.observers[0].checks if str(c.name) == "persistent excitation")
    assert check.verdict == "fails" and abs(check.value) < 1e-6
