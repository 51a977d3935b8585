"""Derivatives of SymPy expressions that are finite wherever the function has one.

The chain rule multiplies slopes, and the slope of a root or of |x|^a (a < 1) is infinite at 0. Where the other factor
is 0 there, as in x·√|x|, the product would be 0·∞. One rule replaces it, here and in engine/compiler/autodiff.py:

- where a function has a derivative, the result is this derivative;
- at a kink (abs, min, max, clip, a point of a linear table) it is the limit along one direction, in which all symbols
  fall;
- where a tangent is vertical (a root at 0, asin at 1), and where atan2 jumps, the slope counts as 0;
- at a jump (sign, floor, step, where) the result is that of the branch taken.

The first case follows from the second, because limits along one direction obey the chain rule, and from the third,
because a slope |x|^(a − 1) times a factor that makes the product smooth contributes 0 in the limit. The exception is a
function linear in x that is written as a product of two roots of different bases, √(x + y)·√(2x + 2y): it counts as 0.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from thetascope.engine.language.lazy_sympy import functions, numerical, sympy

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Symbol


def derivative(e: Expr, symbol: Symbol) -> Expr:
    """Return ∂e/∂symbol, finite where e is smooth; see the module."""
    if symbol not in e.free_symbols:
        return sympy.S.Zero
    e = real(e)
    if e.has(functions.sign):  # x·sign(x) is |x| and |x|·sign(x) is x: the factor that jumps would be taken at 0
        e = e.replace(_has_signed_size, _signed_size)
    if any(_has_unknown_exponent(part) for part in e.atoms(sympy.Pow)):
        opaque = e.replace(_has_unknown_exponent, lambda p: functions.Power(*p.args))
        slope = opaque.diff(symbol).replace(functions.Power, sympy.Pow)
    else:
        slope = e.diff(symbol)
    return _resolved(_guarded(real(slope), e))


def jacobian(vector: Iterable[Expr], symbols: Sequence[Symbol]) -> ImmutableMatrix:
    """Return the matrix of the derivatives of each entry (rows) with respect to each symbol (columns)."""
    entries = list(vector)
    return sympy.ImmutableMatrix(len(entries), len(symbols), lambda i, j: derivative(entries[i], symbols[j]))


def real(e: Expr) -> Expr:
    """Return an expression with the language's own abs and sign for those of SymPy.

    SymPy makes its own Abs of √x², whose second derivative is a Dirac impulse.
    """
    return (
        e.replace(sympy.Abs, functions.Abs).replace(sympy.sign, functions.sign) if e.has(sympy.Abs, sympy.sign) else e
    )


def _resolved(slope: Expr) -> Expr:
    """Return a derivative with the limits along the direction written out."""
    if not slope.has(functions.SignNext, functions.LessNext, numerical.InterpNext):
        return slope
    slope = slope.replace(numerical.InterpNext, _interp_next)
    return slope.replace(functions.SignNext, _sign_next).replace(functions.LessNext, _less_next)


def _direction(e: Expr) -> Expr:
    """Return the rate of an expression along the direction in which all symbols fall, each at a rate of its own.

    The rates differ so that x − y is not constant along it.
    """
    rates = {s: sympy.Float(-1 - zlib.crc32(s.name.encode()) / 2**32) for s in sorted(e.free_symbols, key=str)}
    return sympy.Add(*(rate * derivative(e, s) for s, rate in rates.items()))


def _sign_next(x: Expr) -> Expr:
    """Return the sign of x; at 0 the sign that it has next along the direction."""
    rate = _direction(x)
    if rate.is_positive:
        return functions.Where(functions.Less(x, sympy.S.Zero), sympy.S.NegativeOne, sympy.S.One)
    if rate.is_negative:
        return functions.Where(functions.Less(sympy.S.Zero, x), sympy.S.One, sympy.S.NegativeOne)
    if rate == 0:
        return functions.sign(x)
    apart = functions.Less(sympy.S.Zero, functions.Abs(x))
    return functions.Where(apart, functions.sign(x), functions.sign(rate))


def _less_next(a: Expr, b: Expr) -> Expr:
    """Return the condition a < b; where a = b, whether a grows no faster than b along the direction."""
    gain = _direction(a) - _direction(b)
    if gain.is_nonpositive:
        return functions.LessEqual(a, b)
    if gain.is_positive:
        return functions.Less(a, b)
    tie = functions.And_(functions.LessEqual(a, b), functions.LessEqual(gain, sympy.S.Zero))
    return functions.Or_(functions.Less(a, b), tie)


def _interp_next(x: Expr, table: Expr) -> Expr:
    """Return the value of a table at x; at a jump the one that x has next along the direction."""
    rate = _direction(x)
    above, below = (numerical.Interp(x, table, sympy.Integer(side)) for side in (0, 1))
    if rate.is_nonnegative:
        return above
    if rate.is_negative:
        return below
    return functions.Where(functions.Less(rate, sympy.S.Zero), below, above)


def _has_unknown_exponent(e: Expr) -> bool:
    return e.is_Pow and not e.exp.is_number and e.base != sympy.E


def _has_signed_size(e: Expr) -> bool:
    return e.is_Mul and _size_of_sign(e) is not None


def _size_of_sign(product: Expr) -> tuple[Expr, Expr, Expr] | None:
    """Return factors sign(a) and a, or sign(a) and |a|^p, of a product, and the product of both."""
    for factor in product.args:
        if isinstance(factor, functions.sign):
            inner = factor.args[0]
            for other in product.args:
                base, exponent = other.as_base_exp()
                if other == inner:
                    return factor, other, functions.Abs(inner)
                if base == functions.Abs(inner) and exponent.is_positive:
                    return factor, other, functions.SignedPower(inner, exponent)
    return None


def _signed_size(product: Expr) -> Expr:
    merged = _size_of_sign(product)
    assert merged is not None, "only products with both factors are replaced"
    rest = list(product.args)
    rest.remove(merged[0])
    rest.remove(merged[1])
    return sympy.Mul(merged[2], *rest)


def _guarded(slope: Expr, e: Expr) -> Expr:
    """Return a derivative whose divisors count as infinite where they vanish, unless e itself is infinite there."""
    divisors = {part for part in slope.atoms(sympy.Pow) if _is_divisor(part)}
    if not divisors:
        return slope
    bounded = {part.base for outer in e.atoms(sympy.exp) for part in outer.exp.atoms(sympy.Pow) if _is_divisor(part)}
    poles = {part.base for part in e.atoms(sympy.Pow) if _is_divisor(part)} - bounded

    guards = {
        p: _guard(*p.args) for p in divisors if p.base not in poles and not p.base.is_number and not p.base.is_positive
    }
    return slope.replace(lambda p: p in guards, guards.__getitem__) if guards else slope


def _guard(base: Expr, exponent: Expr) -> Expr:
    """Return a power with a negative exponent that is 0 where its base is 0, and whose derivatives are 0 there."""
    if exponent in (sympy.S.NegativeOne, -sympy.S.Half):
        return sympy.Pow(functions.Divisor(base), exponent)
    apart = functions.Less(sympy.S.Zero, functions.Abs(base))
    return sympy.Pow(functions.Where(apart, 1 / base, sympy.S.Zero), -exponent)


def _is_divisor(e: Expr) -> bool:
    return e.is_Pow and e.exp.is_number and bool(e.exp.is_negative) and e.base != sympy.E
