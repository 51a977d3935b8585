"""Operations of several nodes: tables, linear equations, and the derivatives of roots.

A table is a search for the piece, which a value and its derivatives share, and the polynomial of the piece.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

from thetascope.engine.compiler.graph import Graph, equations
from thetascope.engine.language.tables import Table, jumps, slope_of


def interpolate(graph: Graph, x: int, table: Table, below: bool = False) -> int:
    """Return the node of a table at x; at a point of its grid the value of the piece above it, or of that below it."""
    index = graph.raw("locate", x, graph.raw("table", table.grid))
    pieces = graph.raw("table", table.pieces)
    return graph.raw("piece", x, _below(graph, x, index, pieces) if below else index, pieces)


def piece_slope(graph: Graph, x: int, index: int, pieces: int, rate: Callable[[], int]) -> int:
    """Return the node of the derivative of ``piece(x, index, pieces)``.

    Where it jumps, it is that of the piece in which x is next; ``rate()`` is the node of its rate along the direction
    of autodiff.py.
    """
    slopes = slope_of(graph.nodes[pieces][1])
    if not any(any(row[1:]) for row in slopes):
        return graph.const(0.0)
    leaf = graph.raw("table", slopes)
    if jumps(slopes):
        falling = graph.call("lt", rate(), graph.const(0.0))
        known = graph.value(falling)
        below = _below(graph, x, index, pieces) if known != 0 else index
        index = below if known else index if known == 0 else graph.call("where", falling, below, index)
    return graph.raw("piece", x, index, leaf)


def _below(graph: Graph, x: int, index: int, pieces: int) -> int:
    """Return the index of the piece at x, or of the piece below it where x is its lower end."""
    origins = graph.raw("table", tuple((row[0], row[0]) for row in graph.nodes[pieces][1]))
    at_end = graph.call("le", x, graph.raw("piece", x, index, origins))
    is_inside = graph.call("lt", graph.const(0.0), index)
    return graph.call("where", graph.call("and", is_inside, at_end), graph.sub(index, graph.const(1.0)), index)


def root_slopes(graph: Graph, solve: int, tangents: Sequence[Mapping[str, int]]) -> list[dict[str, int]]:
    """Return the derivatives of the roots of a ``solve`` node by those of its given numbers: ∂z = −J⁻¹ G ∂a."""
    problem, *given = graph.nodes[solve][1:]
    e = equations(graph.nodes[problem][1])
    n, zero = len(e.g), graph.const(0.0)
    known = {f"z.{j}": graph.raw("root", solve, graph.const(j)) for j in range(n)}
    known |= {f"a.{k}": node for k, node in enumerate(given)}
    moved = graph.absorb(e.graph, [i for rows in (e.J, e.G) for row in rows for i in row], known)
    J, G = ([[moved[i] for i in row] for row in rows] for rows in (e.J, e.G))
    names = list(dict.fromkeys(name for tangent in tangents for name in tangent))
    right = [
        [graph.neg(_scalar_product(graph, row, [tangent.get(name, zero) for tangent in tangents])) for name in names]
        for row in G
    ]
    slopes = linear_solve(graph, J, right)
    return [{name: node for name, node in zip(names, row, strict=True) if graph.value(node) != 0} for row in slopes]


def linear_solve(graph: Graph, A: Sequence[Sequence[int]], B: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the nodes of A⁻¹B by Gaussian elimination with row exchanges. A is n × n, B is n × r."""
    n, zero = len(A), graph.const(0.0)
    rows = [[*a, *b] for a, b in zip(A, B, strict=True)]
    for k in range(n):
        for i in range(k + 1, n):
            rows[k], rows[i] = _larger_first(graph, rows[k], rows[i], k)
        for i in range(k + 1, n):
            if graph.value(rows[i][k]) != 0:
                factor = graph.div(rows[i][k], rows[k][k])
                rest = zip(rows[i][k + 1 :], rows[k][k + 1 :], strict=True)
                rows[i] = [*[zero] * (k + 1), *(graph.sub(a, graph.mul(factor, b)) for a, b in rest)]
    solution: list[list[int]] = [[] for _ in range(n)]
    for k in reversed(range(n)):
        for j in range(n, len(rows[k])):
            above = _scalar_product(graph, rows[k][k + 1 : n], [solution[i][j - n] for i in range(k + 1, n)])
            solution[k].append(graph.div(graph.sub(rows[k][j], above), rows[k][k]))
    return solution


def _larger_first(graph: Graph, upper: list[int], lower: list[int], k: int) -> tuple[list[int], list[int]]:
    """Return two rows in the order of |column k|, the larger one first."""
    if graph.value(lower[k]) == 0:
        return upper, lower
    if graph.value(upper[k]) == 0:
        return lower, upper
    swap = graph.call("lt", graph.call("abs", upper[k]), graph.call("abs", lower[k]))
    if graph.value(swap) is not None:
        return (lower, upper) if graph.value(swap) else (upper, lower)
    pairs = list(zip(upper, lower, strict=True))
    return (
        [a if a == b else graph.call("where", swap, b, a) for a, b in pairs],
        [a if a == b else graph.call("where", swap, a, b) for a, b in pairs],
    )


def _scalar_product(graph: Graph, a: Iterable[int], b: Iterable[int]) -> int:
    total = graph.const(0.0)
    for x, y in zip(a, b, strict=True):
        total = graph.add(total, graph.mul(x, y))
    return total
