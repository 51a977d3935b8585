"""The sliding mode and the unknown-input observer against plain NumPy, theory and plants of both kinds."""

import numpy as np
import pytest

from tests.engine.observers.kalman_cases import close, columns, reference, run
from tests.engine.observers.test_constant_gains import DRIVE, DRIVEN, MOTOR, estimator_of, matrix, verdicts
from tests.reference import classical
from tests.reference.integration import Scenario, constant, sine, steps
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result

PUMPS = ("pump1", "pump2")
TANKS = {
    "initial": {"h1": 12, "h2": 12, "h3": 2, "h4": 1.5},
    "horizon": 100,
    "step": 0.05,
    "evaluate": 1,
    "inputs": {"v1": {"kind": "sine", "amplitude": 1, "frequency": 0.02, "offset": 3}},
}
TANK_FAULTS = [{"channel": "pump1", "shape": "step", "onset": 20, "size": 0.1}]
TANK_SCENARIO = Scenario(100, 1, [sine(1, 0.02, offset=3), constant(3)], [], [steps([20], [0, 0.1]), constant(0)])
LINEAR = {
    "id": "three-lags",
    "states": [{"name": n} for n in ("a", "b", "c")],
    "inputs": [{"name": "u", "default": 1.0}],
    "outputs": [{"name": "y1", "expression": "a"}, {"name": "y2", "expression": "c"}],
    "dynamics": {"a": "b - 2*a", "b": "u - b", "c": "a - 0.5*c"},
    "channels": [
        {"name": "inflow", "kind": "process", "enters": {"a": "1"}, "typical": 0.2},
        {"name": "drain", "kind": "process", "enters": {"c": "-1"}, "typical": 0.2},
        {"name": "drive", "kind": "actuator", "enters": {"b": "1"}, "typical": 0.2},
        {"name": "offset", "kind": "sensor", "enters": {"y2": "1"}, "typical": 0.2},
    ],
}
SWING = {"channel": "inflow", "shape": "table", "onset": 1.0, "times": [0, 2, 5, 9], "values": [0, 0.7, -0.6, 0.4]}


def lags(kind: str, channels: tuple[str, ...], faults: list[dict], gains: dict | None = None, **spec) -> Result:
    return run(LINEAR, kind, channels, gains or {}, horizon=20.0, step=0.01, evaluate=0.05, faults=faults, **spec)


def test_the_sliding_mode_observer_follows_its_equations():
    """On the quadruple tank, with two states that are not measured, it equals DOP853 on the equations written out."""
    G = [[2.0, 0.1], [0.0, 2.0], [0.4, 0.3], [0.1, 0.5]]
    numbers = {"kappa": 0.2, "rho": [0.3, 0.2], "layer": [0.1, 0.2], "tau": 4.0}
    result = run("quadruple-tank", "sliding-mode", PUMPS, {"gn": G, **numbers}, faults=TANK_FAULTS, **TANKS)
    numbers |= {"rho": np.array(numbers["rho"]), "layer": np.array(numbers["layer"])}
    model, start = reference("quadruple-tank", PUMPS), [12.0, 12, 2, 1.5]
    expected = classical.sliding_mode(model, TANK_SCENARIO, np.array(G), numbers, start)
    close(columns(result, "o.x", ("h1", "h2", "h3", "h4")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", PUMPS), expected["thetahat"], 1e-6)


def test_the_unknown_input_observer_follows_its_equations():
    """On the quadruple tank it equals DOP853 on the equations written out."""
    H, K = [[0.9, 0.1], [0.0, 0.8], [0.4, 0.3], [0.1, 0.5]], [[0.3, 0.0], [0.1, 0.4], [0.05, 0.1], [0.1, 0.02]]
    result = run("quadruple-tank", "unknown-input", PUMPS, {"h": H, "k": K, "tau": 5.0}, faults=TANK_FAULTS, **TANKS)
    y0 = [result.column(f"y.{name}")[0] for name in ("y1", "y2")]
    model, start = reference("quadruple-tank", PUMPS), [12.0, 12, 2, 1.5]
    expected = classical.unknown_input(model, TANK_SCENARIO, np.array(H), np.array(K), 5.0, start, y0)
    close(columns(result, "o.x", ("h1", "h2", "h3", "h4")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", PUMPS), expected["thetahat"], 1e-6)


def test_the_canonical_form_splits_the_eigenvalues():
    """A − (A + κ)Gₙ C has the eigenvalues of the motion on r = 0 and −κ for each output; Gₙ keeps faults out of it."""
    built = estimator_of(LINEAR, "sliding-mode", ("inflow",))
    A, C, Phi = np.array([[-2, 1, 0], [0, -1, 0], [1, 0, -0.5]]), np.eye(3)[[0, 2]], np.array([[1.0], [0], [0]])
    G, kappa = matrix(built, "g.gn", 3, 2), built.parameters["g.kappa"]
    assert pytest.approx(np.eye(2), abs=1e-9) == C @ G
    assert (np.eye(3) - G @ C) @ Phi == pytest.approx(np.zeros((3, 1)), abs=1e-9)
    kernel = np.array([0.0, 1, 0])
    motion = kernel @ (np.eye(3) - G @ C) @ A @ kernel
    found = np.linalg.eigvals(A - (A + kappa * np.eye(3)) @ G @ C)
    assert np.poly(found) == pytest.approx(np.poly([motion, -kappa, -kappa]), rel=1e-6)
    assert motion < 0


def test_decoupled_faults_do_not_reach_the_state_at_all():
    """Where it shines: two faults of any shape change x̂ − x by nothing, and the other observers' by far more."""
    faults = [SWING, {"channel": "drain", "shape": "step", "onset": 4.0, "size": 30.0}]

    def error(kind: str) -> np.ndarray:
        faulty = lags(kind, ("inflow", "drain"), faults)
        return columns(faulty, "o.x", ("a", "b", "c")) - columns(faulty, "x", ("a", "b", "c"))

    assert np.abs(error("unknown-input")).max() < 1e-6
    assert np.abs(error("proportional-integral")).max() > 0.1


def test_structured_residuals_name_the_fault():
    """Each observer of a set leaves out one fault: the residual is quiet for that fault and for no other."""
    quiet = {}
    for decoupled in ("inflow", "drain"):
        for channel in ("inflow", "drain"):
            fault = {"channel": channel, "shape": "step", "onset": 4.0, "size": 0.4}
            noise = {y: {"std": 0.01, "sample_time": 0.05} for y in ("y1", "y2")}
            result = lags("unknown-input", (decoupled,), [fault], noise=noise)
            quiet[decoupled, channel] = verdicts(result)["no other fault in the residual"]
    assert {pair for pair, verdict in quiet.items() if verdict == "holds"} == {("inflow",) * 2, ("drain",) * 2}
    assert [verdict for pair, verdict in quiet.items() if len(set(pair)) > 1] == ["fails", "fails"]


@pytest.mark.parametrize("kind", ["sliding-mode", "unknown-input"])
def test_a_fault_of_any_shape_is_followed(kind):
    """Where they shine: a fault that moves all the time, to a tenth of its size, with every assumption met."""
    result = lags(kind, ("inflow", "drain"), [SWING], {"tau": 0.05})
    error = result.column("o.theta.inflow") - result.column("theta.inflow")
    late = result.column("t") > 1.5
    assert np.abs(error[late]).max() < 0.07 and np.abs(result.column("o.theta.drain")).max() < 0.02
    assert "fails" not in verdicts(result).values()


@pytest.mark.parametrize("kind", ["sliding-mode", "unknown-input"])
@pytest.mark.parametrize("channel", ["drive", "offset"])
def test_faults_that_are_not_matched_are_refused(kind, channel):
    """Where they fail: a fault two derivatives away from the outputs, one of a sensor. The reason names others."""
    with pytest.raises(SpecError, match=f"{channel} do not meet .* inflow, drain would"):
        estimator_of(LINEAR, kind, (channel,))


def test_an_unstable_zero_is_refused():
    """The hidden state grows on r = 0, so no gain helps: neither observer exists."""
    grows = LINEAR | {"dynamics": {"a": "b - 2*a", "b": "u + 0.5*b", "c": "a - 0.5*c"}}
    for kind in ("sliding-mode", "unknown-input"):
        with pytest.raises(SpecError, match="none of its faults"):
            estimator_of(
                grows | {"outputs": LINEAR["outputs"][:1], "channels": LINEAR["channels"][:1]}, kind, ("inflow",)
            )


def test_too_weak_a_switching_leaves_the_boundary_layer():
    """Where the sliding mode ends: a fault larger than ρ, at which the check fails and θ̂ stays far too small."""
    fault = {"channel": "drain", "shape": "step", "onset": 2.0, "size": 3.0}
    gains = {"rho": 0.1, "kappa": 0.0, "layer": 0.05}
    weak = lags("sliding-mode", ("inflow", "drain"), [fault], gains)
    assert verdicts(weak)["output error within the boundary layer"] == "fails"
    assert weak.column("o.theta.drain")[-1] < 1.0
    strong = lags("sliding-mode", ("inflow", "drain"), [fault], {**gains, "rho": 5.0})
    assert strong.column("o.theta.drain")[-1] == pytest.approx(3.0, rel=1e-3)


def test_within_the_layer_the_injection_is_exact_at_rest():
    """A motor at constant voltage: both faults to 1e-6, although r is not zero in the boundary layer."""
    spec = {"horizon": 6.0, "step": 0.001, "evaluate": 0.01, "initial": {"speed": 150, "current": 3}}
    faults = [{"channel": "gain_loss", "shape": "step", "onset": 2.0, "size": 0.15}]
    result = run("dc-motor", "sliding-mode", MOTOR, {}, faults=faults, **spec)
    assert result.column("o.theta.gain_loss")[-1] == pytest.approx(0.15, abs=1e-6)
    assert abs(result.column("o.theta.load_torque")[-1]) < 1e-6


def test_the_chain_of_the_motor_is_followed():
    """With all states measured the sliding mode observer equals DOP853 on the motor with Coulomb friction, too."""
    numbers = {"kappa": 30.0, "rho": [400.0, 900.0], "layer": [0.5, 3.0], "tau": 0.05}
    result = run("dc-motor", "sliding-mode", MOTOR, {"gn": [[1, 0], [0, 1]], **numbers}, **DRIVE)
    numbers |= {"rho": np.array(numbers["rho"]), "layer": np.array(numbers["layer"])}
    expected = classical.sliding_mode(reference("dc-motor", MOTOR), DRIVEN, np.eye(2), numbers, [1.0, 20.0])
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-6)
    close(columns(result, "o.theta", MOTOR), expected["thetahat"], 1e-5)
