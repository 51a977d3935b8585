"""The joint extended and unscented Kalman filters against independent implementations, and their refusals."""

import numpy as np
import pytest

from tests.engine.observers.kalman_cases import close, columns, outputs, reference, run
from tests.reference import kalman
from tests.reference.integration import Scenario, constant, sine, steps
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope_schemas import Experiment

CASES = {
    "dts200": {
        "channels": ("pump1", "leak2", "level3"),
        "states": ("h1", "h2", "h3"),
        "period": 1.0,
        "x0": (42.0, 17.0, 30.5),
        "spec": {
            "horizon": 75,
            "step": 0.1,
            "inputs": {"Q1": {"kind": "steps", "times": [20, 45], "values": [50, 80, 30]}},
            "noise": {y: {"std": 0.1, "sample_time": 1} for y in ("y1", "y2", "y3")},
            "faults": [{"channel": "pump1", "shape": "step", "onset": 25, "size": 0.2}],
        },
        "u": [steps([20, 45], [50, 80, 30]), constant(30)],
        "signals": [],
        "substeps": 2,
        "r": [0.01, 0.01, 0.02],
        "q": [0.01, 0.02, 0.01],
        "q_theta": [0.01, 0.001, 0.05],
        "prior": [0.04, 0.0025, 4],
    },
    "dc-motor": {
        "channels": ("gain_loss", "friction_increase", "speed_bias"),
        "states": ("current", "speed"),
        "period": 0.002,
        "x0": (2.0, 10.0),
        "spec": {
            "horizon": 0.6,
            "step": 0.001,
            "inputs": {"voltage": {"kind": "sine", "amplitude": 6, "frequency": 2, "offset": 12}},
            "noise": {"y_current": {"std": 0.1, "sample_time": 0.002}, "y_speed": {"std": 0.2, "sample_time": 0.002}},
            "faults": [{"channel": "gain_loss", "shape": "step", "onset": 0.3, "size": 0.1}],
        },
        "u": [sine(6, 2, offset=12)],
        "signals": [constant(0)],
        "substeps": 1,
        "r": [0.01, 0.04],
        "q": [0.5, 2.0],
        "q_theta": [0.1, 3e-4, 5.0],
        "prior": [0.01, 1e-7, 10],
    },
}


@pytest.mark.parametrize("plant", CASES)
@pytest.mark.parametrize(
    ("kind", "more", "theirs"),
    [
        ("joint-ekf", {}, kalman.joint_ekf),
        ("joint-ukf", {}, kalman.joint_ukf),
        ("joint-ukf", {"alpha": 0.5, "beta": 1, "kappa": 0.5}, kalman.joint_ukf),
    ],
)
def test_equals_the_filter_in_numpy(plant, kind, more, theirs):
    """With the same samples, estimates and the covariance of θ̂ are those of the filter in NumPy matrices."""
    case = CASES[plant]
    channels, period, n = case["channels"], case["period"], len(case["states"])
    gains = {"r": case["r"], "q": case["q"], "q_theta": case["q_theta"], "p0": 2, "gamma0": case["prior"], **more}
    result = run(
        plant,
        kind,
        channels,
        gains,
        options={"period": period, "substeps": case["substeps"]},
        evaluate=period,
        seed=4,
        initial=dict(zip(case["states"], case["x0"], strict=True)),
        **case["spec"],
    )
    expected = theirs(
        reference(plant, channels),
        Scenario(case["spec"]["horizon"], period, case["u"], case["signals"]),
        outputs(result),
        kalman.Gains(
            period * np.diag(case["q"]),
            np.diag(case["r"]),
            2 * np.eye(n),
            np.diag(case["prior"]),
            1.0,
            np.array(case["x0"]),
            np.zeros(3),
            Q_theta=period * np.diag(case["q_theta"]) ** 2,
        ),
        substeps=case["substeps"],
        **more,
    )
    close(columns(result, "o.x", case["states"]), expected["xhat"], 1e-7)
    close(columns(result, "o.theta", channels), expected["thetahat"], 1e-6)
    sigma = np.sqrt(np.diagonal(expected["P"], axis1=1, axis2=2)[:, n:])
    close(columns(result, "o.claimed", channels), sigma, 1e-6)


def test_innovations_show_whether_the_noise_level_is_right():
    """With the correct r the consistency check holds; with a hundredth of it, it fails."""
    case = CASES["dts200"]

    def verdict(r: float) -> str:
        result = run(
            "dts200", "joint-ekf", ("pump1",), {"r": r, "q": 1e-4}, options={"period": 1.0}, evaluate=1, **case["spec"]
        )
        return {str(c.name): c.verdict for c in result.observers[0].checks}["innovations consistent with P and R"]

    assert verdict(0.01) == "holds"
    assert verdict(0.0001) == "fails"


def test_two_biases_of_one_output_are_not_distinguished():
    """The joint observability check holds for one sensor bias and fails if a second one enters the same output."""
    plant = {
        "id": "lag",
        "states": [{"name": "x", "initial": 1}],
        "inputs": [{"name": "u", "default": 1}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "u - x"},
        "channels": [{"name": c, "kind": "sensor", "enters": {"y": "1"}, "typical": 0.5} for c in ("one", "two")],
    }

    def verdict(*channels: str) -> str:
        result = run(plant, "joint-ekf", channels, {"r": 1e-4, "window": 3}, horizon=20, step=0.01, evaluate=0.1)
        return {str(c.name): c.verdict for c in result.observers[0].checks}["observability of (x, θ)"]

    assert verdict("one") == "holds"
    assert verdict("one", "two") == "fails"


def test_refuses_a_plant_that_is_too_large():
    """Above 24 states and channels the joint UKF refuses before anything is compiled, and names the remedy."""
    names = [f"x{i}" for i in range(24)]
    plant = {
        "id": "chain",
        "states": [{"name": n} for n in names],
        "outputs": [{"name": "y", "expression": "x0"}],
        "dynamics": {n: f"-{n}" for n in names},
        "channels": [{"name": "theta", "kind": "process", "enters": {"x0": "1"}}],
    }
    with pytest.raises(SpecError, match="joint-ekf or adaptive-kalman-discrete"):
        run(plant, "joint-ukf", ("theta",), {}, horizon=1, step=0.01)


def test_comparison_on_the_papers_plant_is_fair():
    """Tuned to settle equally fast without noise, the Kalman filters have less noise than the paper's observer."""
    spec = library.experiment("zhao-2012-observers")
    quiet = simulate(
        library.resolve(Experiment.model_validate(spec.model_dump(mode="json") | {"noise": {}, "figures": []}))
    )
    noisy = [simulate(library.resolve(spec.model_copy(update={"figures": (), "seed": seed}))) for seed in range(6)]
    t, spread = quiet.column("t"), {}
    for label in ("adaptive", "kalman", "ekf", "ukf"):
        error = np.abs(quiet.column(f"{label}.theta.theta1") - quiet.column("theta.theta1"))
        settled = t[(t > 40) & (t < 70) & (error > 0.001)].max() - 40
        assert 2.2 < settled < 2.55, (label, settled)
        end = t > 90
        errors = [(run.column(f"{label}.theta.theta1") - run.column("theta.theta1"))[end] for run in noisy]
        spread[label] = np.mean([e.std() for e in errors])
    assert spread["kalman"] < 0.6 * spread["adaptive"] and spread["ekf"] < 0.8 * spread["kalman"]
    assert spread["ukf"] == pytest.approx(spread["ekf"], rel=0.01)
