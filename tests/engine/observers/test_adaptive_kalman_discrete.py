"""The sampled adaptive Kalman observer against an independent implementation and against theory."""

import numpy as np
import pytest

from tests.engine.observers.kalman_cases import close, columns, outputs, reference, run
from tests.reference import kalman
from tests.reference.integration import Scenario, constant, sine
from tests.simulate import simulate
from thetascope import library

TANKS = ("pump1", "leak2", "level3")
LEVELS = ("h1", "h2", "h3")


def test_three_tanks_sampled_at_one_second():
    """On the DTS200 at 1 s it equals the recursion in NumPy matrices, with the same noisy samples."""
    gains = {"q": 0.01, "r": 0.01, "p0": [4, 5, 6], "lambda": 0.02, "gamma0": [0.04, 0.0025, 4]}
    result = run(
        "dts200",
        "adaptive-kalman-discrete",
        TANKS,
        gains,
        options={"substeps": 2},
        initial={"h1": 42, "h2": 17, "h3": 30.5},
        horizon=200,
        step=0.1,
        evaluate=1,
        seed=5,
        measurement={"mode": "sampled", "period": 1},
        inputs={"Q1": {"kind": "sine", "amplitude": 20, "frequency": 0.01, "offset": 50}},
        noise={y: {"std": 0.1, "sample_time": 1} for y in ("y1", "y2", "y3")},
        faults=[
            {"channel": "pump1", "shape": "step", "onset": 50, "size": 0.2},
            {"channel": "level3", "shape": "step", "onset": 100, "size": 1},
        ],
    )
    mu, n = np.exp(-0.02), 3
    expected = kalman.adaptive_discrete(
        reference("dts200", TANKS),
        Scenario(200, 1, [sine(20, 0.01, offset=50), constant(30)]),
        outputs(result),
        kalman.Gains(
            0.01 * np.eye(n),
            0.01 * np.eye(n),
            np.diag([4.0, 5, 6]),
            np.diag([0.04, 0.0025, 4]),
            mu,
            np.array([42.0, 17, 30.5]),
            np.zeros(3),
        ),
        substeps=2,
    )
    close(columns(result, "o.x", LEVELS), expected["xhat"], 1e-9)
    close(columns(result, "o.theta", TANKS), expected["thetahat"], 1e-8)
    sigma = np.sqrt(np.diagonal(expected["S"], axis1=1, axis2=2) / (1 + mu))
    close(columns(result, "o.claimed", TANKS), sigma, 1e-8)


def test_motor_sampled_at_two_milliseconds():
    """On the motor, with a fault coefficient that depends on the state, it equals the recursion too."""
    channels = ("gain_loss", "friction_increase", "speed_bias")
    gains = {"q": [0.5, 2.0], "r": [0.01, 0.04], "p0": 1, "lambda": 4, "gamma0": [0.01, 1e-7, 10]}
    result = run(
        "dc-motor",
        "adaptive-kalman-discrete",
        channels,
        gains,
        options={"period": 0.002, "substeps": 1},
        initial={"current": 2, "speed": 10},
        horizon=1.0,
        step=0.001,
        evaluate=0.002,
        seed=2,
        inputs={"voltage": {"kind": "sine", "amplitude": 6, "frequency": 2, "offset": 12}},
        noise={"y_current": {"std": 0.1, "sample_time": 0.002}, "y_speed": {"std": 0.2, "sample_time": 0.002}},
        faults=[{"channel": "gain_loss", "shape": "step", "onset": 0.4, "size": 0.1}],
    )
    expected = kalman.adaptive_discrete(
        reference("dc-motor", channels),
        Scenario(1.0, 0.002, [sine(6, 2, offset=12)], [constant(0)]),
        outputs(result),
        kalman.Gains(
            0.002 * np.diag([0.5, 2]),
            np.diag([0.01, 0.04]),
            np.eye(2),
            np.diag([0.01, 1e-7, 10]),
            np.exp(-4 * 0.002),
            np.array([2.0, 10]),
            np.zeros(3),
        ),
    )
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-8)
    close(columns(result, "o.theta", channels), expected["thetahat"], 1e-7)


@pytest.mark.parametrize(("period", "horizon"), [(1.0, 2000), (0.001, 4)])
def test_covariances_stay_positive_definite(period, horizon):
    """At 1 s and at 1 ms, with a wide prior and little noise, P and S stay positive definite to the end."""
    result = run(
        "quadruple-tank",
        "adaptive-kalman-discrete",
        ("pump1", "pump2", "level1"),
        {"q": 1e-4, "r": 1e-8, "p0": 1e4, "gamma0": 1e4, "lambda": 0.02},
        options={"period": period},
        horizon=horizon,
        step=period,
        evaluate=period * max(1, round(horizon / period / 500)),
        inputs={"v1": {"kind": "sine", "amplitude": 1, "frequency": 0.01, "offset": 3}},
        faults=[{"channel": "pump1", "shape": "step", "onset": horizon / 2, "size": 0.1}],
    )
    verdicts = {str(c.name): c.verdict for c in result.observers[0].checks}
    assert result.observers[0].diverged is None
    assert verdicts["P positive definite"] == verdicts["S positive definite"] == "holds"
    assert np.isfinite(columns(result, "o.theta", ("pump1", "pump2", "level1"))).all()


def test_discrete_plant_takes_its_own_map():
    """On a linear discrete plant, without forgetting, it is the joint Kalman filter (Friedland)."""
    plant = {
        "id": "two",
        "time": {"kind": "discrete", "period": 0.5},
        "inputs": [{"name": "u"}],
        "states": [{"name": "a", "initial": 1}, {"name": "b"}],
        "outputs": [{"name": "y", "expression": "a"}],
        "dynamics": {"a": "0.9*a + 0.2*b", "b": "-0.1*a + 0.8*b + u"},
        "channels": [
            {"name": "gain", "kind": "actuator", "enters": {"b": "u"}},
            {"name": "bias", "kind": "sensor", "enters": {"y": "1"}},
        ],
    }
    spec = {
        "horizon": 100,
        "step": 0.5,
        "evaluate": 0.5,
        "seed": 3,
        "noise": {"y": {"std": 0.1, "sample_time": 0.5}},
        "inputs": {"u": {"kind": "prbs", "low": -1, "high": 1, "hold": 2, "seed": 1}},
        "faults": [
            {"channel": "gain", "shape": "step", "onset": 0, "size": -0.3},
            {"channel": "bias", "shape": "step", "onset": 0, "size": 0.5},
        ],
    }
    shared = {"q": 0.02, "r": 0.01, "p0": 0.5, "gamma0": [0.2, 0.3]}
    channels = ("gain", "bias")
    adaptive = run(plant, "adaptive-kalman-discrete", channels, {**shared, "lambda": 0}, **spec)
    joint = run(plant, "joint-ekf", channels, {**shared, "q_theta": 0}, **spec)
    close(columns(adaptive, "o.x", ("a", "b")), columns(joint, "o.x", ("a", "b")), 1e-10)
    close(columns(adaptive, "o.theta", channels), columns(joint, "o.theta", channels), 1e-10)
    assert columns(adaptive, "o.theta", channels)[-1] == pytest.approx([-0.3, 0.5], abs=0.1)


@pytest.mark.parametrize("experiment", ["dts200", "quadruple-tank"])
def test_library_tanks_are_diagnosed(experiment):
    """At the end of its phase every fault, and every healthy channel, is within three of its σ;
    every assumption holds."""
    result = simulate(library.resolve(library.experiment(experiment)))
    onsets = sorted(f.onset for f in library.experiment(experiment).faults)
    t = result.column("t")
    channels = [n.removeprefix("sampled.theta.") for n in result.names if n.startswith("sampled.theta.")]
    assert len(channels) >= 4
    for end in [*onsets, t[-1]]:
        late = (t > end - 150) & (t < end)
        for channel in channels:
            error = result.column(f"sampled.theta.{channel}")[late] - result.column(f"theta.{channel}")[late]
            assert abs(error.mean()) < 3 * result.column(f"sampled.sigma.{channel}")[late].mean(), (channel, end)
    assert {str(c.name): c.verdict for c in result.observers[0].checks if c.verdict != "holds"} == {}


@pytest.mark.parametrize(
    ("kind", "share"), [("adaptive-kalman", 0.5), ("adaptive-kalman-discrete", 1 / (1 + np.exp(-0.05)))]
)
def test_without_excitation_the_covariance_tends_to_its_bound(kind, share):
    """A fault that the input never shows: 60 forgetting times let a plain Γ grow by e^60, the bounded one end at Γ̄.

    The check says from which row on: Γ reaches 0.9 Γ̄ after ln(9 (Γ̄/Γ(0) − 1)) = 5.9 forgetting times.
    """
    plant = {
        "id": "hidden",
        "states": [{"name": "x", "scale": 1}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "-x"},
        "channels": [{"name": "loss", "kind": "actuator", "enters": {"x": "u"}, "typical": 0.3}],
    }
    given = {"horizon": 60.0, "step": 0.05, "evaluate": 1.0, "noise": {"y": {"std": 0.01, "sample_time": 0.05}}}
    gains = {"lambda": 1.0, "bound": 0.04, "gamma0": 0.001}
    result = run(plant, kind, ("loss",), gains, options={"forgetting": "bounded"}, **given)
    assert result.observers[0].diverged is None
    assert result.column("o.claimed.loss")[-1] == pytest.approx((0.04 * share) ** 0.5, rel=1e-6)
    said = result.observers[0].checks[-1].text
    assert said.code == "check.definite.bounded" and (said.args["time"], said.args["channels"]) == (6.0, ("loss",))
    plain = run(plant, kind, ("loss",), gains, **given)
    assert all(check.text.code != "check.definite.bounded" for check in plain.observers[0].checks)
    assert plain.observers[0].diverged is not None or plain.column("o.claimed.loss")[-1] > 1e6
