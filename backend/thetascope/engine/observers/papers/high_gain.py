"""High-gain observer: Zhao, Li & Li 2012, eqs. (6)–(9), in the user's own coordinates (see observable_form.py).

    x̂' = f(x̂, u) + J⁻¹ Δ k0 (y − h(x̂)),   J = ∂T/∂x,   Δ = diag(ρ, …, ρⁿ)

It does not estimate faults: its error shows their effect on a plain observer.
"""

from __future__ import annotations

import math

import numpy as np

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.result import Check
from thetascope.engine.observers.forms.observable_form import CanonicalForm, canonical_form
from thetascope.engine.observers.support.common_checks import gain_at_least, stable, verdict
from thetascope.engine.observers.support.declaration import Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import RATE
from thetascope.engine.observers.support.draft import Draft, ModelAt
from thetascope.engine.observers.support.draft_linalg import solve
from thetascope.engine.observers.support.kalman_defaults import pace
from thetascope.engine.observers.support.matrices import Matrix, column, diag, matrix
from thetascope.messages import Message

FAST = 50.0  # times the plant's slowest rate: ρ = 4 for the paper's plant, as in the paper

RHO = Gain("rho", Message("gain.high-gain"), lambda c: FAST * pace(c), positive=True, symbol="ρ", unit=RATE)


def k0(n: int) -> Matrix:
    """Return k0 = ½ S⁻¹ c0ᵀ (8), half the binomial coefficients C(n, i); S solves A0ᵀS + S A0 + S = c0ᵀc0 (7) (n×1)."""
    return column([sympy.Rational(math.comb(n, i), 2) for i in range(1, n + 1)])


def S(n: int) -> Matrix:
    """Return the solution of (7), S_ij = (−1)^(i+j) C(i+j−2, j−1) for i, j = 1…n (n×n)."""
    return matrix(n, n, lambda i, j: (-1) ** (i + j) * math.comb(i + j, j))


def A0(n: int) -> Matrix:
    """Return the shift matrix of (4) (n×n)."""
    return matrix(n, n, lambda i, j: int(j == i + 1))


def c0(n: int) -> Matrix:
    """Return the first unit row (1×n)."""
    return matrix(1, n, lambda i, j: int(j == 0))


def Delta(d: Draft) -> Matrix:
    """Return diag(ρ, …, ρⁿ)."""
    return diag([d.gain("rho") ** i for i in range(1, d.n + 1)])


def to_user(d: Draft, at: ModelAt, form: CanonicalForm, correction: Matrix) -> Matrix:
    """Return J⁻¹ · correction (n×1): a correction in canonical coordinates, turned into the user's coordinates."""
    if form.identity:
        return correction
    return solve(d, "J", d.let("dT", at.matrix(form.J)), correction)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant without a canonical form."""
    form = canonical_form(d.model)
    x = d.estimate_of_state()
    at = d.at(x)
    y_hat = d.let("y_hat", at.h)
    r = d.let("r", (d.measured() - y_hat)[0])
    d.set(x, at.f + to_user(d, at, form, Delta(d) @ k0(d.n) * r))  # (9)
    d.estimates(x, None, y_hat)
    describe(d, form)


def describe(d: Draft, form: CanonicalForm) -> None:
    """Facts about the canonical form, for the report."""
    d.facts["canonical"] = form.identity
    d.facts["coordinates"] = [str(e) for e in form.T]
    d.facts["triangular"] = form.triangular
    d.facts["affine"] = all(d.model.is_affine)


def form_checks(run: Observed) -> list[Check]:
    """Check the conditions of Theorems 1 and 2 on the plant and on k0."""
    n, facts, source = run.context.n, run.facts, "Zhao, Li & Li 2012"
    form = "check.canonical-form.has" if facts["canonical"] else "check.canonical-form.reached"
    triangular = (
        "check.uniform-observability.triangular" if facts["triangular"] else "check.uniform-observability.hidden"
    )
    lipschitz = "check.f-lipschitz.affine" if facts["affine"] else "check.f-lipschitz.saturated"
    matrix = np.eye(n, k=1)  # A0 − k0 c0 in numbers, because a run from the cache needs no SymPy
    matrix[:, 0] -= [math.comb(n, i) / 2 for i in range(1, n + 1)]
    form_text = Message(form, coordinates=facts["coordinates"])
    affine = verdict(True if facts["affine"] else None)
    return [
        Check(Message("check.canonical-form"), verdict(True), form_text, source=f"{source}, eq. (2)"),
        Check(
            Message("check.uniform-observability"),
            verdict(facts["triangular"]),
            Message(triangular),
            source=f"{source}, eq. (5)",
        ),
        stable("A0 − k0 c0", matrix, f"{source}, eq. (8)"),
        Check(Message("check.f-lipschitz"), affine, Message(lipschitz), source=f"{source}, Theorem 1"),
        gain_at_least(run, "rho", "ρ", pace(run.context), f"{source}, Lemma 1", Message("check.gain.rho")),
    ]


OBSERVER = Observer(
    id="high-gain",
    source="Zhao, Li & Li 2012, eq. (9); Gauthier, Hammouri & Othman 1992",
    gains=(RHO,),
    write=write,
    checks=form_checks,
    estimates_theta=False,
    equations=(
        ("(9)", "ẋ̂ = f(x̂, u) + J⁻¹Δk₀(y − ŷ)"),
        ("", "ŷ = h(x̂)"),
        ("(8)", "k₀ = {1 / 2}S⁻¹c₀ᵀ"),
        ("(7)", "A₀ᵀS + SA₀ + S = c₀ᵀc₀"),
        ("", "Δ = diag(ρ, ρ², …, ρⁿ)"),
    ),
    where=(
        ("J", Message("symbol.jacobian-canonical")),
        ("ρ", Message("symbol.high-gain")),
    ),
)
