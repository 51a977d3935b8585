"""Algebraic variables z of a plant: equations 0 = g(z, x, u, φ, p, t), as definitions of z by the other quantities.

The equations are ordered into blocks, each with as many unknowns as equations and solved after the blocks that it needs
(a maximum matching and the strong components of its graph; Duff, Erisman & Reid, Direct Methods for Sparse Matrices,
1986, ch. 6). A single equation that is linear in its unknown is solved symbolically, all others by Newton's method in
the kernel, from the given guess. The index is 1 where ∂g/∂z is regular.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.composite import linear_solve
from thetascope.engine.compiler.graph import Equations, Graph, equations_text, evaluate
from thetascope.engine.compiler.lowering import Lowering, numbers
from thetascope.engine.errors import SpecError
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.lazy_sympy import numerical, sympy
from thetascope.engine.language.parser import parse, sides
from thetascope.engine.language.tables import Table
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol


SINGULAR = 1e-10  # smallest singular value of the scaled Jacobian
_ASIDE = [[share + 0.13 * k for k in range(12)] for share in (0.0, 0.31, -0.73)]  # places beside the guess


@dataclass(frozen=True)
class Variable:
    """An algebraic variable, its equation g = 0, and the first guess of its value."""

    symbol: Symbol
    equation: Expr
    guess: Expr
    field: str

    @property
    def name(self) -> str:
        """Return the variable's name."""
        return self.symbol.name


def solutions(unknowns: Sequence[Variable]) -> list[tuple[Symbol, Expr]]:
    """Return the expression of each unknown by quantities known before it, in an order of evaluation.

    Raises SpecError where the equations cannot determine the unknowns, whatever their values: the index is above 1.
    """
    partner = _matching(unknowns)
    waiting, known, ordered = dict(enumerate(unknowns)), set(), []
    symbols = {u.symbol for u in unknowns}
    for block in _blocks(unknowns, partner):
        for i in block:
            waiting.pop(i)
        group = [unknowns[i] for i in block]
        own = [unknowns[partner[i]].symbol for i in block]
        assert all(u.equation.free_symbols & symbols <= known | set(own) for u in group), "blocks are in order"
        ordered += _block(group, [u for u in unknowns if u.symbol in own])
        known |= set(own)
    return ordered


def _matching(unknowns: Sequence[Variable]) -> list[int]:
    """Return for each equation the position of the unknown that it determines.

    Raises SpecError if an equation determines no unknown.
    """
    occurs = [[j for j, u in enumerate(unknowns) if u.symbol in e.equation.free_symbols] for e in unknowns]
    equation_of: dict[int, int] = {}

    def assign(i: int, tried: set[int]) -> bool:
        for j in occurs[i]:
            if j not in tried:
                tried.add(j)
                if j not in equation_of or assign(equation_of[j], tried):
                    equation_of[j] = i
                    return True
        return False

    for i, u in enumerate(unknowns):
        if not occurs[i]:
            raise SpecError(u.field, u.name, Message("algebraic.no-unknown", name=u.name))
        if not assign(i, set()):
            left = [other.name for j, other in enumerate(unknowns) if j not in equation_of]
            raise SpecError(u.field, u.name, Message("algebraic.undetermined", names=left, name=u.name))
    partner = {i: j for j, i in equation_of.items()}
    return [partner[i] for i in range(len(unknowns))]


def _blocks(unknowns: Sequence[Variable], partner: Sequence[int]) -> list[list[int]]:
    """Return the equations in blocks, each after those that it needs."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    n = len(unknowns)
    determined_by = {j: i for i, j in enumerate(partner)}
    needs = np.zeros((n, n), dtype=bool)
    for i, e in enumerate(unknowns):
        for j, u in enumerate(unknowns):
            if u.symbol in e.equation.free_symbols and determined_by[j] != i:
                needs[i, determined_by[j]] = True
    count, label = connected_components(csr_matrix(needs), connection="strong")
    blocks = {k: [i for i in range(n) if label[i] == k] for k in range(count)}
    ordered, done = [], set()
    while blocks:
        ready = [
            k
            for k, block in blocks.items()
            if {int(j) for i in block for j in needs[i].nonzero()[0]} <= done | set(block)
        ]
        k = min(ready, key=lambda k: blocks[k])
        done |= set(blocks[k])
        ordered.append(blocks.pop(k))
    return ordered


def _block(group: Sequence[Variable], own: Sequence[Variable]) -> list[tuple[Symbol, Expr]]:
    """Return the expressions of the unknowns of one block."""
    z = [u.symbol for u in own]
    if len(group) == 1:
        slope, rest = derivative(group[0].equation, z[0]), group[0].equation.xreplace({z[0]: sympy.S.Zero})
        if slope == 0:
            raise SpecError(group[0].field, group[0].name, Message("algebraic.no-unknown", name=own[0].name))
        if z[0] not in slope.free_symbols and not rest.has(sympy.nan, sympy.zoo):
            return [(z[0], -rest / slope)]
    free = {s for u in group for s in u.equation.free_symbols} | {s for u in own for s in u.guess.free_symbols}
    given = sorted(free - set(z), key=lambda s: s.name)
    swap: dict[Symbol, Symbol] = {s: sympy.Symbol(f"a.{k}", real=True) for k, s in enumerate(given)}
    swap |= {s: sympy.Symbol(f"z.{j}", real=True) for j, s in enumerate(z)}
    g, guess = [u.equation.xreplace(swap) for u in group], [u.guess.xreplace(swap) for u in own]
    names = tuple(u.name for u in own)
    problem = numerical.ProblemAtom(equations_text(_equations(names, g, guess, len(given))), names)
    return [
        (symbol, numerical.Solution(problem, sympy.Integer(j), sympy.Tuple(), *given)) for j, symbol in enumerate(z)
    ]


def _equations(names: tuple[str, ...], g: Sequence[Expr], guess: Sequence[Expr], given: int) -> Equations:
    """Return equations in the symbols a.k and z.j as a graph, with their derivatives and Newton's step."""
    zs, numbers = [f"z.{j}" for j in range(len(g))], [f"a.{k}" for k in range(given)]
    lowering = Lowering(Graph(), {*zs, *numbers})
    graph, start, values = lowering.graph, [lowering(e) for e in guess], [lowering(e) for e in g]
    zero = graph.const(0.0)
    slopes = derivatives(graph, values, [*zs, *numbers])
    J, G = ([[row.get(name, zero) for name in names] for row in slopes] for names in (zs, numbers))
    step = [row[0] for row in linear_solve(graph, J, [[v] for v in values])]
    size = []
    for row in slopes:
        total = zero
        for name, slope in row.items():
            total = graph.add(total, graph.call("abs", graph.mul(slope, graph.var(name))))
        size.append(total)
    kept = Graph()
    moved = kept.absorb(graph, [*start, *values, *step, *size, *(i for rows in (J, G) for row in rows for i in row)])

    def new(nodes: Sequence[int]) -> list[int]:
        return [moved[i] for i in nodes]

    rows = [new(r) for r in J], [new(r) for r in G]
    return Equations(kept, new(start), new(values), new(step), new(size), *rows, names)


def variable(
    i: int,
    data: Mapping,
    symbols: Mapping[str, Symbol],
    allowed: Mapping[str, Symbol],
    tables: Mapping[str, Table],
    inner: Mapping[Symbol, Expr],
) -> Variable:
    """Return the i-th algebraic variable of a plant from its text.

    Args:
        i: its position.
        data: its data.
        symbols: all names that the equation may use.
        allowed: the names that do not depend on algebraic variables, for the guess.
        tables: the plant's tables.
        inner: the definitions that depend on algebraic variables, written out.
    """
    field = f"algebraic.{i}.equation"
    left, right = sides(data["equation"])
    equation = parse(left, symbols, field, tables=tables).sympy(symbols, tables)
    if right:
        equation -= parse(right, symbols, field, tables=tables).sympy(symbols, tables)
    guess = parse(data["guess"], allowed, f"algebraic.{i}.guess", tables=tables).sympy(allowed, tables)
    return Variable(symbols[data["name"]], equation.xreplace(inner), guess, field)


def check_start(unknowns: Sequence[Variable], definitions: Sequence[tuple[Symbol, Expr]], plant: Mapping) -> None:
    """Refuse equations that have no solution, or a singular Jacobian, at the plant's own initial state.

    Args:
        unknowns: the algebraic variables.
        definitions: all definitions in their order, those of the unknowns among them.
        plant: the plant's data. Equations with known signals are not checked, whose values depend on the experiment.

    Raises SpecError.
    """
    values = {s["name"]: float(s["initial"]) for s in plant["states"]} | {"t": 0.0}
    values |= {u["name"]: float(u["default"]) for u in plant["inputs"]}
    values |= {p["name"]: float(p["value"]) for p in plant["parameters"]}
    signals = {s["name"] for s in plant["signals"]}
    if any(signals & {s.name for s in e.free_symbols} for _, e in definitions):
        return
    names = [u.name for u in unknowns]
    z = dict(zip(names, numbers([u.symbol for u in unknowns], values, definitions), strict=True))
    others = [(s, e) for s, e in definitions if s.name not in z]
    lost = [u for u in unknowns if not np.isfinite(z[u.name])]
    if not lost and not _singular(_jacobian(unknowns, others, values | z)):
        return
    guess = dict(zip(names, numbers([u.guess for u in unknowns], values, others), strict=True))
    aside = [{n: v + k * (1 + abs(v)) for k, (n, v) in zip(shares, guess.items(), strict=False)} for shares in _ASIDE]
    if lost and not all(_singular(_jacobian(unknowns, others, values | point)) for point in aside):
        raise SpecError(lost[0].field, lost[0].name, Message("algebraic.no-start", name=lost[0].name))
    raise SpecError(unknowns[0].field, names[0], Message("algebraic.singular", names=names))


def _singular(J: np.ndarray) -> bool:
    return not np.isfinite(J).all() or bool(np.linalg.svd(J, compute_uv=False)[-1] < SINGULAR)


def _jacobian(
    unknowns: Sequence[Variable], definitions: Sequence[tuple[Symbol, Expr]], values: Mapping[str, float]
) -> np.ndarray:
    """Return ∂g/∂z at a point, with rows and columns scaled to like size, so that units do not matter."""
    lowering = Lowering(Graph(), set(values))
    for symbol, expression in definitions:
        lowering.define(symbol, expression)
    rows = derivatives(lowering.graph, [lowering(u.equation) for u in unknowns], [u.name for u in unknowns])
    zero = lowering.graph.const(0.0)
    nodes = [row.get(u.name, zero) for row in rows for u in unknowns]
    J = np.array([float(v) for v in evaluate(lowering.graph, nodes, values)]).reshape(len(rows), -1)
    for axis in (1, 0, 1, 0):
        size = np.abs(J).max(axis=axis, keepdims=True)
        J = J / np.where(size > 0, size, 1.0)
    return J
