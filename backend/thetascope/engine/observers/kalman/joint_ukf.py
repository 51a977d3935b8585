"""Joint unscented Kalman filter: Julier & Uhlmann 1997; scaled sigma points of Wan & van der Merwe 2000.

As the joint extended filter, z = (x, θ), but mean and covariance go through the model on 2N + 1 sigma points instead of
Jacobians. Noise is additive; the points are drawn anew from the predicted covariance, so that they include Q.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.observers.kalman.joint_ekf import GAINS, augmented, checks, diagnostics, report
from thetascope.engine.observers.kalman.rk4_map import SUBSTEPS, carried
from thetascope.engine.observers.support.declaration import Gain, Observer
from thetascope.engine.observers.support.draft import NOW, Draft
from thetascope.engine.observers.support.draft_linalg import cholesky, solve
from thetascope.engine.observers.support.matrices import Matrix, block, column, matrix, symmetric
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr

LARGEST = 24  # N = n + p: beyond it 2N + 1 copies of the model are too much to compile

SPREAD = (
    Gain("alpha", Message("gain.sigma-spread"), 1.0, 1e-4, 10.0, symbol="α"),
    Gain("beta", Message("gain.sigma-centre-weight"), 2.0, 0.0, 100.0, symbol="β"),
    Gain("kappa", Message("gain.sigma-extra-spread"), 0.0, -0.9, 100.0, symbol="κ"),
)


def write(d: Draft) -> None:
    """Write the equations of the filter. Raises SpecError for a plant with too many states and channels."""
    n, m, N = d.n, d.m, d.n + d.p
    if N > LARGEST:
        problem = Message("observer.joint-ukf.large", states=n, channels=d.p, copies=2 * N + 1, most=LARGEST)
        raise SpecError("observers.kind", N, problem)
    x, theta, P, Q = augmented(d)
    spread, mean, cov = weights(d, N)
    z = block([[x], [theta]])

    points = sigma_points(d, "draw", z, P, spread)
    moved = [block([[carried(d, f"flow{i}", s[:n, :], s[n:, :])], [s[n:, :]]]) for i, s in enumerate(points)]
    x_minus = d.let("z-", weighted(mean, moved)[:n, :])
    z_minus = block([[x_minus], [theta]])  # the points of θ do not move, so their mean is θ̂
    off = [d.let(f"off{i}", s - z_minus) for i, s in enumerate(moved)]
    P_minus = symmetric(N, lambda i, j: weighted_sum(cov, [o[i] * o[j] for o in off]))
    P_minus = d.let("P-", P_minus + Q, symmetric=True)

    points = sigma_points(d, "redraw", z_minus, P_minus, spread)
    eta = [output(d, f"y{i}", s) for i, s in enumerate(points)]
    y_hat = d.let("y_hat", weighted(mean, eta))
    off, away = [s - z_minus for s in points], [d.let(f"away{i}", s - y_hat) for i, s in enumerate(eta)]
    Pyy = symmetric(m, lambda i, j: weighted_sum(cov, [a[i] * a[j] for a in away]) + d.gain("r")[i] * int(i == j))
    Pyy = d.let("Pyy", Pyy, symmetric=True)
    Pzy = matrix(N, m, lambda i, j: weighted_sum(cov, [o[i] * a[j] for o, a in zip(off, away, strict=True)]))
    Pzy = d.let("Pzy", Pzy)
    K = solve(d, "K", Pyy, Pzy.T).T  # Pzy Pyy⁻¹
    innovation = d.let("innovation", d.measured(NOW) - y_hat)
    z_plus = z_minus + K @ innovation

    d.set(x, z_plus[:n, :])
    d.set(theta, z_plus[n:, :])
    d.set(P, P_minus - K @ Pzy.T)  # P⁻ − K Pyy Kᵀ
    report(d, x, theta, innovation, Pyy)


def weights(d: Draft, N: int) -> tuple[Expr, list[Expr], list[Expr]]:
    """Return N + λ = α²(N + κ), and the weights of the 2N + 1 points in means and in covariances."""
    alpha, beta, kappa = d.gain("alpha"), d.gain("beta"), d.gain("kappa")
    spread = cast("Expr", d.let("spread", alpha**2 * (N + kappa)))
    side, centre = cast("Expr", d.let("W", 1 / (2 * spread))), cast("Expr", d.let("W0", 1 - N / spread))
    return spread, [centre] + [side] * (2 * N), [d.let("W0c", centre + 1 - alpha**2 + beta)] + [side] * (2 * N)


def sigma_points(d: Draft, name: str, z: Matrix, P: Matrix, spread: Expr) -> list[Matrix]:
    """Return z and z ± the columns of √((N + λ) P), by Cholesky: 2N + 1 points (N×1)."""
    root = d.let(f"{name}.root", sympy.sqrt(spread))
    L = d.let(f"{name}.L", cholesky(d, name, P) * root)
    columns = [L[:, j] for j in range(L.shape[1])]
    return [
        z,
        *(d.let(f"{name}.p{j}", z + c) for j, c in enumerate(columns)),
        *(d.let(f"{name}.m{j}", z - c) for j, c in enumerate(columns)),
    ]


def weighted(weights: Sequence[Expr], columns: Sequence[Matrix]) -> Matrix:
    """Return Σ Wᵢ vᵢ of columns vᵢ."""
    return column([weighted_sum(weights, entries) for entries in zip(*columns, strict=True)])


def weighted_sum(weights: Sequence[Expr], values: Sequence[Expr]) -> Expr:
    """Return Σ Wᵢ vᵢ. All weights but the first are equal, so the sum of the other values is multiplied once."""
    return weights[0] * values[0] + weights[1] * sympy.Add(*values[1:])


def output(d: Draft, name: str, z: Matrix) -> Matrix:
    """Return h + Ψθ at a sigma point, at the instant of the sample (m×1)."""
    theta = z[d.n :, :]
    at = d.at(z[: d.n, :], theta, NOW)
    return d.let(name, at.h + at.Psi @ theta)


OBSERVER = Observer(
    id="joint-ukf",
    source="Julier & Uhlmann 1997; Wan & van der Merwe 2000",
    gains=(*GAINS, *SPREAD),
    options=(SUBSTEPS,),
    takes_events=True,
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    time="discrete",
    equations=(
        ("", "ẑ⁻ = ∑ᵢ Wᵢζᵢ"),
        ("", "P⁻ = ∑ᵢ Wᵢ(ζᵢ − ẑ⁻)(ζᵢ − ẑ⁻)ᵀ + Q"),
        ("", "P_{zy} = ∑ᵢ Wᵢ(ζᵢ − ẑ⁻)(ηᵢ − ŷ)ᵀ"),
        ("", "K = P_{zy}P_{yy}⁻¹"),
        ("", "ẑ⁺ = ẑ⁻ + K(y − ŷ)"),
        ("", "P⁺ = P⁻ − KP_{yy}Kᵀ"),
    ),
    where=(
        ("ζᵢ", Message("symbol.sigma-points")),
        ("Wᵢ", Message("symbol.sigma-weights")),
    ),
)
