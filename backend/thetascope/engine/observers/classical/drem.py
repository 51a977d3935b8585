"""Adaptive observer with dynamic regressor extension and mixing (DREM): one scalar regression for every fault.

    x̂₀' = f(x̂, u) − AΥθ̂ + K r₀,   r₀ = y − h(x̂) + CΥθ̂,   x̂ = x̂₀ + Υθ̂
    Υ' = (A − KC)Υ + Φ − KΨ,   Ω = CΥ + Ψ,   P' = AP + PAᵀ + Q − PCᵀR⁻¹CP,   K = PCᵀR⁻¹
    M' = −ℓM + ΩᵀR⁻¹Ω,   Y' = −ℓY + ΩᵀR⁻¹r₀
    θ̂ᵢ' = γᵢ Δ(𝒴ᵢ − Δθ̂ᵢ)/(1 + Δ²),   Δ = det(M)/μ,   𝒴 = adj(M) Y/μ,   μ = (1 + tr(M)/p)^(p−1)

Aranovskiy, Bobtsov, Ortega & Pyrkin, IEEE TAC 62(7), 2017; the extension by M is Kreisselmeier's, IEEE TAC 22(1), 1977,
as in Ortega, Aranovskiy, Pyrkin, Astolfi & Bobtsov, IEEE TAC 66(5), 2021. x̂₀ is a Kalman–Bucy filter that knows no
faults, linearised about x̂, so r₀ = Ωθ but for a decaying term, and Y = Mθ. Multiplied by adj(M) this is 𝒴ᵢ = Δθᵢ, one
equation for each fault: while θ is constant |θ̂ᵢ − θᵢ| never grows, whatever the estimates of the other faults do.

M is counted in typical faults. Divided by μ > 0, which leaves every equation as it is, Δ is of the size of the smallest
eigenvalue of M: 1 where, within 1/ℓ, the least visible combination of typical faults changes the outputs by as much as
the noise. At much less θ̂ hardly moves instead of following noise, at much more it converges at the rate γ.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import chosen
from thetascope.engine.observers.classical.proportional_integral import fits
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, positive_definite, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import RATE
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import closed_loop, observability, offer_linearisation
from thetascope.engine.observers.support.kalman_defaults import (
    P0_QUIET,
    R_INTENSITY,
    Q,
    learning_rate,
    state_scales,
    typical_sizes,
)
from thetascope.engine.observers.support.matrices import Matrix, column, diag, matrix
from thetascope.messages import Message

MOST = 5  # faults: the determinants of more become long, and tiny
SOURCE = "Aranovskiy et al. 2017"


def chooses(c: Context) -> tuple[str, ...]:
    """Return all channels of a plant with up to four, else those that are distinct at rest."""
    names = tuple(channel["name"] for channel in c.model.get("channels", ()))
    return names if len(names) < MOST else chosen(c, fits)


ELL = Gain("ell", Message("gain.extension-rate"), learning_rate, positive=True, symbol="ℓ", unit=RATE)
GAMMA = Gain(
    "gamma",
    Message("gain.drem-rate"),
    lambda c: [4.0 * learning_rate(c)] * c.p,
    positive=True,
    size="p",
    symbol="γ",
    unit=RATE,
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for more than five faults."""
    if d.p > MOST:
        raise SpecError("observers.kind", d.model.id, Message("observer.drem.many", channels=d.p, most=MOST))
    n, p, ell = d.n, d.p, d.gain("ell")
    Q, R_inv, typical = diag(d.gain("q")), diag([1 / r for r in d.gain("r")]), diag(d.constant("typical", p, 1))
    plain, theta = d.states("via.x", n, initial=d.x0), d.estimate_of_theta()
    P, Upsilon = d.symmetric("P", n, initial=diag(d.gain("p0"))), d.states("Upsilon", n, p)
    M, Y = d.symmetric("M", p, initial=diag([0] * p)), d.states("via.Y", p)
    x = d.let("x", plain + Upsilon @ theta)
    at = d.at(x, theta)
    A, C, Phi, Psi = d.let("A", at.A), d.let("C", at.C), d.let("Phi", at.Phi), d.let("Psi", at.Psi)
    K, Omega = d.let("K", P @ C.T @ R_inv), d.let("Omega", C @ Upsilon + Psi)
    y_hat = d.let("y_hat", at.h + Psi @ theta)
    r0 = d.let("r0", d.measured() - y_hat + Omega @ theta)
    scaled = d.let("scaled", Omega @ typical)

    d.set(plain, at.f - A @ Upsilon @ theta + K @ r0)
    d.set(P, A @ P + P @ A.T + Q - K @ C @ P)
    d.set(Upsilon, A @ Upsilon + Phi - K @ Omega)
    d.set(M, scaled.T @ R_inv @ scaled - M * ell)
    d.set(Y, scaled.T @ R_inv @ r0 - Y * ell)
    determinant, adjugate = mixed(d, M)
    mu = d.let("mu", (1 + sympy.Add(*(M[i, i] for i in range(p))) / max(p, 1)) ** max(p - 1, 0))
    Delta = d.let("Delta", determinant / mu)
    d.set(theta, learned(d, Delta, d.let("mixed", adjugate @ Y) / mu, theta))
    d.estimates(x, theta, y_hat)
    d.output("Delta", Delta)
    offer_linearisation(d, A, C, Phi, Psi)


def learned(d: Draft, Delta: sympy.Expr, regressed: Matrix, theta: Matrix) -> Matrix:
    """Return the rates of θ̂: one scalar regression for each fault."""
    rate, typical = d.let("rate", Delta / (1 + Delta**2)), d.constant("typical", d.p, 1)
    parts = zip(d.gain("gamma"), typical, regressed, theta, strict=True)
    return column([gamma * rate * (size * one - Delta * estimate) for gamma, size, one, estimate in parts])


def mixed(d: Draft, M: Matrix) -> tuple[sympy.Expr, Matrix]:
    """Return det M and adj M (p×p) for symmetric M, every minor written once."""
    size, known = M.shape[0], {}

    def minor(rows: tuple[int, ...], columns: tuple[int, ...]) -> sympy.Expr:
        if not rows:
            return sympy.S.One
        key = min((rows, columns), (columns, rows))  # M is symmetric
        if key not in known:
            rows, columns = key
            terms = [
                (-1) ** k * M[rows[0], c] * minor(rows[1:], columns[:k] + columns[k + 1 :])
                for k, c in enumerate(columns)
            ]
            name = "-".join("".join(map(str, part)) for part in key)
            known[key] = d.let(f"minor.{name}", sympy.Add(*terms))
        return known[key]

    whole = tuple(range(size))

    def cofactor(i: int, j: int) -> sympy.Expr:
        return (-1) ** (i + j) * minor(whole[:j] + whole[j + 1 :], whole[:i] + whole[i + 1 :])

    return minor(whole, whole), matrix(size, size, cofactor)


def constants(c: Context) -> dict[str, np.ndarray]:
    """Return the typical faults (p×1)."""
    return {"typical": np.reshape(typical_sizes(c), (-1, 1))}


def carried(c: Context) -> list[tuple[float, float]]:
    """Return the scales of x̂₀ and of Y, and the deviations of their first values."""
    return [*((s, s) for s in state_scales(c)), *((1.0, 0.0) for _ in range(c.p))]


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [
        observability(run, "Kalman & Bucy 1961"),
        closed_loop(run, SOURCE),
        positive_definite(run, "P", run.context.n, "Kalman & Bucy 1961"),
        regressor(run),
    ]


def regressor(run: Observed) -> Check:
    """Check that Δ is not square integrable, by its size: the share of rows with |Δ| ≥ 1 after the first tenth."""
    name, values = Message("check.regressor"), np.abs(run.values["Delta"])
    late = values[len(values) // 10 :]
    late = late[np.isfinite(late)]
    if not len(late):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=SOURCE)
    share, median = float(np.mean(late >= 1.0)), float(np.median(late))
    holds = True if share >= 0.5 else (None if share > 0.05 else False)
    return Check(
        name, verdict(holds), Message("check.regressor.share", share=100 * share, median=median), share, 0.5, SOURCE
    )


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``pe``: Δ, in typical faults."""
    return {"pe": run.values["Delta"]}


OBSERVER = Observer(
    id="drem",
    source="Aranovskiy, Bobtsov, Ortega & Pyrkin 2017, IEEE TAC 62(7), 3546–3550; Ortega et al. 2021, IEEE TAC 66(5)",
    gains=(Q, R_INTENSITY, P0_QUIET, ELL, GAMMA),
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    chooses=chooses,
    constants=constants,
    carried=carried,
    equations=(
        ("", "ẋ̂₀ = f(x̂, u) − AΥθ̂ + Kr₀"),
        ("", "x̂ = x̂₀ + Υθ̂"),
        ("", "r₀ = y − h(x̂) + CΥθ̂"),
        ("", "Υ̇ = (A − KC)Υ + Φ − KΨ"),
        ("", "Ω = CΥ + Ψ"),
        ("", "K = PCᵀR⁻¹"),
        ("", "Ṗ = AP + PAᵀ + Q − PCᵀR⁻¹CP"),
        ("", "Ṁ = −ℓM + ΩᵀR⁻¹Ω"),
        ("", "Ẏ = −ℓY + ΩᵀR⁻¹r₀"),
        ("", "θ̇̂ᵢ = γᵢ{Δ / 1 + Δ²}({1 / μ}adj(M)Y − Δθ̂)ᵢ"),
        ("", "Δ = {1 / μ}det M"),
        ("", "μ = (1 + {1 / p}tr M)^{p − 1}"),
    ),
    where=(
        ("P", Message("symbol.riccati")),
        ("Υ", Message("symbol.upsilon")),
        ("M", Message("symbol.extended-regressor")),
        ("Δ", Message("symbol.mixed-regressor")),
    ),
)
