"""Functions in SymPy that are given by numbers: tables, and the roots of equations."""

from __future__ import annotations

import sympy
from sympy import Expr, Float, Integer, Number

from thetascope.engine.language.real_function import ZERO, Real
from thetascope.engine.language.tables import Table, jumps


class TableAtom(sympy.AtomicExpr):
    """A table as an argument of `Interp`."""

    is_real = True
    is_extended_real = True
    is_commutative = True

    def __new__(cls, table: Table) -> TableAtom:
        """Return the atom of a table."""
        atom = super().__new__(cls)
        atom.table = table
        return atom

    def _hashable_content(self) -> tuple:
        return (self.table.digest,)

    def __getnewargs__(self) -> tuple:
        return (self.table,)

    def _sympystr(self, printer: object) -> str:
        return self.table.name

    def _latex(self, printer: object) -> str:
        return self.table.name

    def sort_key(self, order: str | None = None) -> tuple:
        """Return a key by which SymPy orders terms: equal tables have equal ones."""
        return self.class_key(), (1, (self.table.digest,)), sympy.S.One.sort_key(), sympy.S.One


class Interp(Real):
    """Value of a table at x: Interp(x, table, side), at a point of its grid that above it (side 0) or below it (1)."""

    nargs = (3,)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return the value for a number, 0 for a table of zeros, else None: unevaluated."""
        x, atom, side = args
        if atom.table.is_zero:
            return ZERO
        return Float(atom.table.value(float(x), below=bool(side))) if isinstance(x, Number) else None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        inner = self.args[0].diff(symbol)
        return ZERO if inner == 0 else self.fdiff() * inner

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the slope at x; where it jumps, that of the side on which x is next."""
        x, atom, side = self.args
        slope = atom.table.slope()
        return InterpNext(x, TableAtom(slope)) if jumps(slope.pieces) else Interp(x, TableAtom(slope), side)


class InterpNext(Real):
    """Value of a table with jumps at x, on the side that x has next along the direction of derivatives.py."""

    nargs = (2,)

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return the value for a number, else None: unevaluated."""
        return Interp(args[0], args[1], ZERO) if isinstance(args[0], Number) else None


class ProblemAtom(sympy.AtomicExpr):
    """Equations as an argument of `Solution`: their text, and the names of the unknowns."""

    is_real = True
    is_extended_real = True
    is_commutative = True

    def __new__(cls, text: str, names: tuple[str, ...]) -> ProblemAtom:
        """Return the atom of equations."""
        atom = super().__new__(cls)
        atom.text, atom.names = text, names
        return atom

    def _hashable_content(self) -> tuple:
        return (self.text,)

    def __getnewargs__(self) -> tuple:
        return self.text, self.names

    def _sympystr(self, printer: object) -> str:
        return ", ".join(self.names)

    def sort_key(self, order: str | None = None) -> tuple:
        """Return a key by which SymPy orders terms."""
        return self.class_key(), (1, (self.text,)), sympy.S.One.sort_key(), sympy.S.One


class Solution(Real):
    """A root of equations, or a derivative of it: Solution(equations, j, (i, …), a, …) is ∂…z_j/∂a_i… at numbers a."""

    @classmethod
    def eval(cls, *args: Expr) -> Expr | None:
        """Return None: roots are computed numerically only."""
        return None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        parts = [(i, a.diff(symbol)) for i, a in enumerate(self.args[3:])]
        return sympy.Add(*(self.fdiff(4 + i) * slope for i, slope in parts if slope != 0))

    def fdiff(self, argindex: int = 4) -> Expr:
        """Return the derivative with respect to an argument, by number; the first three are no numbers."""
        problem, j, order, *given = self.args
        together = sorted([*order, argindex - 4])
        return Solution(problem, j, sympy.Tuple(*map(Integer, together)), *given)

    def _sympystr(self, printer: object) -> str:
        problem, j, order, *_ = self.args
        return problem.names[int(j)] + "'" * len(order)
