"""Plants and observers as linear systems: A, B, C, D and gains against differences, a paper and the runs themselves."""

import numpy as np
import pytest

import thetascope
from tests.runs.samples import PLANT, spec_data
from thetascope import library
from thetascope.engine.programs.program_store import plant_program
from thetascope.linear import LinearSystem
from thetascope.runs.specs.refusals import InvalidSpec


def slopes(plant, point: dict[str, float], names: list[str], t: float) -> np.ndarray:
    """Return the derivatives of update and outputs by central differences, with NumPy on the plant's graph."""
    program = plant_program(plant.model_dump(mode="json")).program
    roots = [*(f"d.{s}" for s in program.states), *program.outputs]

    def values(moved: dict[str, float]) -> np.ndarray:
        return np.array([float(v) for v in program.evaluate(roots, point | moved | {"t": t})])

    columns = []
    for name in names:
        h = 1e-6 * max(abs(point[name]), 1e-2)
        columns.append((values({name: point[name] + h}) - values({name: point[name] - h})) / (2 * h))
    return np.array(columns).T.reshape(len(roots), len(names))


@pytest.mark.parametrize("id", sorted(library.plants()))
def test_the_matrices_are_the_finite_differences_of_the_equations(id):
    """For each plant of the library, away from its initial state: A, B, C and D by states, inputs, signals, faults."""
    plant, random = library.plant(id), np.random.default_rng(3)

    def near(value: float) -> float:
        return (value or 0.1) * random.uniform(0.9, 1.1)

    at = {s.name: near(s.initial) for s in plant.states} | {u.name: near(u.default) for u in plant.inputs}
    at |= {s.name: random.uniform(0.5, 1) for s in plant.signals}
    at |= {f"theta.{c.name}": random.uniform(0, 0.05) * c.typical for c in plant.channels}
    linear = thetascope.linearise(plant, at, t=1.5)
    assert linear.states == tuple(s.name for s in plant.states)
    assert linear.outputs == tuple(y.name for y in plant.outputs)
    assert dict(linear.at) == at
    prefix = {s.name: "x" for s in plant.states} | {u.name: "u" for u in plant.inputs}
    prefix |= {s.name: "signal" for s in plant.signals}
    full = {name: name if name.startswith("theta.") else f"{prefix[name]}.{name}" for name in at}
    point = {full[name]: value for name, value in at.items()} | {f"p.{p.name}": p.value for p in plant.parameters}
    expected = slopes(plant, point, [full[name] for name in (*linear.states, *linear.inputs)], 1.5)
    given = np.block([[linear.A, linear.B], [linear.C, linear.D]])
    np.testing.assert_allclose(given, expected, rtol=2e-5, atol=2e-7 * np.abs(expected).max())


def test_the_quadruple_tank_has_the_time_constants_of_its_paper():
    """Johansson (2000), table of the minimum-phase setting: T1 … T4 are 62, 90, 23 and 30 s, without decimals."""
    linear = thetascope.linearise("quadruple-tank", faults=[])
    np.testing.assert_allclose(-1 / np.diag(linear.A), [62, 90, 23, 30], rtol=0, atol=1)
    assert linear.inputs == ("v1", "v2") and linear.B.shape == (4, 2) and linear.period is None


@pytest.mark.parametrize("kind", ["adaptive-kalman", "joint-ekf", "joint-ukf"])
def test_the_gain_of_an_observer_is_how_a_step_of_the_reading_moves_its_estimates(kind):
    """A reading that is off from t = 0.5 on moves x̂ and θ̂ at the rates of `gain`: measured by two runs."""
    plant = {**PLANT, "channels": [*PLANT["channels"], {"name": "bias", "kind": "sensor", "enters": {"y": 1}}]}
    observer = {"label": "it", "kind": kind}
    spec = spec_data(plant=plant, observers=[observer], noise={"y": {"std": 0.1}}, faults=[], horizon=0.6, seed=1)
    spec |= {"step": 1e-3, "evaluate": 1e-3, "diagnosis": {"enabled": False}}
    off = 1e-4
    biased = spec | {"faults": [{"channel": "bias", "shape": "step", "onset": 0.5, "size": off}]}
    own, moved = thetascope.run(spec), thetascope.run(biased)
    names = ["it.x.x", "it.theta.gain", "it.theta.bias"]
    row = round(0.5 / 1e-3)
    linear = thetascope.linearise_observer(spec, "it", at=0.5)
    apart = 1e-3 if linear.period is None else 1  # a rate, or a jump at the sample
    rates = [(moved.column(n)[row + 1] - own.column(n)[row + 1]) / (apart * off) for n in names]
    assert linear.states == ("x_hat", "theta.gain_hat", "theta.bias_hat") == linear.outputs and linear.inputs == (
        "u",
        "y.y",
    )
    np.testing.assert_allclose(linear.gain[:, 0], rates, rtol=0.02)
    at_sample = linear.level + (0 if linear.period is None else linear.rate)
    np.testing.assert_allclose(at_sample, [own.column(n)[row] for n in names])


def test_a_sampled_observer_has_its_period():
    """Its rows are next values: an observer of a steady plant stays where it is."""
    spec = spec_data(
        observers=[{"label": "it", "kind": "adaptive-kalman-discrete", "options": {"period": 0.1}}], faults=[]
    )
    linear = thetascope.linearise_observer(spec, "it")
    assert linear.period == pytest.approx(0.1) and linear.A.shape == (2, 2)
    assert np.abs(np.linalg.eigvals(linear.A)).max() <= 1 + 1e-9


def test_refusals_name_what_is_known():
    """Names, times and plants that do not exist are refused."""
    with pytest.raises(ValueError, match=r"no 'h9'.*h1"):
        thetascope.linearise("quadruple-tank", {"h9": 1})
    with pytest.raises(ValueError, match="no 'leak'"):
        thetascope.linearise(PLANT, faults=["leak"])
    with pytest.raises(ValueError, match="outside"):
        thetascope.linearise_observer(spec_data(), "kalman", at=2)
    with pytest.raises(ValueError, match="only kalman"):
        thetascope.linearise_observer(spec_data(), "ekf")
    with pytest.raises(InvalidSpec):
        thetascope.linearise({**PLANT, "dynamics": {"x": "1 +"}})


def test_python_control_gets_the_same_system():
    """Where python-control is installed: matrices, names, sample period; two subsystems connect by name."""
    control = pytest.importorskip("control")
    linear = thetascope.linearise("quadruple-tank", {"h1": 10})
    system = thetascope.to_control("quadruple-tank", {"h1": 10})
    np.testing.assert_array_equal(system.A, linear.A)
    np.testing.assert_array_equal(system.D, linear.D)
    assert system.input_labels[:3] == ["v1", "v2", "theta_pump1"] and system.state_labels == list(linear.states)
    assert system.isctime()
    sampled = LinearSystem(**{**vars(linear), "period": 0.5})
    assert thetascope.to_control(sampled).dt == 0.5
    poles = np.sort(control.poles(system).real)
    np.testing.assert_allclose(poles, np.sort(np.linalg.eigvals(linear.A).real))
