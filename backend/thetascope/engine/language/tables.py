"""Tables y(x) that expressions interpolate: piecewise polynomials, in plain Python.

Linear tables join their points by straight lines. Cubic ones are the monotone interpolant of Fritsch & Butland (SIAM J.
Sci. Stat. Comput. 5, 1984, 300–304; the weights are those of SciPy's PchipInterpolator), which has a continuous slope
and no extremum between points. Beyond the ends a table is constant or continues with the slope at its end.
"""

import hashlib
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from thetascope.engine.language.builtins import sign

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Table:
    """A piecewise polynomial: piece k holds for grid[k − 1] ≤ x < grid[k], the first below and the last beyond all.

    Piece k is (origin, c0, c1, …) with the value c0 + c1 s + c2 s² + …, s = x − origin. The name does not matter to
    equality.
    """

    grid: tuple[float, ...]
    pieces: Rows
    name: str = ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @cached_property
    def digest(self) -> str:
        """Return the SHA-256 of the numbers."""
        return hashlib.sha256(repr((self.grid, self.pieces)).encode()).hexdigest()

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> "Table":
        """Return the table of a plant's data: ``name, x, y, method, outside``; x increases, in one unit throughout."""
        x, y = [float(v) for v in data["x"]], [float(v) for v in data["y"]]
        slopes = monotone_slopes(x, y) if data["method"] == "cubic" else None
        pieces = []
        for k in range(len(x) - 1):
            width = x[k + 1] - x[k]
            secant = (y[k + 1] - y[k]) / width
            if slopes is None:
                pieces.append((x[k], y[k], secant))
                continue
            a, b = slopes[k], slopes[k + 1]
            pieces.append((x[k], y[k], a, (3 * secant - 2 * a - b) / width, (a + b - 2 * secant) / width**2))
        ends = (0.0, 0.0)
        if data["outside"] == "continue":
            ends = (slopes[0], slopes[-1]) if slopes is not None else (pieces[0][2], pieces[-1][2])
        rest = (0.0,) * (len(pieces[0]) - 3)
        first, last = (x[0], y[0], ends[0], *rest), (x[-1], y[-1], ends[1], *rest)
        return cls(tuple(x), (first, *pieces, last), data["name"])

    def piece(self, x: float) -> int:
        """Return the index of the piece at x."""
        return bisect_right(self.grid, x)

    def value(self, x: float, below: bool = False) -> float:
        """Return the value at x; at a point of the grid that of the piece above it, or below it."""
        k = self.piece(x)
        if below and k and self.grid[k - 1] == x:
            k -= 1
        return horner(self.pieces[k], x)

    def slope(self) -> "Table":
        """Return the derivative, a table with the same grid."""
        return Table(self.grid, slope_of(self.pieces), f"{self.name}'")

    @property
    def is_zero(self) -> bool:
        """Return whether the table is 0 everywhere."""
        return not any(any(c[1:]) for c in self.pieces)


def tables_of(plant: Mapping[str, Any]) -> dict[str, Table]:
    """Return the tables of a plant's data by name."""
    return {data["name"]: Table.of(data) for data in plant.get("tables", ())}


def horner(piece: Sequence[float], x: float) -> float:
    """Return the value of a piece at x."""
    s, total = x - piece[0], 0.0
    for c in reversed(piece[1:]):
        total = total * s + c
    return total


def jumps(pieces: Rows) -> bool:
    """Return whether the values differ on both sides of a point of the grid, by more than rounding."""
    size = max(abs(p[1]) for p in pieces)
    return any(abs(horner(a, b[0]) - horner(b, b[0])) > 1e-9 * size for a, b in zip(pieces, pieces[1:], strict=False))


def slope_of(pieces: Rows) -> Rows:
    """Return the pieces of the derivative."""
    if len(pieces[0]) == 2:
        return tuple((origin, 0.0) for origin, _ in pieces)
    return tuple((p[0], *(k * c for k, c in enumerate(p[2:], start=1))) for p in pieces)


def monotone_slopes(x: Sequence[float], y: Sequence[float]) -> list[float]:
    """Return the slopes at the points: weighted harmonic means of the neighbouring secants, 0 at an extremum."""
    h = [b - a for a, b in zip(x, x[1:], strict=False)]
    d = [(b - a) / w for a, b, w in zip(y, y[1:], h, strict=False)]
    if len(d) == 1:
        return [d[0], d[0]]
    inner = [_mean(h[k], h[k + 1], d[k], d[k + 1]) for k in range(len(d) - 1)]
    return [_end(h[0], h[1], d[0], d[1]), *inner, _end(h[-1], h[-2], d[-1], d[-2])]


def _mean(h0: float, h1: float, d0: float, d1: float) -> float:
    if sign(d0) * sign(d1) <= 0:
        return 0.0
    w0, w1 = 2 * h1 + h0, h1 + 2 * h0
    return (w0 + w1) / (w0 / d0 + w1 / d1)


def _end(h0: float, h1: float, d0: float, d1: float) -> float:
    """Return the slope at an end by the formula of three points, limited so that the shape is kept."""
    slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if sign(slope) != sign(d0):
        return 0.0
    return 3 * d0 if sign(d0) != sign(d1) and abs(slope) > 3 * abs(d0) else slope
