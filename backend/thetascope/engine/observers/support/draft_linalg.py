"""Small linear algebra written into a Draft: every intermediate is named, so expressions stay small for any size."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.observers.support.draft import Draft

if TYPE_CHECKING:
    from sympy import ImmutableMatrix, Matrix


def product(*factors: Matrix) -> ImmutableMatrix:
    """The matrix product, with sums over entries that are not identically zero: quick for large sparse matrices."""
    result = factors[0]
    for factor in factors[1:]:
        result = _times(result, factor)
    return sympy.ImmutableMatrix(result)


def _times(X: Matrix, Y: Matrix) -> ImmutableMatrix:
    rows = [[(k, X[i, k]) for k in range(X.shape[1]) if X[i, k] != 0] for i in range(X.shape[0])]
    entry = lambda i, j: sympy.Add(*[a * Y[k, j] for k, a in rows[i] if Y[k, j] != 0])
    return sympy.ImmutableMatrix(X.shape[0], Y.shape[1], entry)


def symmetric(size: int, entry: Callable[[int, int], sympy.Expr]) -> ImmutableMatrix:
    """A symmetric matrix from its entries on and above the diagonal."""
    upper = {(i, j): entry(i, j) for i in range(size) for j in range(i, size)}
    return sympy.ImmutableMatrix(size, size, lambda i, j: upper[min(i, j), max(i, j)])


def congruence(draft: Draft, name: str, X: Matrix, S: Matrix) -> ImmutableMatrix:
    """X S Xᵀ for symmetric S."""
    XS = draft.let(f"{name}.left", product(X, S))
    rows = [{k: X[i, k] for k in range(X.shape[1]) if X[i, k] != 0} for i in range(X.shape[0])]
    return symmetric(X.shape[0], lambda i, j: sympy.Add(*[XS[i, k] * a for k, a in rows[j].items() if XS[i, k] != 0]))


def solve(draft: Draft, name: str, M: Matrix, b: Matrix) -> ImmutableMatrix:
    """M⁻¹ b by Gaussian elimination; pivots are chosen by structure (first entry that is not identically zero).

    Raises ZeroDivisionError if M is structurally singular. A pivot that vanishes at run time gives a division by zero.
    """
    size, width = M.shape[0], b.shape[1]
    rows = [list(M.row(i)) + list(b.row(i)) for i in range(size)]
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
            rest = sum((rows[i][j] * solution[j][c] for j in range(i + 1, size)), sympy.S.Zero)
            solution[i][c] = draft.let(f"{name}.x{i}.{c}", (rows[i][size + c] - rest) / rows[i][i])
    return sympy.ImmutableMatrix(solution)


def cholesky(draft: Draft, name: str, M: Matrix) -> ImmutableMatrix:
    """Lower triangular L with L Lᵀ = M for symmetric positive definite M (only the lower triangle is read).

    A pivot that rounding has made negative or tiny is taken as 1e-15 of its diagonal entry.
    """
    size = M.shape[0]
    L = sympy.zeros(size, size).as_mutable()
    for j in range(size):
        pivot = M[j, j] - sympy.Add(*[L[j, k] ** 2 for k in range(j)])
        least = sympy.Max(sympy.Float(1e-15) * M[j, j], sympy.Float(1e-300), evaluate=False)
        L[j, j] = draft.let(f"{name}.{j}.{j}", sympy.sqrt(sympy.Max(pivot, least, evaluate=False)))
        for i in range(j + 1, size):
            rest = sympy.Add(*[L[i, k] * L[j, k] for k in range(j)])
            L[i, j] = draft.let(f"{name}.{i}.{j}", (M[i, j] - rest) / L[j, j])
    return sympy.ImmutableMatrix(L)
