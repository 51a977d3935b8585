"""Theorem 2 of Zhao, Li & Li in numbers: V and the constants against the paper's formulas on an independent run."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.observers.test_zhao_adaptive import PENDULUM, _only_theta3, _with_start, contois, pendulum
from tests.reference import zhao as reference
from tests.reference.integration import constant, steps
from tests.simulate import simulate
from thetascope import library
from thetascope.engine.model.result import Check, Result
from thetascope_schemas import Experiment

GAINS = reference.PENDULUM_GAINS
HORIZON = 6.0


@pytest.fixture(scope="module")
def run() -> Result:
    gains = {"rho": GAINS.rho, "lambda": GAINS.lam, "gamma0": GAINS.gamma0}
    return pendulum("zhao-adaptive", gains, HORIZON, 0.0005)


@pytest.fixture(scope="module")
def exact() -> dict:
    return reference.dop853(reference.PENDULUM, reference.pendulum_scenario(HORIZON), GAINS, rtol=1e-9)


def check(result: Result, code: str) -> Check:
    return next(one for one in result.observers[0].checks if one.name.code == code)


def lyapunov(exact: dict, rho: float) -> tuple[np.ndarray, np.ndarray]:
    """Return V1 = ηᵀSη and V2 = θ̃ᵀΓ⁻¹θ̃ of a run of the reference, η = z̃ − Υθ̃."""
    n = exact["xhat"].shape[1]
    S, _ = reference.injection(n)
    theta = exact["thetahat"] - exact["theta"]
    eta = (exact["xhat"] - exact["x"]) * rho ** -np.arange(float(n)) - np.einsum("tij,tj->ti", exact["Upsilon"], theta)
    weighted = np.linalg.solve(exact["Gamma"], theta[:, :, None])[:, :, 0]
    return np.einsum("ti,ij,tj->t", eta, S, eta), np.einsum("ti,ti->t", theta, weighted)


def test_v_is_that_of_an_independent_run(run, exact):
    """V1 = ηᵀSη and V2 = θ̃ᵀΓ⁻¹θ̃ with η = z̃ − Υθ̃, from states of DOP853 at tight tolerance."""
    first, second = lyapunov(exact, GAINS.rho)
    np.testing.assert_allclose(run.column("o.V1"), first, rtol=1e-4, atol=1e-7)
    np.testing.assert_allclose(run.column("o.V2"), second, rtol=1e-4, atol=1e-7)
    assert np.array_equal(run.column("o.V"), run.column("o.V1") + run.column("o.V2"))


def test_the_constants_are_those_of_the_proof(run, exact):
    """c1 … c10 and the smallest ρ by (39)–(42), with the pendulum's Jacobian written by hand."""
    (S, _), upsilon, gamma = reference.injection(3), exact["Upsilon"], exact["Gamma"]
    values = {p["name"]: p["value"] for p in PENDULUM["parameters"]}
    slopes = np.zeros((len(exact["xhat"]), 3, 3))
    slopes[:, 1, 0] = -values["g"] * np.cos(exact["xhat"][:, 0])
    slopes[:, 1, 1], slopes[:, 2, 2] = -values["d"], -1 / values["tau"]
    psi = np.stack([reference.PENDULUM.Psi(None, s) for s in exact["signal"]])
    least = np.linalg.eigvalsh(S)[0]
    largest = np.linalg.eigvalsh(gamma).max()
    c1 = np.linalg.norm(slopes, 2, axis=(1, 2)).max()
    c2 = c1 * np.linalg.norm(upsilon, 2, axis=(1, 2)).max()
    c3, c4 = 2 * c1 * np.linalg.norm(S, 2), 2 * c2 * np.linalg.norm(S, 2)
    omega = np.linalg.norm(upsilon[:, 0] + psi, axis=1).max()
    c5, c6 = c3 / least, c4 * np.sqrt(largest / least)
    c7, c8 = omega**2, 2 * omega
    c9, c10 = c7 * largest, c8 * np.sqrt(largest / least)
    found = check(run, "check.theorem2")
    shown = [float(c) for c in found.text.args["constants"]]
    np.testing.assert_allclose(shown, [c1, c2, c3, c4, c5, c6, c7, c8, c9, c10], rtol=6e-3)
    rho = found.threshold
    assert (rho - c5) * (rho - c9) == pytest.approx((c6 + c10) ** 2 / 4, rel=1e-2) and rho > max(c5, c9)
    assert found.verdict == "fails" and found.value == GAINS.rho


def test_v_rises_in_a_fifth_of_the_steps_of_the_paper():
    """At ρ = 4, without noise, between changes of the faults; the check says so. A record has no V."""
    result = simulate(library.resolve(library.experiment("zhao-2012-noise-free")))
    V, theta = result.column("adaptive.V"), np.stack([result.column(f"theta.theta{i}") for i in (1, 2, 3)])
    judged = (np.diff(theta) == 0).all(axis=0) & (V[:-1] > 1e-16 * V.max())
    share = (np.diff(V)[judged] > 1e-9 * V[:-1][judged]).mean()
    found = check(result, "check.lyapunov-falls")
    assert found.verdict == "fails" and found.value == pytest.approx(share, abs=1e-9) and 0.15 < share < 0.25
    assert V[-1] < 1e-12 * V[0], "it falls in the end"


def test_all_eigenvalues_of_the_gramian_are_columns():
    """Fig. 5: gramian.1 ≤ gramian.2 ≤ gramian.3, the first being pe; their sum is the trace of the integral of ΩᵀΩ."""
    spec = library.experiment("zhao-2012-noise-free").model_dump() | {"horizon": 8.0}
    result = simulate(library.resolve(Experiment.model_validate(spec)))
    rows = np.flatnonzero(np.isfinite(result.column("adaptive.pe")))
    values = np.stack([result.column(f"adaptive.gramian.{k}")[rows] for k in (1, 2, 3)])
    assert np.array_equal(values[0], result.column("adaptive.pe")[rows]) and (np.diff(values, axis=0) >= 0).all()


def test_other_coordinates_have_the_v_of_the_canonical_ones():
    """Contois in physical coordinates: V by Lie derivatives is that of the reference in canonical coordinates."""
    plant = library.plant("contois-physical")
    names = tuple(s.name for s in plant.states)
    result = contois("contois-physical", names, (0.08, 0.02))
    truth = reference.from_physical(np.array([s.initial for s in plant.states]))
    exact = reference.dop853(
        _with_start(reference.CONTOIS, truth),
        _only_theta3(reference.paper_scenario(10.0), plant),
        reference.Gains(xhat0=tuple(reference.from_physical(np.array([0.08, 0.02])))),
        rtol=1e-9,
    )
    V = sum(lyapunov(exact, 4.0))
    np.testing.assert_allclose(result.column("o.V"), V, rtol=1e-3, atol=1e-8)
    assert V.max() > 1e-4


def test_a_channel_may_enter_a_state_and_the_output():
    """Remark 1: θ2 enters x1' and y. The estimates agree with DOP853 of the paper's equations and reach the truth."""
    changes = {"horizon": 12.0, "inputs": {}, "faults": [], "observers": []}
    spec = library.experiment("zhao-2012-remark-1").model_dump()
    onsets = {"theta1": 2.0, "theta2": 5.0}
    changes["faults"] = [fault | {"onset": onsets[fault["channel"]]} for fault in spec["faults"]]
    start = {"x1": 0.08, "x2": 0.02}
    changes["observers"] = [spec["observers"][0] | {"initial": start}]
    result = simulate(library.resolve(Experiment.model_validate(spec | changes)))
    paper = reference.PAPER
    shared = replace(
        paper,
        p=2,
        Phi=lambda x, u, s: paper.Phi(x, u, s)[:, :2],
        Psi=lambda u, s: np.array([0.0, s[2]]),
        Phi_saturated=lambda x, u, s: paper.Phi_saturated(x, u, s)[:, :2],
    )
    level = library.plant("zhao-contois-shared").inputs[0].default
    theta = [steps([onset], [0.0, 0.01]) for onset in onsets.values()]
    scenario = replace(reference.paper_scenario(12.0), inputs=[constant(level)], theta=theta)
    exact = reference.dop853(shared, scenario, reference.Gains(xhat0=tuple(start.values())), rtol=1e-9)
    for i in (0, 1):
        np.testing.assert_allclose(result.column(f"adaptive.x.x{i + 1}"), exact["xhat"][:, i], atol=2e-6)
        np.testing.assert_allclose(result.column(f"adaptive.theta.theta{i + 1}"), exact["thetahat"][:, i], atol=2e-6)
    assert result.column("adaptive.theta.theta2")[-1] == pytest.approx(0.01, abs=1e-4)
