"""SymPy expressions → expression graph. The only module that knows both."""

from __future__ import annotations

from collections.abc import Mapping, Set
from functools import reduce

from thetascope.engine.compiler.graph import LEAVES, UNARY_FUNCTIONS, Graph
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
}


class Ranks:
    """The rank of each node: that of the highest of its variables; a constant has −1, a name without a rank 0."""

    def __init__(self, graph: Graph, names: Mapping[str, int]):
        self.graph, self.names = graph, names
        self.found: list[int] = []

    def __call__(self, i: int) -> int:
        """Return the rank of a node: the highest of the variables in it."""
        for op, *args in self.graph.nodes[len(self.found) :]:
            if op in LEAVES:
                self.found.append(-1 if op == "const" else self.names.get(args[0], 0))
            else:
                self.found.append(max(self.found[a] for a in args))
        return self.found[i]


class Lowering:
    """Lowers expressions into one graph. Names that are neither known nor defined are refused.

    Sums and products are formed from the lowest rank to the highest. With ranks by how widely a quantity is shared
    (parameters, inputs, Υ and Γ, estimates, y) what is fixed is found once and not in every step, a batch finds once
    what its runs have in common, and the innovation, which is known last, comes last.
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
        """Let a symbol stand for an expression from now on."""
        self.memo[symbol] = self(expression)

    def __call__(self, expression: sympy.Expr) -> int:
        """Return the node of an expression; equal expressions have one node."""
        expression = sympy.sympify(expression)
        found = self.memo.get(expression)
        if found is None:
            found = self.memo[expression] = self._lower(expression)
        return found

    def _lower(self, e: sympy.Expr) -> int:
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
        # a leading positive term lets later negative ones be subtractions
        terms = [self(a) for a in sorted(e.args, key=lambda a: a.could_extract_minus_sign())]
        return reduce(self.graph.add, sorted(terms, key=self.rank))

    def _multiply(self, factors: list[int]) -> int:
        return reduce(self.graph.mul, sorted(factors, key=self.rank), self.graph.const(1.0))

    def _product(self, e: sympy.Mul) -> int:
        above = [a for a in e.args if not _is_reciprocal(a)]
        below = [1 / a for a in e.args if _is_reciprocal(a)]
        # 1/parameter is the same in every step: found once, and a product is much quicker than a division
        fixed = [b for b in below if b.free_symbols and {s.name for s in b.free_symbols} <= self.parameters]
        below = [b for b in below if b not in fixed]
        factors = [self(a) for a in above]
        if fixed:
            factors.append(self.graph.div(self.graph.const(1.0), self._multiply([self(b) for b in fixed])))
        top = self._multiply(factors)
        return self.graph.div(top, self._multiply([self(b) for b in below])) if below else top

    def _power(self, e: sympy.Pow) -> int:
        if e.base == sympy.E:
            return self.graph.call("exp", self(e.exp))
        if e.exp.is_Number:
            return self.graph.power(self(e.base), float(e.exp))
        return self.graph.call("pow", self(e.base), self(e.exp))

    def _function(self, e: sympy.Function) -> int:
        name = e.func.__name__
        args = [self(a) for a in e.args]
        if name in ("Min", "Max"):
            return reduce(lambda a, b: self.graph.call(name.lower(), a, b), args)
        if name == "Backlash":
            return self._backlash(*args)
        if name not in _BY_NAME:
            raise ValueError(f"{name} is not one of the functions the engine computes")
        return self.graph.call(_BY_NAME[name], *args)

    def _backlash(self, x: int, dx: int, z: int, m1: int, m2: int, d1: int, d2: int) -> int:
        """One backlash operator, Zhou & Tan (6)–(9): follows m1·(x − D1) rising, m2·(x + D2) falling, else keeps z."""
        g, zero = self.graph, self.graph.const(0.0)
        rising = g.call("and", g.call("lt", g.add(g.div(z, m1), d1), x), g.call("lt", zero, dx))
        falling = g.call("and", g.call("lt", x, g.sub(g.div(z, m2), d2)), g.call("lt", dx, zero))
        inner = g.call("where", falling, g.mul(m2, g.add(x, d2)), z)
        return g.call("where", rising, g.mul(m1, g.sub(x, d1)), inner)


def _is_reciprocal(e: sympy.Expr) -> bool:
    return e.is_Pow and e.exp.is_number and bool(e.exp.is_negative) and e.base != sympy.E
