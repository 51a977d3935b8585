"""The matching condition of Shen & Hu 2015, eq. (8): P Φ(x, u) = Cᵀ gᵀ(x, u) with one constant P > 0.

C is the first state, so rows 2…n of P annihilate Φ: every column of Φ points along the one vector P⁻¹Cᵀ. Scaled to
d1 = 1 this is the direction d, and Φ = d·(CΦ). Then g = (CΦ)ᵀ, for P scaled to P d = Cᵀ; any other scale of P scales
g and is the same as another λ in (12).

In the coordinates ξ = (x1, x2 − d2 x1, …, xn − dn x1) such a P is diag(1, P2) with any P2 > 0, and the Lyapunov
inequality (A − KC)ᵀP + P(A − KC) < 0 is a Riccati inequality for P2, solved through its Hamiltonian matrix.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg

from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms.sizes import cancels
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr

_SHARES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97)  # of the largest c


def shift(n: int) -> np.ndarray:
    """Return A of (1), the chain of integrators."""
    return np.eye(n, k=1)


def closed(K: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return A − KC, with C the first state (n×n)."""
    matrix = shift(len(K))
    matrix[:, 0] -= K
    return matrix


def direction(model: Model, channels: Sequence[str]) -> tuple[list[Expr] | None, Message | None]:
    """Return the direction d with Φ = d·(CΦ), with entries free of x, u, signals and t; or None and the reason.

    Raises SpecError if a column of CΦ is zero: then g is zero there and (12) never changes its θ̂.
    """
    Phi = model.Phi(channels).xreplace(model.expansion)
    for j, channel in enumerate(channels):
        if Phi[0, j] == 0:
            problem = Message("observer.matching.not-measured", state=model.states[0])
            raise SpecError("options.channels", channel, problem)
    d = [_ratio(Phi[i, 0], Phi[0, 0]) for i in range(model.n)]
    moving = set().union(*(e.free_symbols for e in d)) - set(model.parameters)
    if moving:
        names = sorted(s.name for s in moving)
        return None, Message("observer.matching.moving", channel=channels[0], names=names)
    for j, channel in enumerate(channels):
        if any(_ratio(Phi[i, j] - d[i] * Phi[0, j], Phi[0, j]) != 0 for i in range(1, model.n)):
            return None, Message("observer.matching.different", first=channels[0], second=channel)
    return d, None


def _ratio(a: Expr, b: Expr) -> Expr:
    if a == 0 or a == b:
        return sympy.S.Zero if a == 0 else sympy.S.One
    ratio = sympy.cancel(a / b) if cancels(a / b) else a / b
    short = ratio.count_ops() < 60 and cancels(ratio)
    return sympy.simplify(ratio) if short else ratio  # simplify is slow on long expressions


def find_P(K: Sequence[float] | np.ndarray, d: Sequence[float] | np.ndarray) -> np.ndarray | None:
    """Return P > 0 with P d = Cᵀ and (A − KC)ᵀP + P(A − KC) < 0 (n×n; d1 = 1), or None if it does not exist.

    It exists exactly if C(sI − A + KC)⁻¹d is strictly positive real (Kalman, Yakubovich and Popov).
    """
    n, K, d = len(K), np.asarray(K, dtype=float), np.asarray(d, dtype=float)
    if not (np.isfinite(K).all() and np.isfinite(d).all() and K[-1] > 0):
        return None  # K[-1] is the product of the poles
    mean = K[-1] ** (1 / n)  # of the poles: time is measured in its inverse, and state i in mean^(i − 1)
    powers = mean ** np.arange(n)
    P = _scaled_P(K / (powers * mean), d / powers)
    return None if P is None else P / np.outer(powers, powers)


def matched_gains(wished: Sequence[float] | np.ndarray, d: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return K (n,) for which P exists, as near to the wished K as a margin allows; the wished K where it has a P.

    With N and D the polynomials of d and of A − KC, P exists where Re N(jω) D(−jω) > 0 for all ω. That is linear in
    D, and holds for D = (s + a) N if the zeros of N are stable. So D is taken on the line from there to the wished one,
    halfway to the border. If a zero is not stable no K has a P, and the wished K is returned.
    """
    wished, d = np.asarray(wished, dtype=float), np.asarray(d, dtype=float)
    if find_P(wished, d) is not None or (np.roots(d).real >= 0).any():
        return wished
    pole = max(wished[0] - d[1:2].sum(), wished[0] / len(wished))  # the sum of all poles stays where it can
    near = np.polymul([1.0, pole], d)[1:]
    good, bad = 0.0, 1.0
    for _ in range(30):
        share = (good + bad) / 2
        good, bad = (share, bad) if find_P(near + share * (wished - near), d) is not None else (good, share)
    return near + good / 2 * (wished - near)


def matched_Ps(K: Sequence[float] | np.ndarray, d: Sequence[float] | np.ndarray) -> list[np.ndarray]:
    """Return P as of `find_P` with (A − KC)ᵀP + P(A − KC) < −c P, for some c from 0 to the largest that may have one.

    The P with the largest c has the largest condition number, too: which of them is best depends on its use.
    """
    return list(_matched_Ps(tuple(map(float, K)), tuple(map(float, d))))


def fastest_rate(d: Sequence[float] | np.ndarray) -> float:
    """Return the c that no K and no P with P d = Cᵀ reach: twice the rate of the slowest zero of d."""
    zeros = np.roots(np.asarray(d, dtype=float))
    return float(max(-2 * zeros.real.max(), 0.0)) if len(zeros) else float("inf")


@lru_cache(maxsize=64)
def _matched_Ps(K: tuple[float, ...], d: tuple[float, ...]) -> tuple[np.ndarray, ...]:
    n, gains, plain = len(K), np.array(K), find_P(K, d)
    if plain is None:
        return ()
    mean = K[-1] ** (1 / n)
    powers = mean ** np.arange(n)
    largest = min(fastest_rate(d), -2 * float(np.linalg.eigvals(closed(gains)).real.max())) / mean
    scaled = (_scaled_P(gains / (powers * mean), np.array(d) / powers, largest * share) for share in _SHARES)
    return plain, *(P / np.outer(powers, powers) for P in scaled if P is not None)


def _scaled_P(K: np.ndarray, d: np.ndarray, rate: float = 0.0) -> np.ndarray | None:
    """Return P where the poles are about 1, with (A − KC)ᵀP + P(A − KC) < −rate P."""
    n = len(K)
    T = np.eye(n)
    T[1:, 0] = d[1:]
    inverse = 2 * np.eye(n) - T
    moved = inverse @ closed(K) @ T + rate / 2 * np.eye(n)  # A − KC in the coordinates ξ
    if not np.isfinite(moved).all() or moved[0, 0] >= 0:
        return None
    for P2 in _riccati(moved):
        P = inverse.T @ np.asarray(scipy.linalg.block_diag(1.0, P2)) @ inverse if n > 1 else np.eye(1)
        if np.linalg.eigvalsh(P)[0] > 0 and lyapunov_margin(P, K, rate) < 0:
            return P
    return None


def _riccati(moved: np.ndarray) -> Iterator[np.ndarray]:
    """Yield P2 with [[2 a11, a12 + a21ᵀP2], [·, P2 A22 + A22ᵀP2]] < 0, by its Schur complement in a11 < 0:

    P2 A22 + A22ᵀP2 + γ(P2 a21 + a12ᵀ)(·)ᵀ + ε I = 0,   γ = −1/(2 a11), for falling ε > 0. One that is near the largest
    with a solution may miss the inequality by rounding, so the caller tests each.
    """
    gamma = -0.5 / moved[0, 0]
    c, b, A22 = moved[0, 1:], moved[1:, 0], moved[1:, 1:]
    size = len(b)
    if size == 0:
        yield np.empty((0, 0))
        return
    drift = A22 + gamma * np.outer(b, c)
    for epsilon in gamma * 0.5 ** np.arange(-6, 50):
        Q = gamma * np.outer(c, c) + epsilon * np.eye(size)
        H = np.block([[drift, gamma * np.outer(b, b)], [-Q, -drift.T]])
        try:
            _, U, stable = scipy.linalg.schur(H, sort="lhp")
        except np.linalg.LinAlgError:  # eigenvalues too near the imaginary axis to be separated: ε is too large
            continue
        if stable == size and np.linalg.cond(U[:size, :size]) < 1e12:
            P2 = U[size:, :size] @ np.linalg.inv(U[:size, :size])
            if np.linalg.eigvalsh(P2 + P2.T)[0] > 0:
                yield (P2 + P2.T) / 2


def lyapunov_margin(P: np.ndarray, K: Sequence[float] | np.ndarray, rate: float = 0.0) -> float:
    """Return the largest eigenvalue of (A − KC)ᵀP + P(A − KC) + rate P."""
    matrix = P @ closed(K)
    return float(np.linalg.eigvalsh(matrix + matrix.T + rate * P)[-1])
