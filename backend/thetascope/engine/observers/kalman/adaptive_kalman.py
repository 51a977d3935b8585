"""Adaptive Kalman observer: Zhang's parameter filter on an extended Kalman–Bucy filter, for any continuous plant.

    x' = f(x, u) + Φθ,   y = h(x, u) + Ψθ

The state gain K comes from a Riccati equation instead of a high gain, so no canonical form is needed; Υ carries the
effect of θ on x̂, Ω its effect on the output; Ψ is for sensor faults (Zhao, Li & Li 2012 do the same with a high gain).
R weighs the outputs of a plant that has several.

Forgetting is bounded by default: −λΓΓ̄⁻¹Γ keeps Γ below Γ̄ where the input excites a fault too little (Γ̄⁻¹ is the
information that one has without any data). With the option forgetting = plain, the term is left out as in the paper.

About Γ: were the innovation white with intensity R, the estimate of a constant θ would have the covariance Γ Ξ Γ with
Ξ' = −2λΞ + ΩᵀR⁻¹Ω. Where Ω changes slowly against 1/λ that is Γ/2, and ``claimed.<channel>`` is the square root of its
diagonal. It counts measurement noise only: not the lag behind a θ that moves, nor an error of the model.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import Check
from thetascope.engine.observers.support.common_checks import bounded_covariance, claimed_sigma, positive_definite
from thetascope.engine.observers.support.declaration import Observed, Observer
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import (
    closed_loop,
    excitation,
    excitation_check,
    observability,
    offer_linearisation,
)
from thetascope.engine.observers.support.kalman_defaults import (
    BOUND,
    DELTA,
    FORGETTING_OPTION,
    GAMMA0_QUIET,
    LAMBDA,
    P0_QUIET,
    PLAIN,
    R_INTENSITY,
    WINDOW,
    Q,
)
from thetascope.engine.observers.support.matrices import diag
from thetascope.messages import Message

SOURCE = "Zhang 2002, IEEE TAC 47(3)"


def write(d: Draft) -> None:
    """Write the equations of the observer."""
    n, p, lam = d.n, d.p, d.gain("lambda")
    Q, R_inv = diag(d.gain("q")), diag([1 / r for r in d.gain("r")])
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    P = d.symmetric("P", n, initial=diag(d.gain("p0")))
    Upsilon = d.states("Upsilon", n, p)
    Gamma = d.symmetric("Gamma", p, initial=diag(d.gain("gamma0")))
    at = d.at(x, theta)
    A, C, Phi, Psi = d.let("A", at.A), d.let("C", at.C), d.let("Phi", at.Phi), d.let("Psi", at.Psi)
    d.let("AP", A @ P)  # these two products appear twice below, also transposed
    d.let("CP", C @ P)

    K = d.let("K", P @ C.T @ R_inv)
    Omega = d.let("Omega", C @ Upsilon + Psi)
    d.let("OmegaGamma", Omega @ Gamma)
    L = d.let("L", Gamma @ Omega.T @ R_inv)
    y_hat = d.let("y_hat", at.h + Psi @ theta)
    r = d.let("r", d.measured() - y_hat)
    dtheta = d.let("dtheta", L @ r)

    d.set(P, A @ P + P @ A.T + Q - K @ C @ P)
    d.set(Upsilon, A @ Upsilon + Phi - K @ Omega)  # (A − KC) Υ + Φ − KΨ
    forgotten = Gamma
    if d.options.get("forgetting") != PLAIN:
        forgotten = Gamma - Gamma @ diag([1 / most for most in d.gain("bound")]) @ Gamma
    d.set(Gamma, lam * forgotten - L @ Omega @ Gamma)  # λ(Γ − Γ Γ̄⁻¹ Γ) − Γ Ωᵀ R⁻¹ Ω Γ
    d.set(theta, dtheta)  # Γ Ωᵀ R⁻¹ (y − ŷ)
    d.set(x, at.f + Phi @ theta + K @ r + Upsilon @ dtheta)
    d.estimates(x, theta, y_hat)
    d.outputs("Omega", Omega)
    offer_linearisation(d, A, C, Phi, Psi)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [
        observability(run, "Kalman & Bucy 1961"),
        closed_loop(run, SOURCE),
        positive_definite(run, "P", run.context.n, "Kalman & Bucy 1961"),
        excitation_check(run, run.values["pe"], SOURCE),
        bounded_covariance(run, "Gamma", SOURCE),
    ]


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``pe``: λmin of ∫ΩᵀR⁻¹Ω dt, in typical faults; ``claimed.<channel>``: √(Γ/2), see above."""
    return {"pe": excitation(run), **claimed_sigma(run, "Gamma", 0.5**0.5)}


OBSERVER = Observer(
    id="adaptive-kalman",
    source="Zhang 2002, IEEE TAC 47(3), 525–529; Zhang & Clavel 2001, CDC; Kalman & Bucy 1961",
    gains=(Q, R_INTENSITY, P0_QUIET, LAMBDA, GAMMA0_QUIET, BOUND, WINDOW, DELTA),
    options=(FORGETTING_OPTION,),
    takes_events=True,
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    equations=(
        ("", "ẋ̂ = f(x̂, u) + Φθ̂ + [K + ΥΓΩᵀR⁻¹](y − ŷ)"),
        ("", "θ̇̂ = ΓΩᵀR⁻¹(y − ŷ)"),
        ("", "Ṗ = AP + PAᵀ + Q − PCᵀR⁻¹CP"),
        ("", "K = PCᵀR⁻¹"),
        ("", "Υ̇ = (A − KC)Υ + Φ − KΨ"),
        ("", "Γ̇ = λ(Γ − ΓΓ̄⁻¹Γ) − ΓΩᵀR⁻¹ΩΓ"),
        ("", "Ω = CΥ + Ψ"),
    ),
    where=(
        ("P", Message("symbol.riccati")),
        ("Υ", Message("symbol.upsilon")),
        ("Γ", Message("symbol.gamma-covariance")),
        ("Γ̄", Message("symbol.bound")),
    ),
)
