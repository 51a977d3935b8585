"""The exact discretisation of a covariance between two rows.

With A and W constant over an interval Δ, S' = A S + S Aᵀ + W has the solution

    S(Δ) = F S(0) Fᵀ + Q,    F = exp(AΔ),    Q = ∫₀^Δ exp(As) W exp(Aᵀs) ds

(Van Loan, IEEE TAC 23(3), 1978). Both are computed on Δ/2^k and doubled k times: Q ← Q + F Q Fᵀ, F ← F². Slow parts
beside fast ones keep their digits because E = F − I is doubled in place of F: E ← 2 E + E². Q of the shortest interval
is a sum of squares, by Gauss' rule over exp(As) W^½, so that S is symmetric and positive semidefinite by construction.
Nothing limits how stiff A may be: the number of doublings grows with the logarithm of ‖A‖Δ.

A row's numbers depend on this row alone, whatever rows are computed together with it.
"""

from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.jit import NEVER, Layout, Segments, kernel
from thetascope.engine.estimation.covariance_equations import FADING, MOST, recursion

GROWTH = 1e12  # largest factor by which an unstable deviation grows within a row, in units of the scales
_CLASSES = (
    (0.02, 4, 2),
    (0.1, 6, 3),
    (0.5, 9, 4),
)  # ‖A‖h up to which a series of this order and this many Gauss points is exact
_SWEEPS = 2  # of balancing
_STIFFEST = 1e60  # largest ‖A‖Δ
_CHUNK = 1 << 19  # numbers in one temporary array
_COMPILED = 14  # estimates up to which the recursion is compiled; above, NumPy's products take as long


def transitions(A: np.ndarray, noise: np.ndarray, interval: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return F and Q (rows × N × N each).

    Args:
        A: rows × N × N, with deviations in units of their scales.
        noise: rows × N × m, a root of W: W = noise · noiseᵀ.
        interval: (rows,), Δ in s.
    """
    rows, size = A.shape[:2]
    F, Q = np.empty_like(A), np.empty_like(A)
    each = max(1, _CHUNK // (size * size))
    for begin in range(0, rows, each):
        part = slice(begin, min(begin + each, rows))
        F[part], Q[part] = _chunk(A[part], noise[part], interval[part])
    return F, Q


def _chunk(A: np.ndarray, noise: np.ndarray, interval: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    A, units = _balanced(A)
    noise = noise * units[:, :, None]
    size = np.abs(A).sum(axis=2).max(axis=1) * interval
    stiff = size > _STIFFEST
    if stiff.any():  # over a part of the interval the fast deviations reach the same end
        interval = np.where(stiff, interval * (_STIFFEST / np.where(stiff, size, 1.0)), interval)
        size = np.where(stiff, _STIFFEST, size)
    limit = _CLASSES[-1][0]
    doublings = np.maximum(np.frexp(size / limit)[1], 0)
    h = np.ldexp(interval, -doublings)
    E, Q, unit = np.empty_like(A), np.empty_like(A), np.eye(A.shape[1])
    below = -1.0
    for up_to, order, points in _CLASSES:
        rows = np.flatnonzero((size > below) & ((size <= up_to) | (up_to == limit)))
        below = up_to
        if len(rows):
            E[rows], Q[rows] = _short(A[rows] * h[rows, None, None], noise[rows], h[rows], order, points)
    for k in range(int(doublings.max(initial=0))):
        rows = np.flatnonzero(doublings > k)
        e, q = E[rows], Q[rows]
        f = unit + e
        q = _bounded(q + f @ q @ f.transpose(0, 2, 1), GROWTH**2)
        E[rows], Q[rows] = _bounded(2 * e + e @ e, GROWTH), (q + q.transpose(0, 2, 1)) / 2
    return unit + E * (units[:, None, :] / units[:, :, None]), Q / (units[:, None, :] * units[:, :, None])


def _balanced(A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return D A D⁻¹ and the diagonal of D (rows × N): powers of two that make rows and columns equally large.

    Osborne, J. ACM 7(4), 1960. Few doublings are then needed, since the norm is close to the rates of the system.
    """
    units = np.ones(A.shape[:2])
    size = np.abs(A)
    for i in [*range(A.shape[1])] * _SWEEPS:
        row, column = size[:, i].sum(axis=1) - size[:, i, i], size[:, :, i].sum(axis=1) - size[:, i, i]
        coupled = (row > 0) & (column > 0)
        factor = np.ldexp(1.0, np.where(coupled, (np.frexp(column)[1] - np.frexp(row)[1]) // 2, 0))
        size[:, i] *= factor[:, None]
        size[:, :, i] /= factor[:, None]
        units[:, i] *= factor
    return A * (units[:, :, None] / units[:, None, :]), units


def _short(M: np.ndarray, noise: np.ndarray, h: np.ndarray, order: int, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return F − I and Q over an interval h on which M = A h is small, by Taylor's series and Gauss' rule."""
    unit = np.eye(M.shape[1])
    E = unit + M / order
    for k in range(order - 1, 1, -1):
        E = unit + (M @ E) / k
    E = M @ E
    places, weights = _gauss(points)
    term = noise * np.sqrt(h)[:, None, None]
    moved = [term.copy() for _ in range(points)]
    for k in range(1, order):
        term = (M @ term) / k
        for root, place in zip(moved, places, strict=True):
            root += place**k * term
    Q = np.zeros_like(M)
    for root, weight in zip(moved, weights, strict=True):
        Q += weight * (root @ root.transpose(0, 2, 1))
    return E, Q


def _bounded(matrices: np.ndarray, largest: float) -> np.ndarray:
    """Return matrices scaled so that no entry exceeds a limit: a covariance stays one."""
    size = np.abs(matrices).max(axis=(1, 2), keepdims=True)
    return matrices * np.where(size > largest, largest / size, 1.0)


@lru_cache(maxsize=4)
def _gauss(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places and weights of Gauss' rule on [0, 1]."""
    places, weights = np.polynomial.legendre.leggauss(points)
    return (places + 1) / 2, weights / 2


def propagate(
    F: np.ndarray, Q: np.ndarray, W: np.ndarray, first: np.ndarray, steps: np.ndarray, parameters: tuple[float, ...]
) -> np.ndarray:
    """Return the states of `recursion` at each row and after the last one (rows + 1).

    Args:
        F, Q: rows × n × n.
        W: rows × p.
        first: the states at the first row.
        steps: (rows,), the steps of each row's interval; 0 where S does not change.
        parameters: those of `recursion`.
    """
    n, p = F.shape[1], W.shape[1]
    advance = _compiled if n <= _COMPILED else _in_numpy
    moving = np.flatnonzero(steps)
    table = np.empty((len(moving) + 1, len(first)))
    table[0] = first
    if len(moving):
        i, j = np.triu_indices(n)
        held = np.concatenate([F[moving].reshape(-1, n * n), Q[moving][:, i, j], W[moving]], axis=1)
        advance(held, steps[moving], table, parameters, n, p)
    return table if len(moving) == len(steps) else table[np.searchsorted(moving, np.arange(len(steps) + 1))]


def _compiled(
    held: np.ndarray, steps: np.ndarray, table: np.ndarray, parameters: tuple[float, ...], n: int, p: int
) -> None:
    """Fill the table from its second row on, with the compiled recursion."""
    program = recursion(n, p)
    run = kernel(program, Layout(held=program.inputs))
    zeros = np.zeros(len(steps))
    params = np.array(parameters)
    run(Segments(steps, steps, zeros, zeros, zeros), table[0].copy(), params, int(NEVER), table[1:], held=held)


def _in_numpy(
    held: np.ndarray, steps: np.ndarray, table: np.ndarray, parameters: tuple[float, ...], n: int, p: int
) -> None:
    """Fill the table from its second row on: the equations of `recursion` with arrays."""
    interval, memory, follow, end = parameters
    i, j = np.triu_indices(n)
    S, recent, theta = np.zeros((n, n)), table[0, len(i) :].copy(), np.arange(n - p, n)
    S[i, j] = S[j, i] = table[0, : len(i)]
    for row, (numbers, count) in enumerate(zip(held, steps, strict=True), start=1):
        F, W = numbers[: n * n].reshape(n, n), numbers[n * n + len(i) :]
        Q = np.zeros((n, n))
        Q[i, j] = Q[j, i] = numbers[n * n : n * n + len(i)]
        for _ in range(count):
            before = S[theta, theta]
            S = F @ S @ F.T + Q
            after = S[theta, theta]
            eta = W * ((1 - end) / np.maximum(before, 1e-300) + end / np.maximum(after, 1e-300))
            rate = np.minimum(FADING * recent, memory) + 1e-12 * memory
            S[theta, theta] += rate / (1 + (eta / rate) ** 4) * (before + end * (after - before)) * interval
            recent = recent + follow * (eta - recent)
            share = np.sqrt(MOST**2 / np.maximum(np.diag(S), MOST**2))
            S = (S + S.T) / 2 * np.outer(share, share)
        table[row, : len(i)], table[row, len(i) :] = S[i, j], recent
