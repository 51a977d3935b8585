"""Functions of the expression language that SymPy lacks, or that SymPy would rewrite.

All are real and opaque: SymPy does not rewrite them and evaluates them only with numbers. They define their
derivatives. Those named like SymPy's own (`Abs`, `sign`, `floor`, `Min`, `Max`, `atan2`) print like them, but never
turn into square roots, conjugates, Heaviside or Dirac terms, and are cheap to construct. Their derivatives follow the
rule in derivatives.py: at a kink they are the limit along one direction, at a jump those of the selected branch.
Conditions are the real numbers 1 and 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import sympy
from sympy import Expr, Float, Number, log

from thetascope.engine.language import builtins
from thetascope.engine.language.numerical_functions import Interp
from thetascope.engine.language.real_function import ONE, ZERO, Real


class Less(Real):
    """a < b, as 1 or 0."""

    nargs = (2,)
    compute = staticmethod(lambda a, b: int(a < b))


class LessEqual(Real):
    """a ≤ b, as 1 or 0."""

    nargs = (2,)
    compute = staticmethod(lambda a, b: int(a <= b))


class And_(Real):
    """Conjunction of two conditions, as 1 or 0."""

    nargs = (2,)
    compute = staticmethod(lambda a, b: int(a != 0 and b != 0))


class Or_(Real):
    """Disjunction of two conditions, as 1 or 0."""

    nargs = (2,)
    compute = staticmethod(lambda a, b: int(a != 0 or b != 0))


class Where(Real):
    """a where the condition is not 0, otherwise b. The derivative is that of the selected branch."""

    nargs = (3,)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return the branch if the condition is a number or both branches are equal, else None: unevaluated."""
        condition, a, b = args
        if isinstance(condition, Number):
            return a if condition else b  # not == 0: to SymPy a double 0.0 is not the integer 0
        return a if a == b else None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        condition, a, b = self.args
        return Where(condition, a.diff(symbol), b.diff(symbol))

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative: that of the branch taken."""
        return ZERO if argindex == 1 else Where(self.args[0], *((ONE, ZERO) if argindex == 2 else (ZERO, ONE)))


class Abs(Real):
    """|x|."""

    nargs = (1,)
    is_nonnegative = True
    is_extended_nonnegative = True
    compute = staticmethod(math.fabs)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return |x|^a for |⌊x⌉^a| and |x| for ||x||, the value for a number, else None: unevaluated."""
        inner = args[0]
        if isinstance(inner, Abs):
            return inner
        return Abs(inner.args[0]) ** inner.args[1] if isinstance(inner, SignedPower) else super().eval(*args)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the sign of x; at 0 the one that it has next."""
        return SignNext(self.args[0])


class SignNext(Real):
    """Sign of x; at 0 the sign that x has next along the direction of derivatives.py, which replaces it."""

    nargs = (1,)
    compute = staticmethod(builtins.sign)


class LessNext(Real):
    """a < b, as 1 or 0; where both are equal, whether a is the smaller one next along the direction."""

    nargs = (2,)
    compute = staticmethod(lambda a, b: int(a <= b))


class sign(Real):
    """Sign of x: 1, 0 or −1."""

    nargs = (1,)
    compute = staticmethod(builtins.sign)


class floor(Real):
    """The largest integer ≤ x."""

    nargs = (1,)
    compute = staticmethod(lambda x: float(math.floor(x)))


class Min(Real):
    """The smaller of two numbers."""

    nargs = (2,)
    compute = staticmethod(min)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return 1 for the argument that is the smaller one, else 0."""
        a, b = self.args
        return Where(LessNext(a, b), *((ONE, ZERO) if argindex == 1 else (ZERO, ONE)))

    def _eval_derivative(self, symbol: Expr) -> Expr:
        a, b = self.args
        return Where(LessNext(a, b), a.diff(symbol), b.diff(symbol))


class Max(Real):
    """The larger of two numbers."""

    nargs = (2,)
    compute = staticmethod(max)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return 1 for the argument that is the larger one, else 0."""
        a, b = self.args
        return Where(LessNext(b, a), *((ONE, ZERO) if argindex == 1 else (ZERO, ONE)))

    def _eval_derivative(self, symbol: Expr) -> Expr:
        a, b = self.args
        return Where(LessNext(b, a), a.diff(symbol), b.diff(symbol))


class atan2(Real):
    """Angle of the point (x, y): atan2(y, x)."""

    nargs = (2,)
    compute = staticmethod(math.atan2)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return x / (x² + y²) for y, and −y / (x² + y²) for x; 0 at the origin."""
        y, x = self.args
        return (x if argindex == 1 else -y) / Divisor(x**2 + y**2)


class Divisor(Real):
    """x, or ∞ for x = 0: a quotient by it is 0 where x vanishes."""

    nargs = (1,)
    compute = staticmethod(lambda x: x or math.inf)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return a number that is not 0, else None: unevaluated."""
        return args[0] if isinstance(args[0], Number) and args[0] != 0 else None

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return 1, which holds where x is not 0; at 0 the divisor makes it 0 again."""
        return ONE


class Power(Real):
    """x^a with an exponent that may be below or above 1, while it is differentiated; see derivatives.py."""

    nargs = (2,)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return None: powers are evaluated as SymPy's."""
        return None

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return a x^(a − 1) for x, and x^a log x for a; 0 at x = 0 where the result would be infinite."""
        x, a = self.args
        if argindex == 2:
            return self * log(Max(x, Float(1e-300)))
        steep = And_(And_(LessEqual(x, ZERO), LessEqual(ZERO, x)), Less(a, ONE))
        return a * Where(steep, ZERO, x ** (a - 1))


class SignedPower(Real):
    """⌊x⌉^a = |x|^a sign x, the error term of nonsmooth observers (Shen & Hu 2015, below (10))."""

    nargs = (2,)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return x for a = 1, one power for a power of a power, the value for numbers, else None: unevaluated."""
        x, a = args
        if isinstance(x, SignedPower):
            return SignedPower(x.args[0], x.args[1] * a)
        if x.is_Pow and x.exp.is_Integer and x.exp.is_odd and x.exp.is_positive:
            return SignedPower(x.base, x.exp * a)
        return x if a.is_Number and float(a) == 1 else super().eval(x, a)

    compute = staticmethod(builtins.signed_power)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return a |x|^(a − 1) for x, and ⌊x⌉^a log |x| for a; 0 at x = 0 where the result would be infinite."""
        x, a = self.args
        if argindex == 2:
            return self * log(Max(Abs(x), Float(1e-300)))
        return Power(Abs(x), a).fdiff() if not a.is_number else a * Abs(x) ** (a - 1)


class Backlash(Real):
    """Play operator of Zhou & Tan 2012, (6)–(9): Backlash(x, Δx, z, m1, m2, D1, D2) is z(k).

    In the linear zone its value is m1·(x − D1) (rising, x > z/m1 + D1) or m2·(x + D2) (falling, x < z/m2 − D2); in the
    memory zone z is unchanged. The thresholds use the operator's own z, not the sum v (READING §4).
    """

    nargs = (7,)

    compute = staticmethod(builtins.backlash)

    def zones(self) -> tuple[Expr, Expr]:
        """Return the switching functions g1 (rising) and g2 (falling) of (7), each 1 or 0."""
        x, dx, z, m1, m2, D1, D2 = self.args
        still = Float(builtins.REST) * (Abs(x) + Abs(D1) + Abs(D2))
        return And_(Less(z / m1 + D1, x), Less(still, dx)), And_(Less(x, z / m2 - D2), Less(dx, -still))

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative in the zone that the operator is in: rising, falling or memory."""
        x, _, _, m1, m2, D1, D2 = self.args
        rising, falling = self.zones()
        # for each argument: the derivative in the rising, falling and memory zone
        slopes: Sequence[tuple[Expr, Expr, Expr]] = (
            (m1, m2, ZERO),
            (ZERO, ZERO, ZERO),
            (ZERO, ZERO, ONE),
            (x - D1, ZERO, ZERO),
            (ZERO, x + D2, ZERO),
            (-m1, ZERO, ZERO),
            (ZERO, m2, ZERO),
        )
        up, down, memory = slopes[argindex - 1]
        return Where(rising, up, Where(falling, down, memory))


def in_pairs(pair: type[Real], *args: Expr) -> Expr:
    """Apply a function of two arguments to any number of them, as a balanced tree: a chain would be too deep."""
    half = len(args) // 2
    return args[0] if not half else pair(in_pairs(pair, *args[:half]), in_pairs(pair, *args[half:]))


def _clip(x: Expr, low: Expr, high: Expr) -> Expr:
    return Min(Max(x, low), high)


def _bouc_wen(v: Expr, z: Expr, A: Expr, beta: Expr, gamma: Expr, n: Expr) -> Expr:
    return A * v - beta * Abs(v) * SignedPower(z, n) - gamma * v * Abs(z) ** n


BUILDERS = {
    "sin": sympy.sin,
    "cos": sympy.cos,
    "tan": sympy.tan,
    "asin": sympy.asin,
    "acos": sympy.acos,
    "atan": sympy.atan,
    "atan2": atan2,
    "sinh": sympy.sinh,
    "cosh": sympy.cosh,
    "tanh": sympy.tanh,
    "exp": sympy.exp,
    "log": sympy.log,
    "sqrt": sympy.sqrt,
    "abs": Abs,
    "sign": sign,
    "min": partial(in_pairs, Min),
    "max": partial(in_pairs, Max),
    "clip": _clip,
    "heaviside": lambda x: Where(LessEqual(ZERO, x), ONE, ZERO),
    "step": lambda x: Where(LessEqual(ZERO, x), ONE, ZERO),
    "floor": floor,
    "where": Where,
    "spow": SignedPower,
    "backlash": Backlash,
    "deadzone": lambda x, d: x - _clip(x, -d, d),
    "play": lambda x, z, d: _clip(z, x - d, x + d),
    "satplay": lambda x, z, d, limit: _clip(_clip(z, x - d, x + d), -limit, limit),
    "boucwen": _bouc_wen,
    "interp": lambda x, table: Interp(x, table, ZERO),
}
"""Constructor of the SymPy expression for each function of the language."""
