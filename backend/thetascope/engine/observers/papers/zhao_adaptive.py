"""Adaptive observer for actuator and sensor faults: Zhao, Li & Li 2012, eq. (34).

The paper uses one letter for the high gain ρ and the forgetting factor of Γ; here they are ρ and λ. In (34d) the
print has Ψθ̃ where Ψθ̂ is meant. f is extended outside the physical domain by saturating the model (Draft.at): as
printed it is not globally Lipschitz and x̂(0) = 0 divides zero by zero. In other than canonical coordinates, Φ becomes
J Φ and the correction J⁻¹ Δ[…]: the chain rule, no approximation (observable_form.py).
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import Check
from thetascope.engine.observers.forms.observable_form import canonical_form
from thetascope.engine.observers.papers import high_gain, zhao_proof
from thetascope.engine.observers.papers.high_gain import A0, FAST, RHO, c0, describe, form_checks, k0, to_user
from thetascope.engine.observers.support.common_checks import (
    eigenvalues,
    persistent_excitation,
    positive_definite,
    windowed_gramian,
)
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import (
    FAULT_PER_OUTPUT_SQUARED_SECOND,
    OUTPUT_PER_FAULT_SQUARED_SECONDS,
    RATE,
    SECONDS,
)
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, typical_sizes
from thetascope.engine.observers.support.matrices import diag
from thetascope.messages import Message

_WINDOW = 0.16  # time constants of the plant: 2 s for the paper's
_GAMMA0 = 600.0
_DELTA = 6e-5


def default_gamma0(c: Context) -> list[float]:
    """Return γ0 of each channel in the units of Γ, about the paper's 1 for its plant."""
    y = output_scales(c)[0]
    return [_GAMMA0 * pace(c) * size**2 / y**2 for size in typical_sizes(c)]


def default_delta(c: Context) -> float:
    """Return δ in the units of ∫ΩᵀΩ dt, about the paper's 0.002 for its plant."""
    largest = max(typical_sizes(c), default=1.0)
    return _DELTA * (_WINDOW / pace(c)) * output_scales(c)[0] ** 2 / largest**2


GAINS = (
    RHO,
    Gain(
        "lambda",
        Message("gain.forgetting-factor"),
        lambda c: FAST * pace(c),
        symbol="λ",
        unit=RATE,
    ),
    Gain(
        "gamma0",
        Message("gain.initial-gamma-scale"),
        default_gamma0,
        positive=True,
        size="p",
        symbol="Γ(0)",
        unit=FAULT_PER_OUTPUT_SQUARED_SECOND,
        live=False,
    ),
    Gain(
        "window",
        Message("gain.excitation-window-36"),
        lambda c: _WINDOW / pace(c),
        positive=True,
        symbol="T",
        unit=SECONDS,
        live=False,
    ),
    Gain(
        "delta",
        Message("gain.excitation-level-36"),
        default_delta,
        symbol="δ",
        unit=OUTPUT_PER_FAULT_SQUARED_SECONDS,
        live=False,
    ),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant without a canonical form."""
    form = canonical_form(d.model)
    n, p, rho, lam = d.n, d.p, d.gain("rho"), d.gain("lambda")
    Upsilon = d.states("Upsilon", n, p)
    Gamma = d.symmetric("Gamma", p, initial=diag(d.gain("gamma0")))
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    at = d.at(x, theta)
    Psi, Delta = at.Psi, high_gain.Delta(d)
    Phi = at.Phi if form.identity else d.let("JPhi", at.matrix(form.J) @ at.Phi)

    Omega = d.let("Omega", c0(n) @ Upsilon + Psi)  # (35)
    GammaOmega = d.let("GammaOmega", Gamma @ Omega.T)
    y_hat = d.let("y_hat", at.h + Psi @ theta)  # (27)
    r = d.let("r", (d.measured() - y_hat)[0])

    dUpsilon = rho * (A0(n) - k0(n) @ c0(n)) @ Upsilon + rho * Delta.inv() @ Phi - rho * k0(n) @ Psi  # (34a)
    dGamma = lam * Gamma - Gamma @ Omega.T @ Omega @ Gamma  # (34b)
    gain = d.let("gain", Delta @ (k0(n) + Upsilon @ GammaOmega / rho))
    dx = at.f + at.Phi @ theta + to_user(d, at, form, gain * r)  # (34c)
    dtheta = Gamma @ Omega.T * r  # (34d)

    d.set(Upsilon, dUpsilon)
    d.set(Gamma, dGamma)
    d.set(x, dx)
    d.set(theta, dtheta)
    d.estimates(x, theta, y_hat)
    d.outputs("Omega", Omega)
    d.outputs("F", at.f if form.identity else at.matrix(form.J) @ at.f)  # for the constants of Theorem 2
    if not form.identity:
        d.outputs("T", at.matrix(form.T))
    describe(d, form)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    source = "Zhao, Li & Li 2012"
    level = run.values["pe"]
    return [
        *form_checks(run),
        persistent_excitation(run, level, f"{source}, eq. (36)"),
        positive_definite(run, "Gamma", len(run.channels), f"{source}, Lemma 2"),
        zhao_proof.constants(run),
        zhao_proof.falls(run),
    ]


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """Eigenvalues of the windowed Gramian of Ω (36), the paper's Fig. 5, and the Lyapunov function of Theorem 2.

    ``pe`` is the smallest eigenvalue, ``gramian.1`` … ``gramian.p`` are all, ascending; V, V1 and V2 need the truth.
    """
    gramian = windowed_gramian(run.matrix("Omega", run.context.m, len(run.channels)), run)
    values = eigenvalues(gramian, run)
    if not len(run.channels):
        return {"pe": np.full(len(values), np.nan)}
    columns = {f"gramian.{k + 1}": values[:, k].copy() for k in range(values.shape[1])}
    return {"pe": columns["gramian.1"]} | columns | zhao_proof.lyapunov(run)


OBSERVER = Observer(
    id="zhao-adaptive",
    source="Zhao, Li & Li 2012, eq. (34)",
    gains=GAINS,
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    equations=(
        ("(34a)", "Υ̇ = ρ(A₀ − k₀c₀)Υ + ρΔ⁻¹Φ − ρk₀Ψ"),
        ("(34b)", "Γ̇ = λΓ − ΓΩᵀΩΓ"),
        ("(34c)", "ẋ̂ = f(x̂, u) + Φθ̂ + Δ[k₀ + {1 / ρ}ΥΓΩᵀ](y − ŷ)"),
        ("(34d)", "θ̇̂ = ΓΩᵀ(y − ŷ)"),
        ("(35)", "Ω = c₀Υ + Ψ"),
        ("(27)", "ŷ = h(x̂) + Ψθ̂"),
    ),
    where=(
        ("Υ", Message("symbol.upsilon")),
        ("Γ", Message("symbol.gamma-gain")),
        ("Ω", Message("symbol.omega")),
        ("Δ", Message("symbol.delta-powers")),
    ),
)
