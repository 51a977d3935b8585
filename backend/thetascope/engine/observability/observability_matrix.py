"""The observability matrix of a plant with its faults at a point: derivatives of the outputs in (x, θ), to any order.

The plant is augmented by its constant faults, x' = f + Φθ, θ' = 0. The rows are the Taylor coefficients of the outputs'
sensitivities along the solution from the point: the derivatives in (x, θ) of the Lie derivatives of the outputs, up to
factorials (Hermann & Krener, IEEE TAC 22(5), 1977). They are computed numerically, as in Sedoglavic, J. Symbolic
Computation 33, 2002, but in decimal arithmetic of many digits instead of a finite field, so that roots and sines are
allowed. For discrete plants the outputs of successive steps replace the derivatives.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph, topological
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.observability.exact_rank import Elimination
from thetascope.engine.observability.taylor import Series, convolve

MOST_NODES = 20_000  # limit for the plant's equations with their derivatives
WORK = 3_000_000  # limit for the number of products
_IDLE = 3  # orders without a higher rank after which the rank is final, where nothing switches
_LONGER = 3  # times as many for a discrete plant that switches: a fault may take effect only after a switch
SWITCHES = {"where", "min", "max", "abs", "sign", "floor", "lt", "le", "locate"}


class TooLarge(Exception):
    """The plant requires more work than is allowed."""


@dataclass(frozen=True)
class Point:
    """A point of evaluation: states, parameters, faults and t as values,
    inputs as Taylor coefficients (one per step)."""

    values: Mapping[str, Decimal]
    inputs: Mapping[str, list[Decimal]]


@dataclass(frozen=True)
class Found:
    """Rank at a point, and the null space: vectors over the unknown x, and θ. ``states``: the rank if θ were known."""

    rank: int
    states: int
    null: list[list[Decimal]] = field(repr=False)


class Lie:
    """The observability matrix of a program, with θ of the given channels, at any point.

    ``unknown``: the states to be determined from the outputs; the others are assumed to be known. Use it within
    `taylor.precise`. Raises TooLarge.
    """

    def __init__(self, program: Program, channels: tuple[str, ...], unknown: tuple[str, ...] | None = None):
        self.program, theta = program, tuple(f"theta.{c}" for c in channels)
        self.n, self.m = len(program.states), len(program.outputs)
        self.unknown = [i for i, s in enumerate(program.states) if unknown is None or s in unknown]
        self.columns = len(self.unknown) + len(theta)
        graph = Graph(program.graph.nodes)
        self.f, self.h = list(program.update), list(program.outputs.values())
        slopes = derivatives(graph, [*self.f, *self.h], (*program.states, *theta))
        places = {name: j for j, name in enumerate((*program.states, *theta))}
        rows = [{places[name]: node for name, node in row.items() if graph.value(node) != 0} for row in slopes]
        self.F, self.H = rows[: self.n], rows[self.n :]
        self.graph, self.roots = graph, [*self.f, *self.h, *(node for row in rows for node in row.values())]
        self.still = {*program.parameters, *(i for i in program.inputs if i.startswith("theta."))}
        self.entries = sum(len(row) for row in rows)
        self.switches = any(graph.nodes[i][0] in SWITCHES for i in topological(graph, self.roots))
        self.goes_on = self.switches and program.time == DISCRETE
        self.orders = (self.columns + _IDLE) * (_LONGER if self.goes_on else 1)
        self.work = 0
        if len(graph.nodes) > MOST_NODES:
            raise TooLarge

    def at(self, point: Point) -> Found:
        """Return rank and null space at a point. Raises one of NO_VALUE where the equations have none, or TooLarge."""
        known = len(self.unknown)
        whole, states, idle = Elimination(self.columns), Elimination(known), 0
        for block in (self._steps if self.program.time == DISCRETE else self._derivatives)(point):
            grown = [whole.take(row) | states.take(row[:known]) for row in block]
            self._count(len(block) * self.columns * whole.rank)
            idle = 0 if any(grown) else idle + 1
            if whole.rank == self.columns or (idle == _IDLE and not self.goes_on):
                break
        return Found(whole.rank, states.rank, whole.null_space())

    def _beginning(self) -> list[list[list[Decimal]]]:
        """Return ∂x(0)/∂(unknown x(0), θ)."""
        return [
            [[Decimal(int(j < len(self.unknown) and self.unknown[j] == i))] for j in range(self.columns)]
            for i in range(self.n)
        ]

    def _count(self, products: int) -> None:
        self.work += products
        if self.work > WORK:
            raise TooLarge

    def _derivatives(self, point: Point) -> Iterator[list[list[Decimal]]]:
        """Yield, for k = 0, 1, …, the k-th Taylor coefficient of ∂y/∂(x, θ), one row per output."""
        series = Series(self.graph, self.roots, self.still)
        states = {name: i for i, name in enumerate(self.program.states)}
        X = self._beginning()

        def value(name: str, k: int) -> Decimal:
            if name in states and k:
                return series.at[self.f[states[name]]][k - 1] / k
            if name == "t" and k:
                return Decimal(int(k == 1))
            return point.inputs[name][k] if name in point.inputs else point.values[name]

        for k in range(self.orders):
            self._count((series.moving + self.entries * self.columns) * (k + 1))
            series.extend(value)
            yield [self._row(series, row, X, k) for row in self.H]
            for i, row in enumerate([self._row(series, row, X, k) for row in self.F]):
                for j, v in enumerate(row):
                    X[i][j].append(v / (k + 1))

    def _row(self, series: Series, slopes: Mapping[int, int], X: list, k: int) -> list[Decimal]:
        """Return coefficient k of Σ slope · ∂x/∂(x, θ) plus the direct terms."""
        row, shift = [], self.n - len(self.unknown)
        for j in range(self.columns):
            direct = slopes.get(j + shift) if j >= len(self.unknown) else None
            total = Decimal(0) if direct is None else series.at[direct][k]
            for i, node in slopes.items():
                if i < self.n and any(X[i][j]):
                    total += convolve(series.at[node], X[i][j], k)
            row.append(total)
        return row

    def _steps(self, point: Point) -> Iterator[list[list[Decimal]]]:
        """Yield, for k = 0, 1, …, ∂y/∂(x, θ) after k steps."""
        x = {name: point.values[name] for name in self.program.states}
        X = self._beginning()
        for k in range(self.orders):
            series = Series(self.graph, self.roots, self.still)
            here = {**point.values, **x, **{name: values[k] for name, values in point.inputs.items()}}
            here["t"] = point.values["t"] + k * point.values.get("period", Decimal(0))
            self._count(len(series.order) + self.entries * self.columns)
            series.extend(lambda name, _, here=here: here[name])
            yield [self._row(series, row, X, 0) for row in self.H]
            X = [[[v] for v in self._row(series, row, X, 0)] for row in self.F]
            x = {name: series.at[node][0] for name, node in zip(self.program.states, self.f, strict=True)}
