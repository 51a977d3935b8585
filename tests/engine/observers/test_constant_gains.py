"""The proportional-integral and the extended state observer against plain NumPy, theory and plants of both kinds."""

from math import comb

import numpy as np
import pytest

from tests.engine.observers.kalman_cases import close, columns, reference, run
from tests.reference import classical
from tests.reference.integration import Scenario, constant, sine, steps
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.engine.observers.classical import extended_state, proportional_integral
from thetascope.engine.observers.classical.design import operating_point
from thetascope.engine.simulation.experiment import Estimator
from thetascope_schemas import Experiment

MOTOR = ("gain_loss", "load_torque")
FAULTS = [
    {"channel": "gain_loss", "shape": "step", "onset": 0.5, "size": 0.15},
    {"channel": "load_torque", "shape": "step", "onset": 1.0, "size": 0.1},
]
DRIVE = {
    "initial": {"current": 1, "speed": 20},
    "horizon": 2.0,
    "step": 0.0005,
    "evaluate": 0.01,
    "inputs": {"voltage": {"kind": "sine", "amplitude": 4, "frequency": 1.5, "offset": 12}},
    "faults": FAULTS,
}
DRIVEN = Scenario(
    2.0, 0.01, [sine(4, 1.5, offset=12)], [constant(0)], [steps([0.5], [0, 0.15]), steps([1.0], [0, 0.1])]
)
CHAIN = {
    "id": "cart",
    "states": [{"name": "s", "scale": 3.0}, {"name": "v", "scale": 0.5}],
    "inputs": [{"name": "u"}],
    "outputs": [{"name": "y", "expression": "s", "scale": 7.0}],
    "dynamics": {"s": "v", "v": "u"},
    "channels": [{"name": "force", "kind": "process", "enters": {"v": "1"}, "typical": 0.2}],
}


def estimator_of(plant: str | dict, kind: str, channels: tuple[str, ...], **spec) -> Estimator:
    """Return an observer with its default gains, ready to run."""
    observer = {"label": "o", "kind": kind, "options": {"channels": ",".join(channels)}}
    data = {"plant": plant, "observers": [observer], "horizon": 10.0, "step": 0.01, "faults": []}
    return prepare(library.resolve(Experiment.model_validate(data | spec))).engine.estimators[0]


def matrix(built: Estimator, name: str, rows: int, columns_: int) -> np.ndarray:
    return np.array([[built.parameters[f"{name}.{i}.{j}"] for j in range(columns_)] for i in range(rows)])


def verdicts(result: Result) -> dict[str, str]:
    return {str(check.name): check.verdict for check in result.observers[0].checks}


def test_the_proportional_integral_observer_follows_its_equations():
    """On the motor, with an actuator and a process fault, it equals DOP853 on the equations written out."""
    kp, ki = [[60.0, -0.4], [2.0, 40.0]], [[-0.8, 0.02], [0.05, -0.15]]
    result = run("dc-motor", "proportional-integral", MOTOR, {"kp": kp, "ki": ki}, **DRIVE)
    model = reference("dc-motor", MOTOR)
    expected = classical.proportional_integral(model, DRIVEN, np.array(kp), np.array(ki), [1.0, 20.0])
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-7)
    close(columns(result, "o.theta", MOTOR), expected["thetahat"], 1e-6)


@pytest.mark.parametrize(
    ("plant", "channels"),
    [("dc-motor", MOTOR), ("quadruple-tank", ("pump1", "pump2")), ("quadruple-tank", ("level1", "leak4"))],
)
def test_default_integral_gains_mirror_the_slow_eigenvalues(plant, channels):
    """Each eigenvalue λ slower than ω/2 becomes −ω − λ, a fault's −ω; the others stay."""
    built = estimator_of(plant, "proportional-integral", channels)
    c, p = built.context, len(channels)
    A, C = (np.array(part) for part in (c.scales.slopes.A, c.scales.slopes.C))
    names = [channel["name"] for channel in c.model["channels"]]
    Phi, Psi = (
        np.array(part)[:, [names.index(one) for one in channels]] for part in (c.scales.slopes.Phi, c.scales.slopes.Psi)
    )
    joint = np.block([[A, Phi], [np.zeros((p, c.n + p))]])
    L = np.vstack([matrix(built, "g.kp", c.n, c.m), matrix(built, "g.ki", p, c.m)])
    found = np.linalg.eigvals(joint - L @ np.hstack([C, Psi]))
    omega = proportional_integral.FAST * max(c.scales.rate, 5 / c.scales.span)
    wished = [-omega - e if e.real > -omega / 2 else e for e in np.linalg.eigvals(joint)]
    assert np.poly(found / omega) == pytest.approx(np.poly(np.array(wished) / omega), rel=1e-6, abs=1e-6)


def test_of_a_chain_of_integrators_the_gains_are_gaos():
    """The coefficients of (s + ω)³, 3ω, 3ω² and ω³, whatever the scales of states and outputs."""
    built = estimator_of(CHAIN, "extended-state", ("force",))
    omega = built.parameters["g.omega"]
    K = sum(omega**k * matrix(built, f"k.E{k}", 3, 1) for k in range(4))
    assert K[:, 0] == pytest.approx([3 * omega, 3 * omega**2, omega**3], rel=1e-9)


@pytest.mark.parametrize("omega", [0.02, 0.3, 5.0])
@pytest.mark.parametrize(
    ("plant", "channels"),
    [("dc-motor", MOTOR), ("quadruple-tank", ("pump1", "pump2")), ("dts200", ("pump1", "leak2", "level3"))],
)
def test_one_bandwidth_places_all_eigenvalues(plant, channels, omega):
    """The characteristic polynomial of the error is (s + ω)^(n + p), with several outputs and sensor faults too."""
    c = estimator_of(plant, "extended-state", channels).context
    point = operating_point(c).of(channels)
    A, C = point.joint
    K = sum(omega**k * one for k, one in enumerate(extended_state.polynomials(point)))
    size = len(A)
    assert np.poly((A - K @ C) / omega) == pytest.approx([comb(size, k) for k in range(size + 1)], rel=1e-5, abs=1e-5)


def test_the_extended_state_observer_follows_its_equations():
    """With the gains of its polynomials at another bandwidth it equals DOP853."""
    built = estimator_of("dc-motor", "extended-state", MOTOR, **{k: v for k, v in DRIVE.items() if k != "initial"})
    L = sum(40.0**k * matrix(built, f"k.E{k}", 4, 2) for k in range(5))
    result = run("dc-motor", "extended-state", MOTOR, {"omega": 40.0}, **DRIVE)
    expected = classical.proportional_integral(reference("dc-motor", MOTOR), DRIVEN, L[:2], L[2:], [1.0, 20.0])
    close(columns(result, "o.x", ("current", "speed")), expected["xhat"], 1e-7)
    close(columns(result, "o.theta", MOTOR), expected["thetahat"], 1e-6)


@pytest.mark.parametrize("kind", ["proportional-integral", "extended-state"])
def test_without_excitation_constant_faults_are_found_exactly(kind):
    """Where they shine: a motor at constant voltage, both faults to 1e-6 of a typical one, and every check holds."""
    spec = {"horizon": 6.0, "step": 0.001, "evaluate": 0.01, "initial": {"speed": 150, "current": 3}}
    result = run("dc-motor", kind, MOTOR, {}, **spec, faults=[f | {"onset": 2.0} for f in FAULTS])
    assert result.column("o.theta.gain_loss")[-1] == pytest.approx(0.15, abs=1e-7)
    assert result.column("o.theta.load_torque")[-1] == pytest.approx(0.1, abs=1e-7)
    assert set(verdicts(result).values()) == {"holds"}


@pytest.mark.parametrize("kind", ["proportional-integral", "extended-state"])
def test_a_fault_whose_effect_changes_its_sign_defeats_constant_gains(kind):
    """Where they fail: friction of a motor that turns both ways. The check of the error dynamics says so."""
    spec = library.experiment("friction-motor").model_dump(mode="json")
    spec |= {"observers": [{"label": "o", "kind": kind}], "figures": [], "noise": {}}
    result = prepare(library.resolve(Experiment.model_validate(spec))).run()
    assert verdicts(result)["Aₑ − KₑCₑ stable"] != "holds"


@pytest.mark.parametrize("kind", ["proportional-integral", "extended-state", "sliding-mode", "unknown-input"])
def test_more_faults_than_outputs_are_refused_with_those_that_fit(kind):
    """The reason names the channels; without a choice the observer takes those that fit together."""
    with pytest.raises(SpecError, match="gain_loss, load_torque would"):
        estimator_of("dc-motor", kind, (*MOTOR, "friction_increase"))
    observer = {"label": "o", "kind": kind}
    data = {"plant": "dc-motor", "observers": [observer], "horizon": 1.0, "step": 0.001, "faults": []}
    assert prepare(library.resolve(Experiment.model_validate(data))).engine.estimators[0].channels == MOTOR
