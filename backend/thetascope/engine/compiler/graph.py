"""Hash-consed expression graph, the form of a System from which kernels are compiled.

A node is a tuple ``(op, a, b, ...)`` whose arguments are indices of earlier nodes. The leaves are ``("const", value)``,
``("var", name)``, ``("table", rows)`` and ``("problem", equations)``. ``locate(x, grid)`` is the index of the piece of
a table at x, and ``piece(x, index, pieces)`` the value of that piece (engine/language/tables.py); ``solve(problem, a,
…)`` are the roots of equations, and ``root(solve, j)`` is one of them. Equal nodes are stored once, so common
subexpressions are shared without a search. The value of a comparison is 1.0 or 0.0, so that every node that another
operation may use is a real number.
"""

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.engine.compiler.instructions.numpy_operations import NUMPY, newton

UNARY_FUNCTIONS = (
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "floor",
    "abs",
)
LEAVES = ("const", "var", "table", "problem")


class Graph:
    """A list of nodes. The methods that add a node return its index.

    They fold constants and simplify sums with 0 and products with 0 or 1.
    """

    def __init__(self, nodes: Iterable[tuple] = ()):
        self.nodes: list[tuple] = list(nodes)
        self.index: dict[tuple, int] = {node: i for i, node in enumerate(self.nodes)}
        self.orders: dict[tuple[int, ...], list[int]] = {}  # cache of `topological`: nodes never change

    def raw(self, op: str, *args) -> int:
        """Return the index of a node, added without simplification if it is new."""
        # as dictionary keys 0.0 == -0.0: the sign distinguishes them
        key = (op, *args, math.copysign(1.0, args[0])) if op == "const" else (op, *args)
        position = self.index.get(key)
        if position is None:
            position = len(self.nodes)
            self.nodes.append((op, *args))
            self.index[key] = position
        return position

    def const(self, value: float) -> int:
        """Return the index of a constant."""
        return self.raw("const", float(value))

    def var(self, name: str) -> int:
        """Return the index of a variable."""
        return self.raw("var", name)

    def value(self, i: int) -> float | None:
        """Return the number of a constant node, None for other nodes."""
        node = self.nodes[i]
        return node[1] if node[0] == "const" else None

    def add(self, a: int, b: int) -> int:
        """Return the index of a + b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.const(x + y)
        if x == 0:
            return b
        if y == 0:
            return a
        if self.nodes[b][0] == "neg":
            return self.sub(a, self.nodes[b][1])
        if self.nodes[a][0] == "neg":
            return self.sub(b, self.nodes[a][1])
        return self.raw("add", *sorted((a, b)))

    def sub(self, a: int, b: int) -> int:
        """Return the index of a − b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.const(x - y)
        if y == 0:
            return a
        if x == 0:
            return self.neg(b)
        return self.raw("sub", a, b)

    def mul(self, a: int, b: int) -> int:
        """Return the index of a·b; a minus sign of a factor moves to the product."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.const(x * y)
        if x is not None:
            a, b, x, y = b, a, y, x
        if y == 0:
            return self.const(0.0)
        if y == 1:
            return a
        if y == -1:
            return self.neg(a)
        if self.nodes[a][0] == "neg":
            return self.neg(self.mul(self.nodes[a][1], b))
        if self.nodes[b][0] == "neg":
            return self.neg(self.mul(a, self.nodes[b][1]))
        return self.raw("mul", *sorted((a, b)))

    def div(self, a: int, b: int) -> int:
        """Return the index of a/b; division by a power of two becomes a product, which is exact."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None and y != 0:
            return self.const(x / y)
        if x == 0:
            return a
        if y is not None and y != 0 and math.frexp(y)[0] in (0.5, -0.5):  # exact: a power of two
            return self.mul(a, self.const(1.0 / y))
        return self.raw("div", a, b)

    def neg(self, a: int) -> int:
        """Return the index of −a."""
        x = self.value(a)
        if x is not None:
            return self.const(-x)
        return self.nodes[a][1] if self.nodes[a][0] == "neg" else self.raw("neg", a)

    def power(self, base: int, exponent: float) -> int:
        """Return base**exponent: products for integers up to 64, square roots for halves, else the C library's pow."""
        if exponent < 0:
            return self.div(self.const(1.0), self.power(base, -exponent))
        if exponent == int(exponent) and exponent <= 64:
            return self._integer_power(base, int(exponent))
        if exponent == 0.5:
            return self.call("sqrt", base)
        if exponent * 2 == int(exponent * 2) and exponent <= 32:
            return self.mul(self._integer_power(base, int(exponent)), self.call("sqrt", base))
        return self.call("pow", base, self.const(exponent))

    def _integer_power(self, base: int, exponent: int) -> int:
        """Return base**exponent by repeated squaring."""
        result, square = self.const(1.0), base
        while exponent:
            if exponent & 1:
                result = self.mul(result, square)
            exponent >>= 1
            if exponent:
                square = self.mul(square, square)
        return result

    def call(self, op: str, *args: int) -> int:
        """Return the index of a function, or of its value if all arguments are constant and the value is finite."""
        values = [self.value(a) for a in args]
        if all(v is not None for v in values):
            with np.errstate(all="ignore"):
                folded = float(NUMPY[op](*(np.float64(v) for v in values)))
            if math.isfinite(folded):
                return self.const(folded)
        return self.raw(op, *args)

    def absorb(self, other: "Graph", roots: Iterable[int], replace: Mapping[str, int] | None = None) -> dict[int, int]:
        """Copy the nodes that ``roots`` need from another graph, and return the new index of each.

        Variables named in ``replace`` become those nodes. Nothing is simplified, because a program must compute the
        same bits alone and joined to another.
        """
        replace, moved = replace or {}, {}
        for i in topological(other, roots):
            node = other.nodes[i]
            if node[0] == "const":
                moved[i] = self.const(node[1])
            elif node[0] in ("table", "problem"):
                moved[i] = self.raw(*node)
            elif node[0] == "var":
                moved[i] = replace[node[1]] if node[1] in replace else self.var(node[1])
            else:
                moved[i] = self.raw(node[0], *(moved[a] for a in node[1:]))
        return moved


def topological(graph: Graph, roots: Iterable[int]) -> list[int]:
    """Return the nodes that the roots need, each after its arguments. Iterative, because expressions may be deep."""
    roots = tuple(roots)
    cached = graph.orders.get(roots)
    if cached is not None:
        return cached
    order: list[int] = []
    visited: set[int] = set()
    for root in roots:
        stack = [(root, False)]
        while stack:
            i, ready = stack.pop()
            if ready:
                order.append(i)
                continue
            if i in visited:
                continue
            visited.add(i)
            stack.append((i, True))
            node = graph.nodes[i]
            if node[0] not in LEAVES:
                stack.extend((a, False) for a in reversed(node[1:]) if a not in visited)
    graph.orders[roots] = order
    return order


def variables(graph: Graph, roots: Iterable[int]) -> set[str]:
    """Return the names of the variables that the roots depend on."""
    return {graph.nodes[i][1] for i in topological(graph, roots) if graph.nodes[i][0] == "var"}


def contract(graph: Graph, roots: list[int], rank: Callable[[int], int] = lambda i: 0) -> tuple[Graph, list[int]]:
    """Return a graph and its roots with a·b + c as one fused multiply-add wherever the product is used only once.

    Of two products the one of higher rank is fused. This happens in the graph and not in the compiler, so that a lane,
    a single run and a joined program round in the same places and agree bit for bit.
    """
    order = topological(graph, roots)
    uses = Counter(a for i in order if graph.nodes[i][0] not in LEAVES for a in graph.nodes[i][1:])
    uses.update(roots)
    result, moved = Graph(), {}
    for i in order:
        op, *args = graph.nodes[i]
        if op == "const":
            moved[i] = result.const(args[0])
        elif op in LEAVES:
            moved[i] = result.raw(op, *args)
        elif op in ("add", "sub"):
            moved[i] = _fuse(graph, result, moved, uses, rank, op, *args)
        else:
            moved[i] = result.raw(op, *(moved[a] for a in args))
    return result, [moved[r] for r in roots]


def _fuse(
    graph: Graph, result: Graph, moved: dict[int, int], uses: Counter, rank: Callable, op: str, a: int, b: int
) -> int:
    """Return the sum or difference of a and b in the new graph, fused if one of them is a product that is used once."""
    products = [i for i in (a, b) if graph.nodes[i][0] == "mul" and uses[i] == 1]
    if not products:
        return result.raw(op, moved[a], moved[b])
    product = max(products, key=rank)
    x, y = (moved[k] for k in graph.nodes[product][1:])
    if product == a:
        return result.raw("fma", x, y, moved[b] if op == "add" else result.raw("neg", moved[b]))
    return result.raw("fma", x if op == "add" else result.raw("neg", x), y, moved[a])


def evaluate(graph: Graph, roots: list[int], values: Mapping[str, object]) -> list:
    """Return the values of the roots; ``values`` maps variable names to numbers or arrays, which are broadcast."""
    computed: dict[int, object] = {}
    with np.errstate(all="ignore"):
        for i in topological(graph, roots):
            node = graph.nodes[i]
            if node[0] == "const":
                computed[i] = np.float64(node[1])
            elif node[0] == "var":
                computed[i] = np.asarray(values[node[1]], dtype=float)
            elif node[0] == "table":
                computed[i] = node[1]
            elif node[0] == "problem":
                continue
            elif node[0] == "solve":
                computed[i] = equations(graph.nodes[node[1]][1]).solved([computed[a] for a in node[2:]])
            else:
                computed[i] = NUMPY[node[0]](*(computed[a] for a in node[1:]))
    return [computed[r] for r in roots]


@dataclass(frozen=True)
class Equations:
    """Equations g(z, a) = 0 for n unknowns z at k given numbers a: nodes of a graph with variables ``z.j`` and ``a.k``.

    ``start`` is the first guess of z (in a only), ``step`` J⁻¹g, ``size`` Σ|∂g/∂z z| + Σ|∂g/∂a a|, the size of the
    terms of g, ``J`` is ∂g/∂z (n × n) and ``G`` is ∂g/∂a (n × k). ``names`` are those of the unknowns.
    """

    graph: Graph
    start: list[int]
    g: list[int]
    step: list[int]
    size: list[int]
    J: list[list[int]]
    G: list[list[int]]
    names: tuple[str, ...]

    def solved(self, given: list) -> np.ndarray:
        """Return the roots (n, …) at given numbers or arrays by Newton's method; NaN where it does not converge."""
        a = {f"a.{k}": value for k, value in enumerate(given)}
        n, roots = len(self.g), [*self.g, *self.step, *self.size]
        shape = np.broadcast_shapes(*(np.shape(v) for v in given))

        def at(z: np.ndarray) -> np.ndarray:
            parts = evaluate(self.graph, roots, a | {f"z.{j}": value for j, value in enumerate(z)})
            return np.array([np.broadcast_to(p, shape) for p in parts], dtype=float).reshape(3, n, *shape)

        start = evaluate(self.graph, self.start, a)
        return newton(np.array([np.broadcast_to(s, shape) for s in start], dtype=float), at)


@lru_cache(maxsize=256)
def equations(text: str) -> Equations:
    """Return the equations that `equations_text` wrote."""
    data, graph = json.loads(text), Graph()
    for node in nodes_from_json(data.pop("nodes")):
        graph.raw(*node)
    return Equations(graph, **data)


def equations_text(e: Equations) -> str:
    """Return equations as text, the content of a ``problem`` node."""
    parts = {"names": e.names, "start": e.start, "g": e.g, "step": e.step, "size": e.size, "J": e.J, "G": e.G}
    return json.dumps({"nodes": nodes_to_json(e.graph.nodes)} | parts, separators=(",", ":"))


def nodes_to_json(nodes: Iterable[tuple]) -> list[list]:
    """Return nodes as JSON values; numbers are hexadecimal floats, which are exact."""
    return [[op, _hexadecimal(args[0])] if op in ("const", "table") else [op, *args] for op, *args in nodes]


def nodes_from_json(nodes: Iterable[list]) -> list[tuple]:
    """Return the nodes of `nodes_to_json`."""
    return [(op, _numbers(args[0])) if op in ("const", "table") else (op, *args) for op, *args in nodes]


def _hexadecimal(value: float | tuple) -> str | list:
    return [_hexadecimal(v) for v in value] if isinstance(value, tuple) else float(value).hex()


def _numbers(value: str | list) -> float | tuple:
    return tuple(_numbers(v) for v in value) if isinstance(value, list) else float.fromhex(value)
