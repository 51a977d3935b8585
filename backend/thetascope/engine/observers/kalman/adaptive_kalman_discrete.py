"""Adaptive Kalman observer for sampled data: Zhang, Automatica 93 (2018), 333–342, with Ψ for sensor faults.

    x(k) = F x(k−1) + Φ θ + w,   y(k) = C x(k) + Ψ θ + v,   w ~ (0, Q), v ~ (0, R)

For nonlinear plants F and Φ are the derivatives of the flow over one sample interval (rk4_map.py), C and Ψ those of the
output at the predicted state: the extended filter. All covariances are updated in Joseph's form, a sum of squares, so
that they stay positive definite at any sample period.

Forgetting is bounded by default: each sample replaces the share 1 − μ of the information by the prior information
Γ̄⁻¹, so that S stays below Γ̄ where the input excites a fault too little. With the option forgetting = plain, S
follows the paper and grows without bound there.

λ is given as a rate, in 1/s; a sample forgets by μ = exp(−λ·period), so that its meaning does not depend on the period.
About S: its inverse sums Ωᵀ Σ⁻¹ Ω with weights μ^age, while the covariance of the estimate of a constant θ sums it with
weights μ^(2·age); where Ω changes slowly that is S/(1 + μ), of which ``claimed.<channel>`` is the root of the diagonal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.result import Check
from thetascope.engine.observers.kalman.rk4_map import SUBSTEPS, flow
from thetascope.engine.observers.support.common_checks import bounded_covariance, claimed_sigma, positive_definite
from thetascope.engine.observers.support.declaration import Observed, Observer
from thetascope.engine.observers.support.draft import NOW, Draft
from thetascope.engine.observers.support.draft_linalg import joseph, solve
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
    GAMMA0,
    LAMBDA,
    P0,
    PLAIN,
    R_VARIANCE,
    WINDOW,
    Q,
)
from thetascope.engine.observers.support.matrices import Matrix, diag
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr

SOURCE = "Zhang 2018, Automatica 93"


def write(d: Draft) -> None:
    """Write the equations of the observer."""
    n, m, p = d.n, d.m, d.p
    Q, R = diag(d.gain("q")) * d.period, diag(d.gain("r"))
    mu = cast("Expr", d.let("mu", sympy.exp(-d.gain("lambda") * d.period)))
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    P = d.symmetric("P", n, initial=diag(d.gain("p0")))
    Upsilon = d.states("Upsilon", n, p)
    S = d.symmetric("S", p, initial=diag(d.gain("gamma0")))
    last_Omega = d.states("Omega", m, p)  # Ω of the last sample, kept for the record

    x_minus, F, Phi = flow(d, "flow", x, theta)  # x⁻, F = ∂x⁻/∂x, Φ = ∂x⁻/∂θ
    at = d.at(x_minus, theta, NOW)
    C, Psi = d.let("C", at.C), d.let("Psi", at.Psi)
    P_minus = d.let("P-", F @ P @ F.T + Q, symmetric=True)
    Sigma = d.let("Sigma", C @ P_minus @ C.T + R, symmetric=True)
    K = solve(d, "K", Sigma, C @ P_minus).T  # P⁻ Cᵀ Σ⁻¹
    Upsilon_minus = d.let("Upsilon-", F @ Upsilon + Phi)
    Omega = d.let("Omega", C @ Upsilon_minus + Psi)
    Lambda = d.let("Lambda", mu * Sigma + Omega @ S @ Omega.T, symmetric=True)
    G = solve(d, "G", Lambda, Omega @ S).T  # S Ωᵀ Λ⁻¹

    innovation = d.let("innovation", d.measured(NOW) - at.h - Psi @ theta)  # ỹ
    dtheta = d.let("dtheta", G @ innovation)
    Upsilon_plus = d.let("Upsilon+", Upsilon_minus - K @ Omega)
    d.set(x, x_minus + K @ innovation + Upsilon_plus @ dtheta)
    d.set(theta, theta + dtheta)
    d.set(Upsilon, Upsilon_plus)
    d.set(last_Omega, Omega)
    d.set(P, joseph(d, "P+", P_minus, K, C, R))  # (I − KC) P⁻ (I − KC)ᵀ + K R Kᵀ
    S_plus = joseph(d, "S+", S, G, Omega, mu * Sigma) / mu  # S − GΩS, over μ
    d.set(S, S_plus if d.options.get("forgetting") == PLAIN else bounded(d, S_plus, mu))

    updated = d.at(x, theta)
    d.estimates(x, theta, updated.h + updated.Psi @ theta)
    offer_linearisation(d, updated.A, updated.C, updated.Phi, updated.Psi)


def bounded(d: Draft, S: Matrix, mu: Expr) -> Matrix:
    """Return (S⁻¹ + (1 − μ) Γ̄⁻¹)⁻¹ (p×p): the share of the information that is forgotten is replaced by that of Γ̄.

    Without excitation S then tends to Γ̄ instead of growing like μ^(−k). Each channel is a rank-one update.
    """
    for j, most in enumerate(d.gain("bound")):
        S = d.let(f"S+{j}", S, symmetric=True)
        column = S[:, j]
        S = S - column @ column.T * ((1 - mu) / (S[j, j] * (1 - mu) + most))
    return S


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    period = run.context.period
    return [
        observability(run, "Kalman 1960"),
        closed_loop(run, SOURCE, period),
        positive_definite(run, "P", run.context.n, "Kalman 1960"),
        excitation_check(run, run.values["pe"], SOURCE),
        bounded_covariance(run, "S", SOURCE),
    ]


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``pe``: λmin of Σ ΩᵀR⁻¹Ω over the window, in typical faults; ``claimed.<channel>``: √(S/(1 + μ)), see above."""
    mu = np.exp(-run.values["g.lambda"] * run.context.period)
    return {"pe": excitation(run, 1 / run.context.period), **claimed_sigma(run, "S", (1 + mu) ** -0.5)}


OBSERVER = Observer(
    id="adaptive-kalman-discrete",
    source="Zhang 2018, Automatica 93, 333–342; Joseph's form: Bucy & Joseph 1968",
    gains=(Q, R_VARIANCE, P0, LAMBDA, GAMMA0, BOUND, WINDOW, DELTA),
    options=(SUBSTEPS, FORGETTING_OPTION),
    takes_events=True,
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    time="discrete",
    equations=(
        ("", "P⁻ = FPFᵀ + Q"),
        ("", "Σ = CP⁻Cᵀ + R"),
        ("", "K = P⁻CᵀΣ⁻¹"),
        ("", "Ω = C(FΥ + Φ) + Ψ"),
        ("", "Λ = μΣ + ΩSΩᵀ"),
        ("", "G = SΩᵀΛ⁻¹"),
        ("", "θ̂⁺ = θ̂ + Gỹ"),
        ("", "x̂⁺ = x̂⁻ + Kỹ + Υ⁺(θ̂⁺ − θ̂)"),
        ("", "Υ⁺ = FΥ + Φ − KΩ"),
        ("", "S⁺ = ([{1 / μ}(S − GΩS)]⁻¹ + (1 − μ)Γ̄⁻¹)⁻¹"),
    ),
    where=(
        ("ỹ", Message("symbol.innovation")),
        ("F", Message("symbol.flow-jacobian")),
        ("μ", Message("symbol.forgetting-sample")),
        ("Γ̄", Message("symbol.bound")),
    ),
)
