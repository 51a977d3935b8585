"""Lowering of SymPy expressions to the expression graph. No other module depends on both."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from functools import reduce

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.composite import interpolate
from thetascope.engine.compiler.graph import LEAVES, UNARY_FUNCTIONS, Graph, evaluate
from thetascope.engine.language.builtins import REST
from thetascope.engine.language.lazy_sympy import sympy

_BY_NAME = {name: name for name in UNARY_FUNCTIONS} | {
    "Abs": "abs",
    "sign": "sign",
    "atan2": "atan2",
    "Less": "lt",
    "LessEqual": "le",
    "And_": "and",
    "Or_": "or",
    "Where": "where",
    "SignedPower": "spow",
    "SignNext": "sign",
    "LessNext": "le",
}


class Ranks:
    """Rank of each node: the highest rank among its variables; −1 for a constant, 0 for a name without a rank."""

    def __init__(self, graph: Graph, names: Mapping[str, int]):
        self.graph, self.names = graph, names
        self.ranks: list[int] = []

    def __call__(self, i: int) -> int:
        """Return the rank of a node."""
        for op, *args in self.graph.nodes[len(self.ranks) :]:
            if op in LEAVES:
                self.ranks.append(self.names.get(args[0], 0) if op == "var" else -1)
            else:
                self.ranks.append(max(self.ranks[a] for a in args))
        return self.ranks[i]


class Lowering:
    """Lowering of expressions into one graph. Raises ValueError for a name that is neither known nor defined.

    Sums and products are formed from the lowest rank to the highest. Ranks follow how widely a quantity is shared
    (parameters, inputs, Υ and Γ, estimates, y). So fixed values are computed once and not in every step, a batch
    computes values common to its runs once, and the innovation, which depends on all others, comes last.
    """

    def __init__(
        self,
        graph: Graph,
        known: Set[str],
        parameters: Set[str] = frozenset(),
        ranks: Mapping[str, int] | None = None,
    ):
        self.graph = graph
        self.known = known
        self.parameters = parameters
        self.rank = Ranks(graph, ranks or {})
        self.memo: dict[sympy.Basic, int] = {}

    def define(self, symbol: sympy.Symbol, expression: sympy.Expr) -> None:
        """Define a symbol as an abbreviation of an expression, for all later expressions."""
        self.memo[symbol] = self(expression)

    def __call__(self, expression: sympy.Expr) -> int:
        """Return the node of an expression."""
        expression = sympy.sympify(expression)
        node = self.memo.get(expression)
        if node is None:
            node = self.memo[expression] = self._lower(expression)
        return node

    def _lower(self, e: sympy.Expr) -> int:
        """Return the node of an expression that has not been lowered yet."""
        g = self.graph
        if e.is_Symbol:
            if e.name not in self.known:
                raise ValueError(f"the symbol {e.name!r} is used but is no state, input, parameter or definition")
            return g.var(e.name)
        if e.is_Number or e.is_NumberSymbol:
            return g.const(float(e))
        if e.is_Add:
            return self._sum(e)
        if e.is_Mul:
            return self._product(e)
        if e.is_Pow:
            return self._power(e)
        return self._function(e)

    def _sum(self, e: sympy.Add) -> int:
        """Return the node of a sum, terms in the order of their ranks."""
        # positive terms first, so that negative ones become subtractions
        terms = [self(a) for a in sorted(e.args, key=lambda a: a.could_extract_minus_sign())]
        return reduce(self.graph.add, sorted(terms, key=self.rank))

    def _multiply(self, factors: list[int]) -> int:
        return reduce(self.graph.mul, sorted(factors, key=self.rank), self.graph.const(1.0))

    def _product(self, e: sympy.Mul) -> int:
        """Return the node of a product as one quotient, factors in the order of their ranks."""
        numerator = [a for a in e.args if not _is_reciprocal(a)]
        denominator = [1 / a for a in e.args if _is_reciprocal(a)]
        # 1/parameter is the same in every step: it is computed once, and a product is much faster than a division
        fixed = [b for b in denominator if b.free_symbols and {s.name for s in b.free_symbols} <= self.parameters]
        denominator = [b for b in denominator if b not in fixed]
        factors = [self(a) for a in numerator]
        if fixed:
            factors.append(self.graph.div(self.graph.const(1.0), self._multiply([self(b) for b in fixed])))
        top = self._multiply(factors)
        return self.graph.div(top, self._multiply([self(b) for b in denominator])) if denominator else top

    def _power(self, e: sympy.Pow) -> int:
        """Return the node of a power; a power of e is an exponential."""
        if e.base == sympy.E:
            return self.graph.call("exp", self(e.exp))
        if e.exp.is_Number:
            return self.graph.power(self(e.base), float(e.exp))
        return self.graph.call("pow", self(e.base), self(e.exp))

    def _function(self, e: sympy.Function) -> int:
        """Return the node of a function. Raises ValueError if the engine does not have it."""
        name = e.func.__name__
        if name == "Interp":
            return interpolate(self.graph, self(e.args[0]), e.args[1].table, below=bool(e.args[2]))
        if name == "Solution":
            return self._solution(e)
        args = [self(a) for a in e.args]
        if name in ("Min", "Max"):
            return reduce(lambda a, b: self.graph.call(name.lower(), a, b), args)
        if name == "Backlash":
            return self._backlash(*args)
        if name == "Divisor":
            g, (x,) = self.graph, args
            return g.call("where", g.call("lt", g.const(0.0), g.call("abs", x)), x, g.const(math.inf))
        if name not in _BY_NAME:
            raise ValueError(f"{name} is not a function of the engine")
        return self.graph.call(_BY_NAME[name], *args)

    def _solution(self, e: sympy.Function) -> int:
        """Return the node of a root of equations, or of a derivative of it."""
        problem, j, order, *given = e.args
        apart = Graph()
        leaf, numbers = apart.raw("problem", problem.text), [apart.var(f"a.{k}") for k in range(len(given))]
        node = apart.raw("root", apart.raw("solve", leaf, *numbers), apart.const(int(j)))
        for k in order:
            node = derivatives(apart, [node], [f"a.{k}"])[0].get(f"a.{k}", apart.const(0.0))
        return self.graph.absorb(apart, [node], {f"a.{k}": self(a) for k, a in enumerate(given)})[node]

    def _backlash(self, x: int, dx: int, z: int, m1: int, m2: int, d1: int, d2: int) -> int:
        """Return the backlash operator of Zhou & Tan (6)–(9): m1·(x − D1) rising, m2·(x + D2) falling, otherwise z."""
        g = self.graph
        size = g.add(g.call("abs", x), g.add(g.call("abs", d1), g.call("abs", d2)))
        still = g.mul(g.const(REST), size)
        rising = g.call("and", g.call("lt", g.add(g.div(z, m1), d1), x), g.call("lt", still, dx))
        falling = g.call("and", g.call("lt", x, g.sub(g.div(z, m2), d2)), g.call("lt", dx, g.neg(still)))
        inner = g.call("where", falling, g.mul(m2, g.add(x, d2)), z)
        return g.call("where", rising, g.mul(m1, g.sub(x, d1)), inner)


def _is_reciprocal(e: sympy.Expr) -> bool:
    return e.is_Pow and e.exp.is_number and bool(e.exp.is_negative) and e.base != sympy.E


def numbers(
    expressions: Iterable[sympy.Expr],
    values: Mapping[str, float | np.ndarray],
    definitions: Iterable[tuple[sympy.Symbol, sympy.Expr]] = (),
) -> np.ndarray:
    """Return the values of expressions at a point, one each; at several points, one row each.

    Args:
        expressions: SymPy expressions, for example the entries of a matrix row by row.
        values: the value of each free symbol by name; for several points its values, all of the same shape.
        definitions: intermediate results that the expressions may use, in order.

    Raises ValueError for a symbol that has neither a value nor a definition.
    """
    lowering = Lowering(Graph(), set(values))
    for symbol, expression in definitions:
        lowering.define(symbol, expression)
    roots = [lowering(e) for e in expressions]
    shape = np.broadcast_shapes(*(np.shape(v) for v in values.values()))
    return np.array([np.broadcast_to(v, shape) for v in evaluate(lowering.graph, roots, values)], dtype=float)
