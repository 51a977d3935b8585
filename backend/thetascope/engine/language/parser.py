"""Parser of the expression language: a whitelist over Python's `ast`. User text is never evaluated as code.

The language: numbers, declared names, `pi`, + - * / ** ^ (both are powers), parentheses, the functions of
builtins.py, and inside `where(condition, a, b)` the comparisons < <= > >= joined by `and`, `or`.

There are three steps, and each reports errors with their position in the text: the characters and their order
(lexer.py), the tree of Python's parser, of which only arithmetic is accepted (this file), and the SymPy expression
(to_sympy.py). Parsing does not need SymPy. Constants are folded in double precision while parsing, which bounds their
size.
"""

import ast
import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, NoReturn

from thetascope.engine.errors import ExpressionError, SpecError
from thetascope.engine.language.builtins import FUNCTIONS
from thetascope.engine.language.lexer import MAX_DEPTH, MAX_LENGTH, MAX_TOKENS, SPLIT, Scanner, Token
from thetascope.engine.language.syntax_tree import Node, exact_of, value_of
from thetascope.engine.language.tables import Table
from thetascope.messages import Message

if TYPE_CHECKING:
    import sympy

__all__ = ["FUNCTIONS", "MAX_DEPTH", "MAX_EXPONENT", "MAX_LENGTH", "MAX_TOKENS", "Node", "Parsed", "parse"]

MAX_EXPONENT = 64
SYMBOLIC_POWER = 8  # contribution of a non-constant exponent to the degree


@dataclass(frozen=True)
class Parsed:
    """A checked expression: its text, the names that it uses in order of appearance, and its tree."""

    text: str
    field: str
    names: tuple[str, ...]
    tree: Node

    @property
    def degree(self) -> int:
        """Return the bound on accumulated powers, 1 to 64. If the expression gets a name, pass it on in `degrees`."""
        return self.tree.degree

    def sympy(self, symbols: Mapping[str, "sympy.Symbol"], tables: Mapping[str, Table] | None = None) -> "sympy.Expr":
        """Return the SymPy expression: Add, Mul, Pow, SymPy's elementary functions and those of sympy_functions.py.

        Args:
            symbols: a real symbol for each of `names`.
            tables: the tables in which it may interpolate, by name.

        Raises:
            ExpressionError: if a divisor cancels to zero, or the result is not real.
            KeyError, TypeError: if a symbol is missing or not real (an error of the caller, not of the text).
        """
        from thetascope.engine.language.to_sympy import to_sympy

        return to_sympy(self, symbols, tables or {})


def parse(
    text: str,
    names: Iterable[str],
    field: str = "expression",
    degrees: Mapping[str, int] | None = None,
    tables: Iterable[str] = (),
    condition: bool = False,
) -> Parsed:
    """Return the checked expression of a text.

    Args:
        text: the expression.
        names: the names that it may use, `t` included where time is allowed.
        field: path of the field, for error messages.
        degrees: `Parsed.degree` of each name for which an expression will be substituted.
        tables: the names of the tables in which it may interpolate.
        condition: the text is a condition, as the first argument of `where`.

    Raises:
        ExpressionError: with the position, the problem and the remedy.
    """
    if not isinstance(text, str):
        raise SpecError(field, text, Message("expression.no-text"))
    known = frozenset(tables)
    tokens = Scanner(text, frozenset(names), FUNCTIONS, field, known).tokens()
    reader = _Reader(text, field, degrees or {}, known)
    tree = reader.read(tokens, condition)
    used = dict.fromkeys(token.text for token in tokens if token.kind == "name" and token.text != "pi")
    return Parsed(text, field, tuple(used), tree)


def sides(equation: str) -> tuple[str, str]:
    """Return the left and the right side of an equation, each at its place in the text; without =, "" on the right."""
    place = re.search(r"(?<![<>=!])=(?!=)", equation)
    if place is None:
        return equation, ""
    return equation[: place.start()], " " * place.end() + equation[place.end() :]


class _Reader:
    """Converter from Python's tree to Nodes. It limits size and depth, and folds constants."""

    def __init__(self, text: str, field: str, degrees: Mapping[str, int], tables: frozenset[str]) -> None:
        self.text, self.field, self.degrees, self.tables = text, field, degrees, tables
        self.names: dict[str, str] = {}  # name of a quantity or table by the name that Python's parser reads
        self.starts: list[int] = []  # position in the text of each character that is passed to Python's parser
        self.ends: list[int] = []

    def read(self, tokens: list[Token], condition: bool = False) -> Node:
        """Return the tree of the tokens, a number or a condition. Raises ExpressionError."""
        pieces = []
        for token in tokens:
            piece = ("**" if token.text == "^" else token.text) + " "
            if token.kind in ("name", "table") and token.text != "pi":  # ASCII, because Python counts bytes
                piece = f"q{len(self.names)} "
                self.names[piece.strip()] = token.text
            pieces.append(piece)
            self.starts += [token.start] * len(piece)
            self.ends += [token.end] * len(piece)
        try:
            tree = ast.parse("".join(pieces), mode="eval").body
        except SyntaxError as error:  # the scanner is expected to reject all of these first
            column = min(max((error.offset or 1) - 1, 0), len(self.starts) - 1)
            start, end = self.starts[column], self.ends[column]
            problem, remedy = Message("expression.syntax"), None
        except (ValueError, MemoryError, RecursionError, OverflowError):
            start, end, problem, remedy = 0, len(self.text), Message("expression.deep"), SPLIT
        else:
            return self.condition(tree, 0) if condition else self.number(tree, 0)
        raise ExpressionError(self.field, self.text, start, end, problem, remedy)

    def place(self, node: ast.expr) -> tuple[int, int]:
        """Return the range of a node in the text, as half-open character positions."""
        return self.starts[node.col_offset], self.ends[(node.end_col_offset or node.col_offset + 1) - 1]

    def refuse(self, node: ast.expr | Node, problem: Message, remedy: Message | None = None) -> NoReturn:
        """Raise ExpressionError for the text of a node."""
        start, end = (node.start, node.end) if isinstance(node, Node) else self.place(node)
        raise ExpressionError(self.field, self.text, start, end, problem, remedy)

    def check_depth(self, node: ast.expr, depth: int) -> None:
        if depth > MAX_DEPTH:
            self.refuse(node, Message("expression.operations.deep", most=MAX_DEPTH), SPLIT)

    def number(self, node: ast.expr, depth: int) -> Node:
        """Return the tree of a real-valued node."""
        self.check_depth(node, depth)
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                exact = Fraction(value) if isinstance(value, int) else None
                return Node("number", (), *self.place(node), value=float(value), exact=exact)
            case ast.Name(id="pi"):
                return Node("number", (), *self.place(node), value=math.pi)
            case ast.Name(id=alias):
                name = self.names[alias]
                if name in self.tables:
                    self.refuse(node, Message("expression.table.alone", name=name))
                return Node("name", (), *self.place(node), name=name, degree=self.degrees.get(name, 1))
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
                signs = (-1,) if isinstance(sign, ast.USub) else (1,)
                return self.folded(Node("sum", (self.number(operand, depth + 1),), *self.place(node), signs=signs))
            case ast.BinOp(op=ast.Pow()):
                return self.power(node, depth)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                return self.chain("sum", (ast.Add, ast.Sub), node, depth)
            case ast.BinOp(op=ast.Mult() | ast.Div()):
                return self.chain("product", (ast.Mult, ast.Div), node, depth)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
                return self.call(node, name, args, depth)
            case ast.Compare() | ast.BoolOp():
                self.refuse(node, Message("expression.condition"))
            case ast.Tuple():
                self.refuse(node, Message("expression.list"))
        return self.refuse(node, Message("expression.no-arithmetic"))

    def chain(self, kind: str, operators: tuple[type, type], node: ast.expr, depth: int) -> Node:
        """Return a + b − c … or a·b/c … as one node, so that a long sum is not deep."""
        place, parts = self.place(node), []
        while isinstance(node, ast.BinOp) and isinstance(node.op, operators):
            parts.append((1 if isinstance(node.op, operators[0]) else -1, node.right))
            node = node.left
        parts.append((1, node))
        parts.reverse()
        args = tuple(self.number(part, depth + 1) for _, part in parts)
        signs = tuple(sign for sign, _ in parts)
        if kind == "product":
            for sign, arg in zip(signs, args, strict=True):
                if sign < 0 and arg.value == 0:
                    self.refuse(arg, Message("expression.zero-constant"))
        return self.folded(Node(kind, args, *place, signs=signs))

    def power(self, node: ast.BinOp, depth: int) -> Node:
        """Return the tree of a power. Refuses exponents and accumulated degrees above MAX_EXPONENT."""
        base, exponent = self.number(node.left, depth + 1), self.number(node.right, depth + 1)
        if exponent.value is None:
            if base.value is not None and base.value <= 0:
                self.refuse(base, Message("expression.power.base"))
            factor = SYMBOLIC_POWER
        else:
            if abs(exponent.value) > MAX_EXPONENT:
                self.refuse(exponent, Message("expression.power.exponent", exponent=exponent.value, most=MAX_EXPONENT))
            if base.value == 0 and exponent.value < 0:
                self.refuse(base, Message("expression.zero-constant"))
            factor = max(1, math.ceil(abs(exponent.value)))
        degree = base.degree * factor if base.value is None else max(base.degree, exponent.degree)
        if degree > MAX_EXPONENT:
            self.refuse(exponent, Message("expression.power.degree", degree=degree, most=MAX_EXPONENT))
        return self.folded(Node("power", (base, exponent), *self.place(node), degree=max(degree, exponent.degree)))

    def call(self, node: ast.Call, name: str, args: list[ast.expr], depth: int) -> Node:
        """Return the tree of a function call. Refuses a wrong number of arguments."""
        function = FUNCTIONS[name]
        if len(args) < function.least or (function.most is not None and len(args) > function.most):
            code = "expression.arguments" if function.most == function.least else "expression.arguments.least"
            self.refuse(node, Message(code, name=name, n=function.least, given=len(args)))
        read = [self.reader(name, index) for index in range(len(args))]
        nodes = tuple(reader(arg, depth + 1) for reader, arg in zip(read, args, strict=True))
        return self.folded(Node("call", nodes, *self.place(node), name=name))

    def reader(self, function: str, index: int) -> Callable[[ast.expr, int], Node]:
        """Return the method that reads an argument of a function."""
        special = {("where", 0): self.condition, ("interp", 1): self.table}
        return special.get((function, index), self.number)

    def table(self, node: ast.expr, depth: int) -> Node:
        """Return the node of a table, the second argument of `interp`."""
        name = self.names.get(node.id, "") if isinstance(node, ast.Name) else ""
        if name not in self.tables:
            known = sorted(self.tables)
            remedy = Message("suggest.all", names=known) if known else Message("expression.table.none")
            self.refuse(node, Message("expression.table.needed"), remedy)
        return Node("table", (), *self.place(node), name=name)

    def condition(self, node: ast.expr, depth: int) -> Node:
        """Return the tree of a condition, the first argument of `where`."""
        self.check_depth(node, depth)
        match node:
            case ast.BoolOp(op=operator, values=values):
                kind = "and" if isinstance(operator, ast.And) else "or"
                return self.folded(Node(kind, tuple(self.condition(v, depth + 1) for v in values), *self.place(node)))
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                args = (self.number(left, depth + 1), self.number(right, depth + 1))
                if isinstance(operator, ast.Gt | ast.GtE):
                    args = args[::-1]
                kind = "less" if isinstance(operator, ast.Lt | ast.Gt) else "less_equal"
                return self.folded(Node(kind, args, *self.place(node)))
            case ast.Compare():
                self.refuse(node, Message("expression.comparison"))
        return self.refuse(node, Message("expression.no-condition"))

    def folded(self, node: Node) -> Node:
        """Return the node with its degree, and with its value if all its arguments are constants."""
        degree = max([node.degree, *(arg.degree for arg in node.args)])
        if any(arg.value is None for arg in node.args):
            return replace(node, degree=degree)
        try:
            value = float(value_of(node))
        except (ArithmeticError, ValueError):
            value = math.nan
        if not math.isfinite(value):
            self.refuse(node, Message("expression.constant.not-real"))
        return replace(node, value=value, exact=exact_of(node), degree=1)
