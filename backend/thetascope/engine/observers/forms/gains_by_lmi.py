"""Gains K that meet (6) or (7) of Shen & Hu 2015, designed by linear matrix inequalities.

With Y = PK, (A − KC)ᵀP + P(A − KC) = AᵀP + PA − CᵀYᵀ − YC is linear in P and Y. What makes the inequalities more than
linear are c1 = √(λ1/λ2), the factor λ1/λ2 of (6), and c2 = max|k| √(n λ1/λ2). So the condition number κ ≥ λ1/λ2 takes a
grid of values, λ2 I ≤ P ≤ κ λ2 I is linear for each, and for a P found, the K with the least max|k| solves inequalities
that are linear in K and max|k|. P d = Cᵀ is met by what P is written in: the coordinates ξ of `matching_condition`.

The unknowns are P2 and M as triangles, Y, λ2 and a scalar that is made small or large. M is a matrix of its own, as in
(4): M ≥ sym(PG) for each G.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from thetascope.engine.observers.forms.lmi import least
from thetascope.engine.observers.forms.matching_condition import closed, shift

CONDITIONS = 2.0 ** np.arange(1, 21)  # κ
_MARGIN = 1.02  # on what the inequalities ask for: K is shown with some digits, and the solver is not exact
_GUESSES = (0.3, 0.6, 1.0, 1.4, 2.0, 3.0, 5.0, 8.0, 13.0)  # of max|k| in c2 while P is sought, times that for ρ = 0
_HARDEST = 6  # of the G that an answer violates, to add at a time
_ROUNDS = 12  # of adding those


@dataclass(frozen=True)
class Demand:
    """What an inequality asks the decay rate of eᵀPe to exceed: `fixed` + `faults` √κ + `shared` κ + 2ρ c2, and 2M.

    `faults` is 2 l1 l2. (6) has `shared` = β1 β3 + β2 + 1 and no M; (7) has M for the Jacobians G (points, n×n).
    """

    fixed: float
    faults: float
    shared: float
    G: np.ndarray
    rho: float

    def rate(self, condition: float, largest: float, n: int) -> float:
        """Return the rate for κ and max|k|, without M."""
        injection = 2 * self.rho * largest * np.sqrt(n * condition)
        return self.fixed + self.faults * np.sqrt(condition) + self.shared * condition + injection


@dataclass(frozen=True)
class Design:
    """Gains K (n,) and the P (n×n) and M (n×n) for which they meet the inequality."""

    K: np.ndarray
    P: np.ndarray
    M: np.ndarray


def design(d: np.ndarray, demand: Demand) -> Design | None:
    """Return the design with the smallest max|k| of those for each κ, which have the least KᵀPK; None without one.

    `d` is the direction of the matching condition (n,), d1 = 1. For ρ = 0 and κ below the largest of the grid, there is
    none if none is found, but for the 2 % of margin and the steps of the grid. For ρ > 0, c2 makes the search partial.
    """
    found = [one for condition in CONDITIONS if (one := _for_condition(d, demand, float(condition))) is not None]
    found = [one for one in found if usable(one.P) and excess(one, demand) > 0]
    return min(found, key=lambda one: float(np.abs(one.K).max()), default=None)


def _for_condition(d: np.ndarray, demand: Demand, condition: float) -> Design | None:
    """Return the design for this κ. For ρ > 0, P is sought for some max|k| in c2, and K then has its own."""
    P = _matrix_P(d, demand, condition, 0.0)
    if P is None:
        return None
    found = _smallest_K(P, demand, condition)
    if found is not None or demand.rho == 0:
        return found
    plain = _smallest_K(P, replace(demand, rho=0.0), condition)
    if plain is None:
        return None
    for share in _GUESSES:
        P = _matrix_P(d, demand, condition, share * float(np.abs(plain.K).max()))
        if P is None:
            return None
        found = _smallest_K(P, demand, condition)
        if found is not None:
            return found
    return None


def usable(P: np.ndarray) -> bool:
    """Return whether P > 0 with eigenvalues that are not lost in rounding."""
    spectrum = np.linalg.eigvalsh(P)
    return bool(spectrum[0] > 1e-12 * spectrum[-1])


def rate(K: np.ndarray, P: np.ndarray, M: np.ndarray | None = None) -> float:
    """Return the largest c with (A − KC)ᵀP + P(A − KC) + 2M ≤ −cP; M = 0 if it is not given."""
    matrix = P @ closed(K)
    half = np.linalg.inv(np.linalg.cholesky(P))
    return -float(np.linalg.eigvalsh(half @ (matrix + matrix.T + (0 if M is None else 2 * M)) @ half.T)[-1])


def excess(one: Design, demand: Demand) -> float:
    """Return by how much the rate exceeds what is asked for, with the P and M of the design."""
    spectrum = np.linalg.eigvalsh(one.P)
    largest = float(np.abs(one.K).max())
    return rate(one.K, one.P, one.M) - demand.rate(float(spectrum[-1] / spectrum[0]), largest, len(one.K))


def proof(K: np.ndarray, d: np.ndarray, demand: Demand) -> list[Design]:
    """Return P and M with which these gains are nearest to the inequality, one for each condition number tried."""
    n, found = len(d), []
    for condition in map(float, CONDITIONS):
        asked = demand.rate(condition, float(np.abs(K).max()), n)
        P = _with_planes(
            d, demand, lambda v, P, M, asked=asked, condition=condition: _nearest(v, P, M, K, asked, condition)
        )
        if P is not None and usable(P):
            found.append(Design(K, P, _least_M(P, demand.G)))
    return found


# ---- the inequalities ------------------------------------------------------------------------------------------------


class _Unknowns:
    """Places of the unknowns in v, and affine matrices of them."""

    def __init__(self, **sizes: int) -> None:
        self.place: dict[str, range] = {}
        self.count = 0
        for name, size in sizes.items():
            self.place[name] = range(self.count, self.count + size)
            self.count += size

    def constant(self, matrix: np.ndarray) -> np.ndarray:
        table = np.zeros((1 + self.count, *matrix.shape))
        table[0] = matrix
        return table

    def symmetric(self, name: str, size: int) -> np.ndarray:
        table = self.constant(np.zeros((size, size)))
        for k, (i, j) in zip(self.place[name], zip(*np.tril_indices(size), strict=True), strict=True):
            table[1 + k, i, j] = table[1 + k, j, i] = 1.0
        return table

    def vector(self, name: str) -> np.ndarray:
        """Return the unknowns of this name as a column (1 + unknowns, size, 1)."""
        table = self.constant(np.zeros((len(self.place[name]), 1)))
        for i, k in enumerate(self.place[name]):
            table[1 + k, i, 0] = 1.0
        return table

    def cost(self, **weights: float) -> np.ndarray:
        """Return the cost with these weights on the unknowns of these names (unknowns,)."""
        table = np.zeros(self.count)
        for name, weight in weights.items():
            table[self.place[name]] = weight
        return table


def _transposed(table: np.ndarray) -> np.ndarray:
    return table.transpose(0, 2, 1)


def _symmetric_part(table: np.ndarray) -> np.ndarray:
    return table + _transposed(table)


_Program = Callable[["_Unknowns", np.ndarray, np.ndarray], tuple[np.ndarray, list[np.ndarray]]]


def _with_planes(d: np.ndarray, demand: Demand, program: _Program) -> np.ndarray | None:
    """Return the P of a program in P and M, with the inequalities of (4) added where an answer violates them.

    `program` takes the unknowns, P and M, and returns the cost and the matrices that are to be positive semidefinite.
    """
    n = len(d)
    some = demand.G[:1]
    for _ in range(_ROUNDS):
        v = _Unknowns(P2=n * (n - 1) // 2, M=n * (n + 1) // 2 if len(some) else 0, Y=n, least=1, size=1)
        P = _matched(v, d)
        M = v.symmetric("M", n) if len(some) else v.constant(np.zeros((n, n)))
        cost, positive = program(v, P, M)
        bounded = [M, *(M - _symmetric_part(P @ G) / 2 for G in some)] if len(some) else []
        answer = least(cost, [*positive, *bounded])
        if answer is None:
            return None
        at = np.concatenate([[1.0], answer])
        found, bound = np.tensordot(at, P, 1), np.tensordot(at, M, 1)
        beyond = _beyond(found, bound, demand.G)
        worst = np.argsort(beyond)[-_HARDEST:]
        if not len(beyond) or beyond[worst[-1]] <= 1e-6 * np.abs(found).max() * (1 + np.abs(demand.G).max()):
            return found
        some = np.concatenate([some, demand.G[worst[beyond[worst] > 0]]])
    return None


def _conditioned(v: _Unknowns, P: np.ndarray, condition: float) -> list[np.ndarray]:
    """Return the matrices of λ2 I ≤ P ≤ κ λ2 I, λ2 ≥ 0."""
    least_P = v.vector("least") * np.eye(P.shape[1])
    return [P - least_P, condition * least_P - P, v.vector("least")]


def _matrix_P(d: np.ndarray, demand: Demand, condition: float, largest: float) -> np.ndarray | None:
    """Return a P with some K for this κ and this max|k| in c2, the one with the least KᵀPK; None without one."""
    asked = demand.rate(condition, largest, len(d)) * _MARGIN

    def program(v: _Unknowns, P: np.ndarray, M: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        Y, n = v.vector("Y"), len(d)
        decay = -_symmetric_part(P @ shift(n) - Y @ np.eye(n)[:1]) - asked * P - 2 * _MARGIN * M
        upper, lower = np.concatenate([P, Y], axis=2), np.concatenate([_transposed(Y), v.vector("size")], axis=2)
        ball = np.concatenate([upper, lower], axis=1)  # ≥ 0 exactly if KᵀPK ≤ size
        return v.cost(size=1.0), [decay, ball, *_conditioned(v, P, condition)]

    return _with_planes(d, demand, program)


def _nearest(
    v: _Unknowns, P: np.ndarray, M: np.ndarray, K: np.ndarray, asked: float, condition: float
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the program of the P and M that meet the inequality with K by most, or miss it by least."""
    margin = v.vector("size")
    decay = -_symmetric_part(P @ closed(K)) - asked * P - 2 * M - margin * np.eye(len(K))
    return v.cost(size=-1.0), [decay, *_conditioned(v, P, condition)]


def _beyond(P: np.ndarray, M: np.ndarray, G: np.ndarray) -> np.ndarray:
    """Return λmax(sym(PG) − M) for each G (points,)."""
    if not len(G):
        return np.empty(0)
    moved = P @ G
    return np.linalg.eigvalsh((moved + moved.transpose(0, 2, 1)) / 2 - M)[:, -1]


def _matched(v: _Unknowns, d: np.ndarray) -> np.ndarray:
    """Return P = Nᵀ diag(1, P2) N, which has P d = Cᵀ; N takes x to ξ."""
    n = len(d)
    N = np.eye(n)
    N[1:, 0] = -d[1:]
    inner = v.constant(np.zeros((n, n)))
    inner[:, 1:, 1:] = v.symmetric("P2", n - 1)
    inner[0, 0, 0] = 1.0
    return N.T @ inner @ N


def _smallest_K(P: np.ndarray, demand: Demand, condition: float) -> Design | None:
    """Return the K with the least max|k| that meets the inequality with this P; None without one."""
    n = len(P)
    if not usable(P):
        return None
    spectrum = np.linalg.eigvalsh(P)
    condition = min(condition, float(spectrum[-1] / spectrum[0]))
    M = _least_M(P, demand.G)
    v = _Unknowns(K=n, most=1)
    K, most = v.vector("K"), v.vector("most")
    plain, slope = demand.rate(condition, 0.0, n), 2 * demand.rho * np.sqrt(n * condition)
    asked = v.constant(P * plain + 2 * M) + slope * most * P
    decay = -_symmetric_part(v.constant(P @ shift(n)) - P @ K @ np.eye(n)[:1]) - _MARGIN * asked
    bounds = [most - side * K[:, i : i + 1] for i in range(n) for side in (1, -1)]
    answer = least(v.cost(most=1.0), [decay, *bounds])
    return None if answer is None else Design(answer[:n], P, M)


def _least_M(P: np.ndarray, G: np.ndarray) -> np.ndarray:
    """Return the M ≥ 0 with sym(PG) ≤ M for each G (points, n×n) and the least trace of P⁻¹M; 0 without any G."""
    n = len(P)
    if not len(G):
        return np.zeros((n, n))
    half = np.linalg.cholesky(P)
    inverse = np.linalg.inv(half)
    parts = inverse @ (P @ G + (P @ G).transpose(0, 2, 1)) @ inverse.T / 2
    some = parts[:1]
    size = 1.0 + float(np.abs(parts).max())
    for _ in range(_ROUNDS):
        v = _Unknowns(M=n * (n + 1) // 2)
        M = v.symmetric("M", n)
        cost = np.array([1.0 if i == j else 0.0 for i, j in zip(*np.tril_indices(n), strict=True)])
        answer = least(cost, [M, *(M - v.constant(part) for part in some)])
        if answer is None:
            break
        bound = np.tensordot(answer, M[1:], 1)
        beyond = np.linalg.eigvalsh(parts - bound)[:, -1]
        if beyond.max() <= 1e-7 * size:
            return half @ (bound + max(float(beyond.max()), 0.0) * np.eye(n)) @ half.T
        some = np.concatenate([some, parts[np.argsort(beyond)[-_HARDEST:]]])
    return max(float(np.linalg.eigvalsh(parts)[:, -1].max()), 0.0) * P
