"""The Zhao–Li–Li observers against independent implementations, in the paper's coordinates, others, and for n = 3."""

import numpy as np
import pytest

from tests.reference import zhao as reference
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.observers.papers.high_gain import A0, S, c0, k0
from thetascope_schemas import Experiment

PENDULUM = {
    "id": "pendulum",
    "title": "A damped pendulum behind an actuator lag",
    "time": {"kind": "continuous"},
    "states": [{"name": "x1", "initial": 0.3}, {"name": "x2"}, {"name": "x3"}],
    "inputs": [{"name": "u"}],
    "outputs": [{"name": "y", "expression": "x1"}],
    "parameters": [
        {"name": "g", "value": 9.0},
        {"name": "d", "value": 0.5},
        {"name": "tau", "value": 0.5},
        {"name": "b", "value": 4.0},
    ],
    "signals": [
        {"name": f"s{i}", "default": {"kind": "pulse", "low": 0, "high": 1, "period": p, "width": p / 2, "start": 0}}
        for i, p in ((1, 1.5), (2, 4.0), (3, 0.5))
    ],
    "dynamics": {"x1": "x2", "x2": "x3 - g*sin(x1) - d*x2", "x3": "(b*u - x3)/tau"},
    "channels": [
        {"name": "theta1", "kind": "process", "enters": {"x2": "s1"}},
        {"name": "theta2", "kind": "actuator", "enters": {"x3": "b/tau*s2"}},
        {"name": "theta3", "kind": "sensor", "enters": {"y": "s3"}},
    ],
}
FAULTS = [
    {"channel": c, "shape": "step", "onset": t, "size": s}
    for c, t, s in (("theta1", 2, 0.5), ("theta2", 3, -0.1), ("theta3", 4, 0.05))
]


def pendulum(kind: str, gains: dict, horizon: float, step: float) -> "object":
    start = {"x1": 0, "x2": 0, "x3": 0}
    return simulate(
        library.resolve(
            Experiment.model_validate(
                {
                    "plant": PENDULUM,
                    "inputs": {"u": {"kind": "sine", "amplitude": 1.0, "frequency": 0.3}},
                    "faults": FAULTS,
                    "horizon": horizon,
                    "step": step,
                    "evaluate": 0.01,
                    "observers": [{"label": "o", "kind": kind, "gains": gains, "initial": start}],
                }
            )
        )
    )


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_s_and_k0_solve_their_equations_for_any_n(n):
    """A0ᵀS + S A0 + S = c0ᵀc0 (7), k0 = ½ S⁻¹c0ᵀ (8), and A0 − k0 c0 is stable."""
    assert A0(n).T @ S(n) + S(n) @ A0(n) + S(n) == c0(n).T @ c0(n)
    assert 2 * S(n) @ k0(n) == c0(n).T
    closed = (A0(n) - k0(n) @ c0(n)).entries
    assert np.linalg.eigvals(np.array(closed, dtype=float)).real.max() < 0


def test_the_adaptive_observer_agrees_with_dop853_on_a_plant_of_three_states():
    """On the pendulum states and θ̂ of a fine RK4 run agree with SciPy's DOP853 at tight tolerance to 1e-6."""
    gains = reference.PENDULUM_GAINS
    result = pendulum("zhao-adaptive", {"rho": gains.rho, "lambda": gains.lam, "gamma0": gains.gamma0}, 6.0, 0.0005)
    exact = reference.dop853(reference.PENDULUM, reference.pendulum_scenario(6.0), gains, rtol=1e-9)
    for i in range(3):
        np.testing.assert_allclose(result.column(f"o.x.x{i + 1}"), exact["xhat"][:, i], atol=2e-6)
        np.testing.assert_allclose(result.column(f"o.theta.theta{i + 1}"), exact["thetahat"][:, i], atol=2e-6)


def test_the_high_gain_observer_agrees_with_dop853():
    """Equation (9) on the pendulum, without estimates of its faults."""
    result = pendulum("high-gain", {"rho": 4.0}, 6.0, 0.001)
    exact = reference.dop853(
        reference.PENDULUM, reference.pendulum_scenario(6.0), reference.PENDULUM_GAINS, kind="high-gain", rtol=1e-9
    )
    for i in range(3):
        np.testing.assert_allclose(result.column(f"o.x.x{i + 1}"), exact["xhat"][:, i], atol=1e-7)


def test_the_paper_run_agrees_with_plain_runge_kutta_step_by_step():
    """Zhao's plant for 5 s at 1 ms against the same scheme in NumPy."""
    spec = library.experiment("zhao-2012-noise-free").model_dump() | {"horizon": 5.0}
    result = simulate(library.resolve(Experiment.model_validate(spec)))
    plain = reference.rk4(scenario=reference.paper_scenario(5.0), h=0.001)
    np.testing.assert_allclose(result.column("adaptive.x.x2"), plain["xhat"][:, 1], atol=1e-11)
    np.testing.assert_allclose(result.column("adaptive.theta.theta3"), plain["thetahat"][:, 2], atol=1e-11)


def contois(plant: str, names: tuple[str, str], start: tuple[float, float]) -> "object":
    fault = [{"channel": "theta3", "shape": "step", "onset": 4, "size": 0.02}]
    return simulate(
        library.resolve(
            Experiment.model_validate(
                {
                    "plant": plant,
                    "faults": fault,
                    "horizon": 10.0,
                    "step": 0.0005,
                    "evaluate": 0.01,
                    "initial": {},
                    "signals": {},
                    "observers": [
                        {
                            "label": "o",
                            "kind": "zhao-adaptive",
                            "gains": {"rho": 4, "lambda": 4, "gamma0": 1},
                            "initial": dict(zip(names, start, strict=True)),
                        }
                    ],
                }
            )
        )
    )


def test_physical_coordinates_give_the_canonical_observer_through_lie_derivatives():
    """Contois in x̄: the estimates in canonical coordinates are those of the observer written there."""
    plant = library.plant("contois-physical")
    names = tuple(s.name for s in plant.states)
    result = contois("contois-physical", names, (0.08, 0.02))
    signals = {s.name: s.default for s in plant.signals}
    assert {"phi1", "phi2", "phi3"} == set(signals)
    physical = np.stack([result.column(f"o.x.{n}") for n in names], axis=1)
    mapped = reference.from_physical(physical)
    scenario = reference.paper_scenario(10.0)
    truth = reference.from_physical(np.array([[s.initial for s in plant.states]]))[0]
    exact = reference.dop853(
        _with_start(reference.CONTOIS, truth),
        _only_theta3(scenario, plant),
        reference.Gains(xhat0=tuple(reference.from_physical(np.array([[0.08, 0.02]]))[0])),
        rtol=1e-9,
    )
    np.testing.assert_allclose(mapped, exact["xhat"], atol=2e-6)
    np.testing.assert_allclose(result.column("o.theta.theta3"), exact["thetahat"][:, 2], atol=2e-6)


def _with_start(plant: reference.Plant, x0: np.ndarray) -> reference.Plant:
    from dataclasses import replace

    return replace(plant, x0=tuple(x0))


def _only_theta3(scenario, plant):
    from dataclasses import replace

    from tests.reference.integration import constant, steps

    level = plant.inputs[0].default
    return replace(scenario, inputs=[constant(level)], theta=[constant(0.0), constant(0.0), steps([4], [0, 0.02])])
