"""Joint extended Kalman filter: the state augmented by θ, which is taken to be a random walk.

    z = (x, θ),   x(k) = flow(x(k−1), θ) + w,   θ(k) = θ(k−1) + w_θ,   y(k) = h(x(k)) + Ψ θ + v

What one would try first; the baseline of the adaptive observers. Jazwinski, Stochastic Processes and Filtering Theory,
1970, ch. 8 (the extended filter); Ljung, IEEE TAC 24(1), 1979, on joint estimation and its convergence.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.kalman.rk4_map import SUBSTEPS, flow
from thetascope.engine.observers.support.common_checks import positive_definite, verdict
from thetascope.engine.observers.support.declaration import Observed, Observer
from thetascope.engine.observers.support.draft import NOW, Draft
from thetascope.engine.observers.support.draft_linalg import joseph, solve
from thetascope.engine.observers.support.excitation_checks import joint_observability, offer_linearisation
from thetascope.engine.observers.support.kalman_defaults import DELTA, GAMMA0, P0, Q_THETA, R_VARIANCE, WINDOW, Q
from thetascope.engine.observers.support.matrices import Matrix, block, diag, eye, zeros
from thetascope.messages import Message

GAINS = (Q, R_VARIANCE, Q_THETA, P0, GAMMA0, WINDOW, DELTA)


def write(d: Draft) -> None:
    """Write the equations of the filter."""
    n, p = d.n, d.p
    x, theta, P, Q = augmented(d)
    R = diag(d.gain("r"))
    x_minus, F_x, Phi = flow(d, "flow", x, theta)
    at = d.at(x_minus, theta, NOW)
    F = d.let("F", block([[F_x, Phi], [zeros(p, n), eye(p)]]))  # ∂z⁻/∂z
    H = d.let("H", block([[at.C, at.Psi]]))

    P_minus = d.let("P-", F @ P @ F.T + Q, symmetric=True)
    Sigma = d.let("Sigma", H @ P_minus @ H.T + R, symmetric=True)
    K = solve(d, "K", Sigma, H @ P_minus).T  # P⁻ Hᵀ Σ⁻¹
    innovation = d.let("innovation", d.measured(NOW) - at.h - at.Psi @ theta)
    correction = K @ innovation

    d.set(x, x_minus + correction[:n, :])
    d.set(theta, theta + correction[n:, :])
    d.set(P, joseph(d, "P+", P_minus, K, H, R))  # (I − KH) P⁻ (I − KH)ᵀ + K R Kᵀ
    report(d, x, theta, innovation, Sigma)


def augmented(d: Draft) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Declare x̂ (n×1), θ̂ (p×1) and their joint covariance P;
    return them with Q, which one sample interval adds to P."""
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    P = d.symmetric("P", d.n + d.p, initial=diag([*d.gain("p0"), *d.gain("gamma0")]))
    return x, theta, P, diag([*d.gain("q"), *[walk**2 for walk in d.gain("q_theta")]]) * d.period


def report(d: Draft, x: Matrix, theta: Matrix, innovation: Matrix, Sigma: Matrix) -> None:
    """Offer the estimates, ỹᵀ Σ⁻¹ ỹ of the last sample, and the Jacobians at the updated estimate."""
    nis = d.states("nis", 1)
    d.set(nis, innovation.T @ solve(d, "nis", Sigma, innovation))
    updated = d.at(x, theta)
    d.estimates(x, theta, updated.h + updated.Psi @ theta)
    offer_linearisation(d, updated.A, updated.C, updated.Phi, updated.Psi)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [
        joint_observability(run, run.context.period, "Jazwinski 1970, ch. 7"),
        positive_definite(run, "P", run.context.n + len(run.channels), "Jazwinski 1970, ch. 7"),
        consistency(run),
    ]


def consistency(run: Observed) -> Check:
    """Check that the innovations are as large as the filter expects: the mean of ỹᵀ Σ⁻¹ ỹ is the number of outputs."""
    name, source = Message("check.innovations"), "Bar-Shalom, Li & Kirubarajan 2001, §5.4"
    squared, m = run.values["nis.0.0"], run.context.m
    late = squared[len(squared) // 2 :]
    late = late[np.isfinite(late)]
    if not len(late):
        return Check(name, CANNOT_TELL, Message("check.no-innovation"), source=source)
    value = float(late.mean() / m)
    if value < 0.5:  # no error, but the filter is slower than it could be
        text = Message("check.innovations.small", outputs=m, value=value)
        return Check(name, CANNOT_TELL, text, value, 2.0, source)
    text = Message("check.innovations.mean", outputs=m, value=value)
    return Check(name, verdict(value <= 2.0), text, value, 2.0, source)


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``claimed.<channel>``: the root of the diagonal of P's θ block; ``nis``: ỹᵀΣ⁻¹ỹ of the last sample."""
    n = run.context.n
    sigma = {
        f"claimed.{c}": np.sqrt(np.maximum(run.values[f"P.{n + j}.{n + j}"], 0.0)) for j, c in enumerate(run.channels)
    }
    return {"nis": run.values["nis.0.0"], **sigma}


OBSERVER = Observer(
    id="joint-ekf",
    source="Jazwinski 1970; Ljung 1979, IEEE TAC 24(1), 36–50",
    gains=GAINS,
    options=(SUBSTEPS,),
    takes_events=True,
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    time="discrete",
    equations=(
        ("", "z = (x, θ)"),
        ("", "P⁻ = FPFᵀ + Q"),
        ("", "Σ = HP⁻Hᵀ + R"),
        ("", "K = P⁻HᵀΣ⁻¹"),
        ("", "ẑ⁺ = ẑ⁻ + Kỹ"),
        ("", "P⁺ = (I − KH)P⁻(I − KH)ᵀ + KRKᵀ"),
        ("", "F = {∂ẑ⁻ / ∂z}"),
        ("", "H = [C, Ψ]"),
    ),
    where=(
        ("θ", Message("symbol.theta-walk")),
        ("ỹ", Message("symbol.innovation")),
    ),
)
