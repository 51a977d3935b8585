"""The base of this project's real functions in SymPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import sympy
from sympy import Expr, Float, Function, Integer, Number

ZERO, ONE = Integer(0), Integer(1)


class Real(Function):
    """Base of the real functions; `compute` evaluates them, with numbers only."""

    is_real = True
    is_extended_real = True
    is_commutative = True
    compute: ClassVar[Callable[..., float]]
    """Evaluation with floats; raises ValueError or ArithmeticError outside the domain."""

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return the value if all arguments are numbers, NaN outside the domain, else None: unevaluated."""
        if not all(isinstance(arg, Number) for arg in args):
            return None
        try:
            value = cls.compute(*(float(arg) for arg in args))
        except (ArithmeticError, ValueError):
            return sympy.nan
        return Integer(value) if isinstance(value, int) else Float(value)

    @classmethod
    def _should_evalf(cls, arg: Expr) -> int:
        """Return −1: a double among the arguments does not start SymPy's search for a numerical routine."""
        return -1

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative with respect to an argument; 0 unless a subclass overrides it (piecewise constant)."""
        return ZERO
