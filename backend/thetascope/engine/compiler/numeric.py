"""Numerical evaluation of SymPy expressions at a point, with NumPy and the expression graph."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.compiler.graph import Graph, evaluate
from thetascope.engine.compiler.lowering import Lowering

if TYPE_CHECKING:
    from sympy import Expr, Symbol


def numbers(
    expressions: Iterable[Expr], values: Mapping[str, float], definitions: Iterable[tuple[Symbol, Expr]] = ()
) -> np.ndarray:
    """Return the values of expressions at a point, one each.

    Args:
        expressions: SymPy expressions, for example the entries of a matrix row by row.
        values: the value of each free symbol by name.
        definitions: intermediate results that the expressions may use, in order.

    Raises ValueError for a symbol that has neither a value nor a definition.
    """
    lowering = Lowering(Graph(), set(values))
    for symbol, expression in definitions:
        lowering.define(symbol, expression)
    roots = [lowering(e) for e in expressions]
    return np.array([float(v) for v in evaluate(lowering.graph, roots, values)])
