"""Conversion of a checked expression tree to SymPy."""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import NoReturn, Protocol

import sympy
from sympy import Add, Expr, Float, Integer, Mul, Number, Pow, Rational, S, Symbol

from thetascope.engine.errors import ExpressionError
from thetascope.engine.language.derivatives import real
from thetascope.engine.language.lexer import SPLIT
from thetascope.engine.language.numerical_functions import TableAtom
from thetascope.engine.language.sympy_functions import BUILDERS, And_, Less, LessEqual, Or_, in_pairs
from thetascope.engine.language.syntax_tree import Node
from thetascope.engine.language.tables import Table
from thetascope.messages import Message

_NOT_REAL = (S.NaN, S.ComplexInfinity, S.Infinity, S.NegativeInfinity, S.ImaginaryUnit)
_CONDITIONS = {"less": Less, "less_equal": LessEqual, "and": And_, "or": Or_}
_MAX_INTEGER = 64  # in an exponent: SymPy computes integer powers of numbers in full, whatever their size


class Parsed(Protocol):
    """A checked expression, as the parser returns it."""

    @property
    def text(self) -> str:
        """Return the text of the expression."""
        ...

    @property
    def field(self) -> str:
        """Return the path of its field."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names that it uses."""
        ...

    @property
    def tree(self) -> Node:
        """Return its tree."""
        ...


def to_sympy(parsed: Parsed, symbols: Mapping[str, Symbol], tables: Mapping[str, Table]) -> Expr:
    """Return the SymPy expression of a checked expression; see `Parsed.sympy` for arguments and errors."""
    for name in parsed.names:
        if not symbols[name].is_extended_real:
            raise TypeError(f"the symbol {name} must be declared with real=True")
    builder = _Builder(parsed, symbols, tables)
    try:
        result = builder.build(parsed.tree)
    except (RecursionError, OverflowError, ValueError, ZeroDivisionError) as error:
        raise builder.error(parsed.tree, Message("expression.involved"), SPLIT) from error
    result = real(result)
    if not all(_is_double(number) for number in result.atoms(Number)):
        builder.refuse(parsed.tree, Message("expression.double"))
    return result


def _is_double(number: Number) -> bool:
    """Return whether a number, or both numerator and denominator of a rational, fit in double precision."""
    if isinstance(number, Rational):
        return max(number.p.bit_length(), number.q.bit_length()) < 1024
    return math.isfinite(float(number))


def _takes_log(node: Node) -> bool:
    """Return whether a tree contains a logarithm."""
    return node.name == "log" and node.kind == "call" or any(_takes_log(arg) for arg in node.args)


class _Builder:
    def __init__(self, parsed: Parsed, symbols: Mapping[str, Symbol], tables: Mapping[str, Table]) -> None:
        self.parsed, self.symbols, self.tables = parsed, symbols, tables
        self.exponents = 0  # number of exponents around the current node

    def error(self, node: Node, problem: Message, remedy: Message | None = None) -> ExpressionError:
        """Return the error for the text of a node."""
        return ExpressionError(self.parsed.field, self.parsed.text, node.start, node.end, problem, remedy)

    def refuse(self, node: Node, problem: Message) -> NoReturn:
        """Raise the error for the text of a node."""
        raise self.error(node, problem)

    def build(self, node: Node) -> Expr:
        """Return the SymPy expression of a node. Raises ExpressionError if it is not real."""
        if node.value is not None and node.kind in _CONDITIONS:
            return Integer(node.value)
        if node.value is not None:
            return self.constant(node)
        if node.kind == "name":
            return self.symbols[node.name]
        if node.kind == "table":
            return TableAtom(self.tables[node.name])
        if node.kind in _CONDITIONS:
            return in_pairs(_CONDITIONS[node.kind], *(self.build(arg) for arg in node.args))
        result = getattr(self, node.kind)(node)
        if result.has(*_NOT_REAL):
            self.refuse(node, Message("expression.not-real"))
        return result

    def constant(self, node: Node) -> Expr:
        """Return a constant: integers and small fractions exactly, others, and all within exponents, as doubles."""
        if node.exact is not None and not self.exponents:
            return Rational(node.exact.numerator, node.exact.denominator)
        return Float(node.value)

    def sum(self, node: Node) -> Expr:
        return Add(*(self.build(arg) if sign > 0 else -self.build(arg) for sign, arg in self.signed(node)))

    def product(self, node: Node) -> Expr:
        return Mul(*(self.build(arg) if sign > 0 else self.reciprocal(arg) for sign, arg in self.signed(node)))

    @staticmethod
    def signed(node: Node) -> "zip[tuple[int, Node]]":
        return zip(node.signs, node.args, strict=True)

    def reciprocal(self, node: Node) -> Expr:
        """Return 1/node. Refuses a divisor that cancels to zero."""
        divisor = self.build(node)
        if divisor.is_Number and not divisor:
            self.refuse(node, Message("expression.zero-cancelled"))
        return Pow(divisor, -1)

    def power(self, node: Node) -> Expr:
        """Return a power. Refuses a negative power of a base that cancels to zero."""
        base, exponent = node.args
        if exponent.value is not None:
            built = self.build(base)
            if built.is_Number and not built and exponent.value < 0:
                self.refuse(base, Message("expression.zero-cancelled"))
            return Pow(built, self.exponent(exponent))
        return Pow(self.build(base), self.inexact(exponent))

    @staticmethod
    def exponent(node: Node) -> Expr:
        """Return a constant exponent: integers, halves and fractions exactly, so that x^0.5 is the square root."""
        if node.exact is not None:
            return Rational(node.exact.numerator, node.exact.denominator)
        assert node.value is not None, "only constants have a value"
        half = Fraction(node.value)
        return Rational(half.numerator, half.denominator) if half.denominator <= 2 else Float(node.value)

    def inexact(self, node: Node) -> Expr:
        """Return the expression of an exponent, with doubles for all constants.

        With integers SymPy would compute powers in full once other exponents cancel: (3*x)^(y + 1e9)*(3*x)^(-y).
        """
        self.exponents += 1
        result = self.build(node)
        self.exponents -= 1
        if any(abs(n.p) > _MAX_INTEGER or n.q > _MAX_INTEGER for n in result.atoms(Rational)):
            self.refuse(node, Message("expression.power.integers"))
        return result

    def call(self, node: Node) -> Expr:
        if node.name == "exp":
            # SymPy turns exp(n*log(x)) into x^n
            return sympy.exp((self.inexact if _takes_log(node) else self.build)(node.args[0]))
        return BUILDERS[node.name](*(self.build(arg) for arg in node.args))
