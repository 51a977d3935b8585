"""Automatic differentiation of a program's graph in forward mode, without SymPy.

It differentiates the program itself, including saturations and branches. The derivative is finite wherever the function
has one, by the rule of engine/language/derivatives.py: at a kink it is the limit along one direction, in which all
named variables fall; where a tangent is vertical the slope counts as 0.
"""

import math
import zlib
from collections.abc import Callable, Iterable, Sequence

from thetascope.engine.compiler.composite import piece_slope, root_slopes
from thetascope.engine.compiler.graph import LEAVES, Graph, topological

Tangent = dict[str, int]  # variable → node of the derivative with respect to it; zeros are left out

_STEEPEST = 1e-6  # lower limit of |x| in the slope of spow(x, a) for a < 1, the injection of nonsmooth observers


_FEW = 2  # variables of a quantity up to which its kinks are resolved where both branches are equal


def derivatives(graph: Graph, roots: Sequence[int], names: Iterable[str]) -> list[Tangent]:
    """Return the partial derivatives of each root with respect to the named variables, as nodes added to the graph."""
    return _Forward(graph, set(names)).of(roots)


class _Forward:
    """The tangents of the nodes of a graph with respect to the named variables."""

    def __init__(self, graph: Graph, names: set[str]):
        self.graph, self.names = graph, names
        self.tangents: dict[int, Tangent] = {}
        self.roots: dict[int, list[Tangent]] = {}  # derivatives of the roots of each `solve` node
        self.poles: set[int] = set()  # nodes whose derivative may be infinite while exp of them is smooth

    def of(self, roots: Sequence[int]) -> list[Tangent]:
        """Return the tangents of the roots."""
        graph = self.graph
        for i in list(topological(graph, roots)):
            op, *args = graph.nodes[i]
            if op == "var":
                self.tangents[i] = {args[0]: graph.const(1.0)} if args[0] in self.names else {}
            elif op in LEAVES:
                self.tangents[i] = {}
            elif op == "solve":
                inner = [self.tangents[a] for a in args[1:]]
                self.roots[i] = root_slopes(graph, i, inner) if any(inner) else []
                self.tangents[i] = {}
            elif op == "root":
                slopes = self.roots[args[0]]
                self.tangents[i] = slopes[int(graph.nodes[args[1]][1])] if slopes else {}
            else:
                self.tangents[i] = self._through(i, op, args)
        return [self.tangents[r] for r in roots]

    def _through(self, i: int, op: str, args: list[int]) -> Tangent:
        """Return the derivatives of node i by the chain rule."""
        graph, inner = self.graph, [self.tangents[a] for a in args]
        if not any(inner) or op == "locate":
            return {}
        if any(a in self.poles for a in args) or (op in ("div", "pow", "log") and inner[-1]):
            self.poles.add(i)
        if op == "where":
            return self._either(args[0], inner[1], inner[2])
        if op in ("min", "max"):
            return self._either(self._selects_second(op, *args), inner[1], inner[0])
        if op == "exp" and args[0] in self.poles:
            positive = graph.call("lt", graph.const(0.0), i)  # exp(−1/x²) is flat where it vanishes
            inner = [self._either(positive, inner[0], {})]
        slopes = self._slopes(i, op, args)
        if slopes is None:
            return {}  # comparisons, floor, sign: constant wherever they have a derivative
        total: Tangent = {}
        for slope, tangent in zip(slopes, inner, strict=True):
            for name, node in tangent.items():
                part = graph.mul(slope, node)
                total[name] = graph.add(total[name], part) if name in total else part
        return {n: d for n, d in total.items() if graph.value(d) != 0}

    def _slopes(self, i: int, op: str, args: list[int]) -> tuple[int, ...] | None:
        """Return the partial derivatives of an operation; None if they are zero."""
        if op == "abs":
            return (self._sign_next(args[0]),)
        if op in ("mul", "fma"):
            return (self._next(args[1]), self._next(args[0]), self.graph.const(1.0))[: len(args)]
        if op == "piece":
            x, index, pieces = args
            slope = piece_slope(self.graph, x, index, pieces, lambda: self._direction(x))
            return slope, *(self.graph.const(0.0),) * 2
        return SLOPES[op](self.graph, i, *args) if op in SLOPES else None

    def _either(self, condition: int, yes: Tangent, no: Tangent) -> Tangent:
        """Return the derivatives of a branch: those of `yes` where the condition holds, else those of `no`."""
        graph, zero = self.graph, self.graph.const(0.0)
        if graph.value(condition) is not None:
            return yes if graph.value(condition) else no
        return {n: graph.call("where", condition, yes.get(n, zero), no.get(n, zero)) for n in (*yes, *no)}

    # ---- kinks: limits along one direction -----------------------------------------------------------------------

    def _direction(self, i: int) -> int:
        """Return the rate of a node along the direction: each variable falls at a rate of its own.

        It counts as 0 where many variables enter, as into the sigma points of a UKF: ties are rare, the sums are not.
        """
        graph, rate = self.graph, self.graph.const(0.0)
        if len(self.tangents[i]) > _FEW:
            return rate
        for name in sorted(self.tangents[i]):
            weight = graph.const(-1 - zlib.crc32(name.encode()) / 2**32)
            rate = graph.add(rate, graph.mul(weight, self.tangents[i][name]))
        return rate

    def _sign_next(self, i: int) -> int:
        """Return the sign of a node; where it is 0, the sign that it has next along the direction."""
        graph, zero = self.graph, self.graph.const(0.0)
        rate = self._direction(i)
        value = graph.value(rate)
        if value is None:
            apart = graph.call("lt", zero, graph.call("abs", i))
            return graph.call("where", apart, graph.call("sign", i), graph.call("sign", rate))
        if value == 0:
            return graph.call("sign", i)
        one, minus = graph.const(1.0), graph.const(-1.0)
        if value > 0:
            return graph.call("where", graph.call("lt", i, zero), minus, one)
        return graph.call("where", graph.call("lt", zero, i), one, minus)

    def _next(self, i: int) -> int:
        """Return a factor of a product: the sign of a quantity that is 0 is the one that it has next."""
        op, *args = self.graph.nodes[i]
        return self._sign_next(args[0]) if op == "sign" and self.tangents[args[0]] else i

    def _selects_second(self, op: str, a: int, b: int) -> int:
        """Return whether min or max selects b; where both are equal, whether it does next along the direction."""
        graph = self.graph
        low, high = (b, a) if op == "min" else (a, b)
        strict = graph.call("lt", low, high)
        rates = self._direction(self._between(a, b) if op == "min" else a), self._direction(b)
        gain = graph.sub(*(rates if op == "min" else rates[::-1]))  # of the advantage of b
        value = graph.value(gain)
        if value is None:
            tie = graph.call("and", graph.call("le", low, high), graph.call("lt", graph.const(0.0), gain))
            return graph.call("or", strict, tie)
        return graph.call("le", low, high) if value > 0 else strict

    def _between(self, a: int, high: int) -> int:
        """Return x if a is max(x, low) and low < high are numbers: where a is `high`, x is not at the lower limit."""
        op, *args = self.graph.nodes[a]
        top = self.graph.value(high)
        if op != "max" or top is None:
            return a
        for x, low in (args, args[::-1]):
            limit = self.graph.value(low)
            if limit is not None and limit < top:
                return x
        return a


def _one(graph: Graph, value: float) -> int:
    return graph.const(value)


def _quotient(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    inverse = graph.div(graph.const(1.0), b)
    return inverse, graph.neg(graph.mul(i, inverse))


def _divisor(graph: Graph, a: int) -> int:
    """Return a, or ∞ where a is 0: a quotient by it is 0 there."""
    if graph.value(a):
        return a
    return graph.call("where", graph.call("lt", graph.const(0.0), graph.call("abs", a)), a, graph.const(math.inf))


def _power(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    exponent, least = graph.value(b), graph.sub(b, graph.const(1.0))
    if exponent is None:  # where a is 0, it becomes ∞ for exponents below 1, so that ∞^(b − 1) is 0
        steep = graph.call("lt", b, graph.const(1.0))
        slope = graph.call("pow", graph.call("where", steep, _divisor(graph, a), a), least)
    else:
        slope = graph.call("pow", _divisor(graph, a) if 0 < exponent < 1 else a, least)
    return graph.mul(b, slope), graph.mul(i, graph.call("log", graph.call("max", a, graph.const(1e-300))))


def _signed_power(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    size, exponent = graph.call("abs", a), graph.value(b)
    limited = graph.call("max", size, graph.const(_STEEPEST))
    if exponent is None:
        base = graph.call("where", graph.call("lt", b, graph.const(1.0)), limited, size)
    else:
        base = limited if exponent < 1 else size
    slope = graph.mul(b, graph.call("pow", base, graph.sub(b, graph.const(1.0))))
    return slope, graph.mul(i, graph.call("log", limited))


def _arctangent2(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    square = _divisor(graph, graph.add(graph.mul(a, a), graph.mul(b, b)))
    return graph.div(b, square), graph.neg(graph.div(a, square))


def _inverse_root(graph: Graph, square: int) -> int:
    return graph.div(graph.const(1.0), _divisor(graph, graph.call("sqrt", square)))


def _less(graph: Graph, a: int, sign: float) -> int:
    """Return the node of 1 + sign·a²; `sign` is 1 or −1."""
    return graph.add(graph.const(1.0), graph.mul(graph.const(sign), graph.mul(a, a)))


SLOPES: dict[str, Callable[..., tuple[int, ...]]] = {
    "add": lambda g, i, a, b: (_one(g, 1.0), _one(g, 1.0)),
    "sub": lambda g, i, a, b: (_one(g, 1.0), _one(g, -1.0)),
    "div": _quotient,
    "neg": lambda g, i, a: (_one(g, -1.0),),
    "pow": _power,
    "spow": _signed_power,
    "atan2": _arctangent2,
    "sqrt": lambda g, i, a: (g.div(g.const(0.5), _divisor(g, i)),),
    "sin": lambda g, i, a: (g.call("cos", a),),
    "cos": lambda g, i, a: (g.neg(g.call("sin", a)),),
    "tan": lambda g, i, a: (_less(g, i, 1.0),),
    "asin": lambda g, i, a: (_inverse_root(g, _less(g, a, -1.0)),),
    "acos": lambda g, i, a: (g.neg(_inverse_root(g, _less(g, a, -1.0))),),
    "atan": lambda g, i, a: (g.div(g.const(1.0), _less(g, a, 1.0)),),
    "sinh": lambda g, i, a: (g.call("cosh", a),),
    "cosh": lambda g, i, a: (g.call("sinh", a),),
    "tanh": lambda g, i, a: (_less(g, i, -1.0),),
    "exp": lambda g, i, a: (i,),
    "log": lambda g, i, a: (g.div(g.const(1.0), a),),
}
"""Partial derivatives of an operation with respect to its arguments, as nodes; ``i`` is the node of the operation.

Operations that need the tangents of their arguments are in `_Forward`: products, abs, min, max and branches.
"""
