"""Automatic differentiation of a program's graph in forward mode, without SymPy.

It differentiates the program itself, including saturations and branches; at a kink the derivative is one-sided.
"""

from collections.abc import Callable, Iterable, Sequence

from thetascope.engine.compiler.graph import Graph, topological

Tangent = dict[str, int]  # variable → node of the derivative with respect to it; zeros are left out

_STEEPEST = 1e-6  # lower limit of |x| in the slope of |x|^a, which is unbounded at 0


def derivatives(graph: Graph, roots: Sequence[int], names: Iterable[str]) -> list[Tangent]:
    """Return the partial derivatives of each root with respect to the named variables, as nodes added to the graph."""
    wanted, tangents = set(names), {}
    for i in list(topological(graph, roots)):
        op, *args = graph.nodes[i]
        if op == "var":
            tangents[i] = {args[0]: graph.const(1.0)} if args[0] in wanted else {}
        elif op == "const":
            tangents[i] = {}
        else:
            tangents[i] = _through(graph, i, op, args, [tangents[a] for a in args])
    return [tangents[r] for r in roots]


def _through(graph: Graph, i: int, op: str, args: list[int], inner: list[Tangent]) -> Tangent:
    """Return the derivatives of node i by the chain rule; `inner` holds those of its arguments."""
    if not any(inner):
        return {}
    if op == "where":
        return _either(graph, args[0], inner[1], inner[2])
    if op in ("min", "max"):
        a, b = args
        second = graph.call("lt", b, a) if op == "min" else graph.call("lt", a, b)  # whether b is selected
        return _either(graph, second, inner[1], inner[0])
    if op not in SLOPES:
        return {}  # comparisons, floor, sign: constant wherever they have a derivative
    slopes = SLOPES[op](graph, i, *args)
    total: Tangent = {}
    for slope, tangent in zip(slopes, inner, strict=True):
        for name, node in tangent.items():
            part = graph.mul(slope, node)
            total[name] = graph.add(total[name], part) if name in total else part
    return {n: d for n, d in total.items() if graph.value(d) != 0}


def _either(graph: Graph, condition: int, yes: Tangent, no: Tangent) -> Tangent:
    """Return the derivatives of a branch: those of `yes` where the condition holds, else those of `no`."""
    zero = graph.const(0.0)
    return {n: graph.call("where", condition, yes.get(n, zero), no.get(n, zero)) for n in (*yes, *no)}


def _one(graph: Graph, value: float) -> int:
    return graph.const(value)


def _quotient(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    inverse = graph.div(graph.const(1.0), b)
    return inverse, graph.neg(graph.mul(i, inverse))


def _power(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    slope = graph.mul(b, graph.call("pow", a, graph.sub(b, graph.const(1.0))))
    return slope, graph.mul(i, graph.call("log", graph.call("max", a, graph.const(1e-300))))


def _signed_power(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    size = graph.call("max", graph.call("abs", a), graph.const(_STEEPEST))
    slope = graph.mul(b, graph.call("pow", size, graph.sub(b, graph.const(1.0))))
    return slope, graph.mul(i, graph.call("log", size))


def _arctangent2(graph: Graph, i: int, a: int, b: int) -> tuple[int, int]:
    square = graph.add(graph.mul(a, a), graph.mul(b, b))
    return graph.div(b, square), graph.neg(graph.div(a, square))


def _inverse_root(graph: Graph, square: int) -> int:
    return graph.div(graph.const(1.0), graph.call("sqrt", square))


def _less(graph: Graph, a: int, sign: float) -> int:
    """Return the node of 1 + sign·a²; `sign` is 1 or −1."""
    return graph.add(graph.const(1.0), graph.mul(graph.const(sign), graph.mul(a, a)))


SLOPES: dict[str, Callable[..., tuple[int, ...]]] = {
    "add": lambda g, i, a, b: (_one(g, 1.0), _one(g, 1.0)),
    "sub": lambda g, i, a, b: (_one(g, 1.0), _one(g, -1.0)),
    "mul": lambda g, i, a, b: (b, a),
    "div": _quotient,
    "neg": lambda g, i, a: (_one(g, -1.0),),
    "fma": lambda g, i, a, b, c: (b, a, _one(g, 1.0)),
    "pow": _power,
    "spow": _signed_power,
    "atan2": _arctangent2,
    "sqrt": lambda g, i, a: (g.div(g.const(0.5), i),),
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
    "abs": lambda g, i, a: (g.call("sign", a),),
}
"""Partial derivatives of each operation with respect to its arguments, as nodes; ``i`` is the node of the operation."""
