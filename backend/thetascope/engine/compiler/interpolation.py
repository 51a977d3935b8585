"""Tables in the expression graph: a search for the piece, shared by a value and its derivatives, and its polynomial."""

from collections.abc import Callable

from thetascope.engine.compiler.graph import Graph
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
