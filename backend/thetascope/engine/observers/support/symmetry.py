"""Verify matrices declared as symmetric, of which only the upper triangle is computed."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.compiler.lowering import numbers
from thetascope.engine.observers.support.matrices import Matrix

if TYPE_CHECKING:
    from sympy import Expr, Symbol

MOST_PAIRS = 20  # most entries per matrix that are compared with their mirror images
TOLERANCE = 1e-6  # relative
_POINTS = 32  # neighbouring points: there a true difference is the same, an error of rounding is not at all of them
_APART = 1e-10  # relative distance of these points


def require_symmetric(
    claims: Sequence[tuple[str, Matrix]], definitions: Sequence[tuple[Symbol, Expr]], states: Sequence[Matrix]
) -> None:
    """Raise ValueError naming the first matrix that is not symmetric at a random point.

    Args:
        claims: (name, value) of each matrix that is claimed to be symmetric.
        definitions: the intermediate results that the values use, in order.
        states: symmetric matrices of states. They are positive definite at the point, as covariances are.
    """
    draw = random.Random(1)
    pairs: list[tuple[str, Expr, Expr]] = []
    for name, value in claims:
        entries, size = value.entries, value.shape[0]
        places = [(i, j) for i in range(size) for j in range(i + 1, size) if entries[i, j] != entries[j, i]]
        for i, j in draw.sample(places, min(MOST_PAIRS, len(places))):
            pairs.append((f"{name}[{i}, {j}]", entries[i, j], entries[j, i]))
    if not pairs:
        return
    expressions = [e for _, upper, lower in pairs for e in (upper, lower)]
    free = {s.name for _, e in definitions for s in e.free_symbols} | {
        s.name for e in expressions for s in e.free_symbols
    }
    point = {name: draw.uniform(0.5, 1.5) for name in sorted(free - {s.name for s, _ in definitions})}
    for P in states:
        point |= {P[i, i].name: P.shape[0] + draw.uniform(1, 2) for i in range(P.shape[0])}
    moved = {
        name: value * (1 + _APART * np.array([draw.uniform(-1, 1) for _ in range(_POINTS)]))
        for name, value in point.items()
    }
    values = numbers(expressions, moved, definitions)
    for k, (name, _, _) in enumerate(pairs):
        upper, lower = values[2 * k], values[2 * k + 1]
        with np.errstate(invalid="ignore"):
            apart = upper - lower
        finite = np.isfinite(apart).all()
        if finite and (np.abs(apart) > TOLERANCE * np.maximum(np.abs(upper), np.abs(lower))).all() and _same(apart):
            both = f"({upper[0]:.6g}, {lower[0]:.6g})"
            raise ValueError(f"{name} should be symmetric, but its mirror image differs {both}")


def _same(differences: np.ndarray) -> bool:
    """Return whether differences are alike at neighbouring points, which errors of rounding are not."""
    return float(np.ptp(differences)) < 0.1 * float(np.abs(differences).max())
