"""Matrices of expressions, written as in a paper: ``A @ P + P @ A.T + Q - K @ C @ P``.

``Matrix`` holds SymPy expressions. A chain of products is evaluated when its entries are needed, in the order that
requires the fewest multiplications. Intermediate products of a chain are named in the Draft, so that expressions stay
small; the last product is not named, so that a sum stays flat. A named product is reused wherever the same two matrices
are multiplied, also transposed: after ``d.let("CP", C @ P)``, ``P @ C.T`` is CPᵀ and ``K @ C @ P`` is K (CP).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol, overload

from thetascope.engine.language.lazy_sympy import sympy

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Symbol

Index = int | slice


class Namer(Protocol):
    """Names intermediate products: a Draft."""

    def name_product(self, left: Matrix, right: Matrix, entries: ImmutableMatrix) -> Matrix:
        """Name the product of two matrices and return its symbols."""
        ...

    def named_product(self, left: Matrix, right: Matrix) -> Matrix | None:
        """Return the named product of two matrices; None where it has no name."""
        ...


class Matrix:
    """A matrix of SymPy expressions, immutable.

    Args:
        entries: a SymPy matrix, or rows of expressions.
        name: prefix of the names of its intermediate products; may be empty.
        draft: names intermediate products; None for a constant.
    """

    def __init__(self, entries: Any, name: str = "", draft: Namer | None = None) -> None:
        self._given = sympy.ImmutableMatrix(entries)
        self.name, self.draft = name, draft

    @property
    def entries(self) -> ImmutableMatrix:
        """Return the expressions as a SymPy matrix."""
        return self._given

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of rows and columns."""
        rows, columns = self.entries.shape
        return int(rows), int(columns)

    @property
    def T(self) -> Matrix:
        """Return the transpose."""
        name = self.name.removesuffix("'") if self.name.endswith("'") else f"{self.name}'" if self.name else ""
        return Matrix(self.entries.T, name, self.draft)

    @overload
    def __getitem__(self, at: int | tuple[int, int]) -> Expr: ...
    @overload
    def __getitem__(self, at: tuple[Index, slice] | tuple[slice, int]) -> Matrix: ...
    def __getitem__(self, at: Any) -> Any:
        """Return an entry (``M[i]`` counts along the rows) or, with a slice, a part."""
        part = self.entries[at]
        return self._with(part) if isinstance(part, sympy.MatrixBase) else part

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Matrix) and self.entries == other.entries

    def __hash__(self) -> int:
        return hash(self.entries)

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[Expr]:
        return iter(self.entries)

    def __add__(self, other: Matrix) -> Matrix:
        return self._with(self.entries + _entries(other), other)

    def __sub__(self, other: Matrix) -> Matrix:
        return self._with(self.entries - _entries(other), other)

    def __neg__(self) -> Matrix:
        return self._with(-self.entries)

    def __mul__(self, scalar: Expr | float) -> Matrix:
        return self._with(self.entries * _scalar(scalar))

    __rmul__ = __mul__

    def __truediv__(self, scalar: Expr | float) -> Matrix:
        return self._with(self.entries / _scalar(scalar))

    def __matmul__(self, other: Matrix) -> Matrix:
        own = self.factors if isinstance(self, Product) else (self,)
        return Product((*own, other))

    def inv(self) -> Matrix:
        """Return the symbolic inverse, for small or diagonal matrices; use draft_linalg.solve for others."""
        return self._with(self.entries.inv())

    def map(self, function: Callable[[Expr], Expr]) -> Matrix:
        """Return the matrix of function(entry)."""
        return self._with(self.entries.applyfunc(function))

    def _with(self, entries: ImmutableMatrix, other: Matrix | None = None) -> Matrix:
        return Matrix(entries, "", self.draft or (other.draft if other is not None else None))


class Product(Matrix):
    """A product of two or more matrices, evaluated when its entries are needed."""

    def __init__(self, factors: Sequence[Matrix]) -> None:
        for left, right in pairwise(factors):
            if left.shape[1] != right.shape[0]:
                raise ValueError(f"{left.name or 'a matrix'} {left.shape} @ {right.name or 'a matrix'} {right.shape}")
        self.factors = tuple(factors)
        self.name = ""
        self.draft = next((f.draft for f in factors if f.draft is not None), None)

    @property
    def shape(self) -> tuple[int, int]:
        """Return the rows of the first factor and the columns of the last."""
        return self.factors[0].shape[0], self.factors[-1].shape[1]

    @property
    def T(self) -> Matrix:
        """Return the product of the transposed factors in reverse order."""
        return Product([f.T for f in reversed(self.factors)])

    @cached_property
    def last(self) -> tuple[Matrix, Matrix]:
        """Return the last two matrices to multiply; all other intermediate products are evaluated and named."""
        split = _splits(self.factors, self.draft)[0, len(self.factors) - 1][1]
        return self._part(0, split), self._part(split + 1, len(self.factors) - 1)

    # SymPy's own entries are an attribute; here they are computed when needed
    @cached_property
    def entries(  # pyright: ignore[reportIncompatibleMethodOverride, reportIncompatibleVariableOverride]
        self,
    ) -> ImmutableMatrix:
        """Return the evaluated product."""
        left, right = self.last
        named = self.draft.named_product(left, right) if self.draft else None
        return named.entries if named is not None else times(left.entries, right.entries)

    def _part(self, first: int, last: int) -> Matrix:
        """Return the product of the factors first … last, named if there are several."""
        if first == last:
            return self.factors[first]
        part = Product(self.factors[first : last + 1])
        left, right = part.last
        if self.draft is None:
            return Matrix(part.entries)
        return self.draft.named_product(left, right) or self.draft.name_product(left, right, part.entries)


def _splits(factors: Sequence[Matrix], draft: Namer | None) -> dict[tuple[int, int], tuple[int, int]]:
    """Return, for each range of factors, the fewest multiplications and the split. A named product costs nothing."""
    best: dict[tuple[int, int], tuple[int, int]] = {(i, i): (0, i) for i in range(len(factors))}
    for length in range(2, len(factors) + 1):
        for first in range(len(factors) - length + 1):
            last = first + length - 1
            rows, columns = factors[first].shape[0], factors[last].shape[1]
            if length == 2 and draft is not None and draft.named_product(factors[first], factors[last]) is not None:
                best[first, last] = 0, first
                continue
            costs = [
                (best[first, k][0] + best[k + 1, last][0] + rows * factors[k].shape[1] * columns, -k)
                for k in range(first, last)
            ]
            cost, split = min(costs)
            best[first, last] = cost, -split
    return best


def times(X: ImmutableMatrix, Y: ImmutableMatrix) -> ImmutableMatrix:
    """Return X Y, with sums over the entries that are not identically zero: quick for large sparse matrices."""
    rows = [[(k, X[i, k]) for k in range(X.shape[1]) if X[i, k] != 0] for i in range(X.shape[0])]

    def entry(i: int, j: int) -> Expr:
        return sympy.Add(*[a * Y[k, j] for k, a in rows[i] if Y[k, j] != 0])

    return sympy.ImmutableMatrix(X.shape[0], Y.shape[1], entry)


def _entries(other: object) -> ImmutableMatrix:
    if not isinstance(other, Matrix):
        raise TypeError(f"a Matrix is needed, not {type(other).__name__}")
    return other.entries


def _scalar(value: Expr | float) -> Expr:
    if isinstance(value, Matrix):
        raise TypeError("use @ for the product of matrices")
    return expression(value)


def expression(value: object) -> Expr:
    """Return a number or an expression as a SymPy expression. Raises TypeError for anything else, such as text."""
    if not isinstance(value, sympy.Basic | int | float):
        raise TypeError(f"an expression is needed, not {type(value).__name__}")
    return sympy.sympify(value)


# ---- constructors ----------------------------------------------------------------------------------------------------


def matrix(rows: int, columns: int, entry: Callable[[int, int], Any]) -> Matrix:
    """Return the rows × columns matrix of entry(i, j)."""
    return Matrix(sympy.ImmutableMatrix(rows, columns, entry))


def column(entries: Sequence[Any]) -> Matrix:
    """Return a column of expressions or numbers."""
    return Matrix(sympy.ImmutableMatrix(len(entries), 1, list(entries)))


def eye(size: int) -> Matrix:
    """Return the unit matrix."""
    return Matrix(sympy.eye(size))


def zeros(rows: int, columns: int = 1) -> Matrix:
    """Return a matrix of zeros."""
    return Matrix(sympy.zeros(rows, columns))


def diag(entries: Sequence[Any] | Matrix) -> Matrix:
    """Return the diagonal matrix with these entries."""
    return Matrix(sympy.diag(*entries))


def block(rows: Sequence[Sequence[Matrix]]) -> Matrix:
    """Return the matrix composed of blocks, row by row: ``block([[A, B], [C, D]])``."""
    parts = [[part.entries for part in row] for row in rows]
    draft = next((part.draft for row in rows for part in row if part.draft is not None), None)
    joined = [sympy.ImmutableMatrix.hstack(*row) for row in parts]
    return Matrix(sympy.ImmutableMatrix.vstack(*joined), "", draft)


def symmetric(size: int, entry: Callable[[int, int], Expr]) -> Matrix:
    """Return a symmetric matrix from its entries on and above the diagonal."""
    upper = {(i, j): entry(i, j) for i in range(size) for j in range(i, size)}
    return matrix(size, size, lambda i, j: upper[min(i, j), max(i, j)])


def symbols_matrix(rows: int, columns: int, names: Callable[[int, int], str]) -> ImmutableMatrix:
    """Return a SymPy matrix of real symbols named names(i, j)."""
    return sympy.ImmutableMatrix(rows, columns, lambda i, j: _symbol(names(int(i), int(j))))


def _symbol(name: str) -> Symbol:
    return sympy.Symbol(name, real=True)
