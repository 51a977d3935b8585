"""Hash-consed expression graph, the form of a System from which kernels are compiled.

A node is a tuple ``(op, a, b, ...)`` whose arguments are indices of earlier nodes; the leaves are ``("const", value)``,
``("var", name)`` and ``("table", rows)``. ``locate(x, grid)`` is the index of the piece of a table at x, and
``piece(x, index, pieces)`` the value of that piece (engine/language/tables.py). Equal nodes are stored once, so common
subexpressions are shared without a search. The value of a comparison is 1.0 or 0.0, so that every node but a table is a
real number.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping

import numpy as np

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
LEAVES = ("const", "var", "table")


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
            elif node[0] == "table":
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
        elif op in ("var", "table"):
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


def _locate(x, grid: tuple[float, ...]):
    return np.where(np.isnan(x), 0.0, np.searchsorted(grid, x, side="right"))


def _piece(x, index, pieces: tuple[tuple[float, ...], ...]):
    row = np.moveaxis(np.asarray(pieces)[np.asarray(index, dtype=int)], -1, 0)
    s = x - row[0]
    total = row[-1]
    for c in row[-2:0:-1]:
        total = total * s + c
    return total


def _spow(x, a):
    return np.copysign(np.abs(x) ** a, x)


# Evaluation of each operation on NumPy arrays, for checks, analyses and tests; runs use compiled kernels.
NUMPY = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "fma": lambda a, b, c: a * b + c,
    "min": lambda a, b: np.where(b < a, b, a),
    "max": lambda a, b: np.where(b > a, b, a),
    "sign": lambda a: np.where(a > 0, 1.0, np.where(a < 0, -1.0, a * 0.0)),
    "lt": lambda a, b: np.where(a < b, 1.0, 0.0),
    "le": lambda a, b: np.where(a <= b, 1.0, 0.0),
    "and": lambda a, b: np.where((a != 0) & (b != 0), 1.0, 0.0),
    "or": lambda a, b: np.where((a != 0) | (b != 0), 1.0, 0.0),
    "where": lambda c, a, b: np.where(c != 0, a, b),
    "pow": lambda a, b: a**b,
    "spow": _spow,
    "atan2": np.arctan2,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "floor": np.floor,
    "abs": np.abs,
    "locate": _locate,
    "piece": _piece,
}


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
            else:
                computed[i] = NUMPY[node[0]](*(computed[a] for a in node[1:]))
    return [computed[r] for r in roots]
