"""Small linear algebra written into a Draft: every intermediate is named, so expressions stay small for any size."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.matrices import Matrix, eye

if TYPE_CHECKING:
    from sympy import Expr


def joseph(d: Draft, name: str, P: Matrix, K: Matrix, C: Matrix, R: Matrix) -> Matrix:
    """Return (I − KC) P (I − KC)ᵀ + K R Kᵀ (n×n), Joseph's form of the covariance after a measurement."""
    kept = d.let(f"{name}.kept", eye(P.shape[0]) - K @ C)
    return kept @ P @ kept.T + K @ R @ K.T


def solve(draft: Draft, name: str, M: Matrix, b: Matrix) -> Matrix:
    """Return M⁻¹ b by Gaussian elimination with structural pivots: the first entry that is not identically zero.

    Raises ZeroDivisionError if M is structurally singular. A pivot that vanishes at run time gives a division by zero.
    """
    size, width = M.shape[0], b.shape[1]
    rows: list[list[Expr]] = [[*M.entries.row(i), *b.entries.row(i)] for i in range(size)]
    for k in range(size):
        pivot = next((i for i in range(k, size) if rows[i][k].is_number and rows[i][k] != 0), None)
        pivot = pivot if pivot is not None else next((i for i in range(k, size) if rows[i][k] != 0), None)
        if pivot is None:
            raise ZeroDivisionError(f"{name}: the matrix has no inverse")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, size):
            if rows[i][k] == 0:
                continue
            factor = draft.let(f"{name}.l{i}.{k}", rows[i][k] / rows[k][k])
            for j in range(k + 1, size + width):
                if rows[k][j] != 0:
                    rows[i][j] = draft.let(f"{name}.a{k}.{i}.{j}", rows[i][j] - factor * rows[k][j])
    solution = [[sympy.S.Zero] * width for _ in range(size)]
    for i in reversed(range(size)):
        for c in range(width):
            rest: Expr = sum((rows[i][j] * solution[j][c] for j in range(i + 1, size)), sympy.S.Zero)
            solution[i][c] = draft.let(f"{name}.x{i}.{c}", (rows[i][size + c] - rest) / rows[i][i])
    return Matrix(solution, name, draft)


def cholesky(draft: Draft, name: str, M: Matrix) -> Matrix:
    """Return the lower triangular L with L Lᵀ = M for symmetric positive definite M. Only the lower triangle is read.

    A pivot that is negative or tiny by rounding is replaced by 1e-15 of its diagonal entry.
    """
    size = M.shape[0]
    L = sympy.zeros(size, size)
    for j in range(size):
        pivot = M[j, j] - sympy.Add(*[L[j, k] ** 2 for k in range(j)])
        least = sympy.Max(sympy.Float(1e-15) * M[j, j], sympy.Float(1e-300), evaluate=False)
        L[j, j] = draft.let(f"{name}.{j}.{j}", sympy.sqrt(sympy.Max(pivot, least, evaluate=False)))
        for i in range(j + 1, size):
            rest = sympy.Add(*[L[i, k] * L[j, k] for k in range(j)])
            L[i, j] = draft.let(f"{name}.{i}.{j}", (M[i, j] - rest) / L[j, j])
    return Matrix(L, name, draft)
