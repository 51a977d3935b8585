"""Extended state observer: every fault is one more state, and one bandwidth ω places all eigenvalues.

    x̂' = f(x̂, u) + Φθ̂ + K(ω) r,   θ̂' = K_θ(ω) r,   r = y − h(x̂) − Ψθ̂

Han, IEEE TIE 56(3), 2009; Gao, ACC 2003, for the one bandwidth; Li, Yang, Chen & Chen, IEEE TIE 59(12), 2012, for
disturbances that enter anywhere. Han's total disturbance is what a channel carries: θ̂ also contains all that the model
does not say about the equations which that channel enters.

The gains are those of the linearisation along the healthy run: of the augmented plant Aₑ = (A, Φ; 0, 0), Cₑ = (C, Ψ).
With a chain of ρᵢ rows Cₑ,ᵢ, Cₑ,ᵢAₑ, … for every output i, n + p rows O in all,

    (K; K_θ) = [(Aₑ + ωI)^ρ₁ w₁, …, (Aₑ + ωI)^ρₘ wₘ] M⁻¹,   O wᵢ = (the unit vector of the last row of chain i)

where M has the entries Cₑ,ⱼ Aₑ^(ρᵢ−1) wᵢ: Luenberger's canonical form, IEEE TAC 12(3), 1967, transposed. Then all
n + p eigenvalues of Aₑ − (K; K_θ)Cₑ are −ω. The gains are polynomials in ω whose coefficients are computed once; for a
chain of integrators they are Gao's, the coefficients of (s + ω)^(n+1).
"""

from __future__ import annotations

from functools import reduce
from math import comb

import numpy as np

from thetascope.engine.model.result import Check
from thetascope.engine.observers.classical.design import Point, bandwidth, chosen, in_units, requested
from thetascope.engine.observers.classical.frozen_checks import distinct_at_rest, error_dynamics, time_scales
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import RATE
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import offer_linearisation
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, state_scales, typical_sizes
from thetascope.messages import Message

FAST = 5.0  # bandwidth, times the rate at which a run lets a fault be learned
SOURCE = "Gao 2003"
_ADDS = 0.02  # part of a row, relative to its length, outside the span of the rows before it, from which it is kept


def chains(point: Point) -> list[tuple[int, int]] | None:
    """Return the rows of O as (output, derivative), chain by chain; None where they do not determine state and faults.

    Rows Cₑ, CₑAₑ, … are taken in turn and kept where they are distinct from those before them.
    """
    A, C = point.joint
    basis: list[np.ndarray] = []
    lengths, rows = [0] * len(C), C.copy()
    for k in range(len(A)):
        for i in (i for i in range(len(C)) if lengths[i] == k):  # a chain ends at the first row that adds nothing
            size = np.linalg.norm(rows[i])
            rest = rows[i] / size if size > 0 else rows[i]
            for _ in range(2):
                rest = reduce(lambda left, known: left - (left @ known) * known, basis, rest)
            if len(basis) < len(A) and (apart := float(np.linalg.norm(rest))) > _ADDS:
                basis.append(rest / apart)
                lengths[i] += 1
        rows = rows @ A
    return [(i, k) for i in range(len(C)) for k in range(lengths[i])] if len(basis) == len(A) else None


def fits(point: Point) -> bool:
    """Return whether the outputs and their derivatives determine state and faults."""
    return chains(point) is not None


def polynomials(point: Point) -> np.ndarray:
    """Return the coefficients of (K; K_θ) in powers of ω, scaled (n+p+1, n+p, m)."""
    places = chains(point)
    assert places is not None, "only channels that fit are designed for"
    A, C = point.joint
    size, m = len(A), len(C)
    rows = [C]
    for _ in range(size):
        rows.append(rows[-1] @ A)
    observed = np.array([rows[k][i] for i, k in places])
    ends = [a for a, (i, k) in enumerate(places) if (i, k + 1) not in places]
    used, lengths = [places[a][0] for a in ends], [places[a][1] + 1 for a in ends]
    W = np.linalg.inv(observed)[:, ends]
    M = np.array([[rows[rho - 1][j] @ W[:, i] for i, rho in enumerate(lengths)] for j in used])
    powers = np.zeros((size + 1, size, len(ends)))
    for i, rho in enumerate(lengths):
        w = W[:, i]
        for k in range(rho, -1, -1):  # comb(ρ, k) ω^k Aₑ^(ρ−k) wᵢ
            powers[k, :, i] = comb(rho, k) * w
            w = A @ w
    placed = np.zeros((size + 1, size, m))
    placed[:, :, used] = powers @ np.linalg.inv(M)
    return placed


def constants(c: Context) -> dict[str, np.ndarray]:
    """Return the coefficients of (K; K_θ) in the plant's units. Raises SpecError for faults that are not distinct."""
    found, rate = polynomials(requested(c, fits)), pace(c)
    rows = (*state_scales(c), *typical_sizes(c))
    return {f"E{k}": np.array(in_units(L, rows, output_scales(c), rate ** (1 - k))) for k, L in enumerate(found)}


OMEGA = Gain(
    "omega",
    Message("gain.observer-bandwidth"),
    lambda c: bandwidth(c, FAST) * pace(c),
    positive=True,
    symbol="ω",
    unit=RATE,
)


def write(d: Draft) -> None:
    """Write the equations of the observer."""
    x, theta, omega, size = d.estimate_of_state(), d.estimate_of_theta(), d.gain("omega"), d.n + d.p
    at = d.at(x, theta)
    y_hat = d.let("y_hat", at.h + at.Psi @ theta)
    r = d.let("r", d.measured() - y_hat)
    K = d.constant(f"E{size}", size, d.m)
    for k in reversed(range(size)):  # Horner's scheme: E0 + E1 ω + E2 ω² + …
        K = d.let(f"K{k}", K * omega + d.constant(f"E{k}", size, d.m))
    correction = K @ r

    d.set(x, at.f + at.Phi @ theta + correction[: d.n, :])
    d.set(theta, correction[d.n :, :])
    d.estimates(x, theta, y_hat)
    d.outputs("K", K)
    offer_linearisation(d, at.A, at.C, at.Phi, at.Psi)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    K = run.matrix("K", run.context.n + len(run.channels), run.context.m)[-1]
    return [
        distinct_at_rest(run, SOURCE),
        error_dynamics(run, K[: run.context.n], K[run.context.n :], SOURCE),
        time_scales(run, SOURCE),
    ]


OBSERVER = Observer(
    id="extended-state",
    source="Han 2009, IEEE TIE 56(3), 900–906; Gao 2003, ACC, 4989–4996; Li, Yang, Chen & Chen 2012, IEEE TIE 59(12)",
    gains=(OMEGA,),
    write=write,
    checks=checks,
    chooses=lambda c: chosen(c, fits),
    constants=constants,
    equations=(
        ("", "ẋ̂ = f(x̂, u) + Φθ̂ + K(y − ŷ)"),
        ("", "θ̇̂ = Kᵢ(y − ŷ)"),
        ("", "ŷ = h(x̂) + Ψθ̂"),
        ("", "det(sI − Aₑ + KₑCₑ) = (s + ω)^{n + p}"),
        ("", "Kₑ = (K, Kᵢ)"),
    ),
    where=(
        ("Aₑ", Message("symbol.augmented-plant")),
        ("ω", Message("symbol.observer-bandwidth")),
    ),
)
