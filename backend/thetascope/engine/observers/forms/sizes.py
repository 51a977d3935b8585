"""Bounds on the size of an expression before it is made: what SymPy would need minutes for is not begun.

The number of operations says little: (a + b + c + d + e + f)^64 has seven, and 11 million terms when it is expanded.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb
from typing import TYPE_CHECKING

from thetascope.engine.language.derivatives import jacobian
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Matrix, Symbol

MOST_TERMS = 2_000
"""Terms of an expanded sum, or of the polynomials of a fraction."""
MOST_NODES = 20_000
"""Nodes of a derivative, before it is simplified."""
_ENDLESS = 10**9


class TooLarge(Exception):
    """The expression would have too many terms or nodes; `message` says so."""

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message


def expanded(e: Expr) -> Expr:
    """Return an expression as a sum of products. Raises TooLarge."""
    if max(terms(part) for part in sympy.preorder_traversal(e)) > MOST_TERMS:
        raise TooLarge(Message("observer.reason.too-many-terms", most=MOST_TERMS))
    return sympy.expand(e)


def simpler(e: Expr) -> Expr:
    """Return an expression simplified, or as it is if it is too large for that."""
    return sympy.simplify(e) if cancels(e) and nodes(e) <= MOST_TERMS else e


def cancels(e: Expr) -> bool:
    """Return whether the polynomials of an expression are small enough to cancel their common factors."""
    return max(fraction_terms(e)) <= MOST_TERMS


def lie_derivative(e: Expr, x: Sequence[Symbol], f: Matrix) -> Expr:
    """Return (∂e/∂x) f. Raises TooLarge."""
    moving = [j for j, symbol in enumerate(x) if symbol in e.free_symbols]
    sizes: dict[Expr, int] = {}
    size = sum(derivative_nodes(e, x[j], sizes) + nodes(f[j], sizes) for j in moving)
    if size > MOST_NODES:
        raise TooLarge(Message("observer.reason.too-long", most=MOST_NODES))
    return (jacobian([e], x) * f)[0]


def check_jacobian(vector: Sequence[Expr], x: Sequence[Symbol]) -> None:
    """Refuse a vector whose Jacobian has too many nodes. Raises TooLarge."""
    sizes: dict[Expr, int] = {}
    if sum(derivative_nodes(e, symbol, sizes) for e in vector for symbol in x) > 4 * MOST_NODES:
        raise TooLarge(Message("observer.reason.too-long", most=4 * MOST_NODES))


def terms(e: Expr) -> int:
    """Return a bound on the terms of an expression that is expanded."""
    if e.is_Add:
        return min(_ENDLESS, sum(terms(a) for a in e.args))
    if e.is_Mul:
        return _product(terms(a) for a in e.args)
    return _powers(terms(e.base), int(e.exp)) if e.is_Pow and e.exp.is_Integer and e.exp > 0 else 1


def fraction_terms(e: Expr) -> tuple[int, int]:
    """Return bounds on the terms of numerator and denominator of an expression as one fraction of polynomials."""
    if e.is_Mul:
        parts = [fraction_terms(a) for a in e.args]
        return _product(n for n, _ in parts), _product(d for _, d in parts)
    if e.is_Add:
        parts = [fraction_terms(a) for a in e.args]
        whole = _product(d for _, d in parts)
        return min(_ENDLESS, sum(n * whole // d for n, d in parts)), whole
    if e.is_Pow and e.exp.is_Integer:
        n, d = (_powers(part, abs(int(e.exp))) for part in fraction_terms(e.base))
        return (n, d) if e.exp > 0 else (d, n)
    return 1, 1


def nodes(e: Expr, known: dict[Expr, int] | None = None) -> int:
    """Return the nodes of an expression as a tree; `known` keeps those of its parts."""
    known = {} if known is None else known
    if e not in known:
        known[e] = min(_ENDLESS, 1 + sum(nodes(a, known) for a in e.args))
    return known[e]


def derivative_nodes(e: Expr, symbol: Symbol, known: dict[Expr, int]) -> int:
    """Return a bound on the nodes of ∂e/∂symbol before it is simplified; `known` keeps the nodes of parts."""
    if e == symbol:
        return 1
    if symbol not in e.free_symbols:
        return 0
    inner = [derivative_nodes(a, symbol, known) for a in e.args]
    if e.is_Add:
        return min(_ENDLESS, 1 + sum(inner))
    if e.is_Mul:  # in each term one factor is replaced by its derivative
        return min(_ENDLESS, 1 + sum(d + nodes(e, known) for d in inner if d))
    return min(_ENDLESS, sum(inner) + 2 * nodes(e, known) + 2)


def _product(counts) -> int:
    total = 1
    for count in counts:
        total = min(_ENDLESS, total * count)
    return total


def _powers(count: int, exponent: int) -> int:
    """Return the terms of a sum of `count` terms to a power: the monomials of that degree."""
    if count == 1 or exponent == 0:
        return 1
    if count > MOST_TERMS:
        return _ENDLESS
    return min(_ENDLESS, comb(count + exponent - 1, min(exponent, count - 1)))
