"""The uniformly observable canonical form of Zhao, Li & Li 2012, eqs. (2)–(5), by Lie derivatives.

The map z = T(x) = (h, L_f h, …, L_f^{n−1} h), where f is the drift (zero inputs), is never inverted: the observer
ẑ' = F(ẑ) + G r in canonical coordinates is x̂' = f(x̂) + (∂T/∂x)⁻¹ G r in the plant's coordinates. A plant written in
the triangular form (3)–(5) keeps its coordinates.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.compiler.lowering import numbers
from thetascope.engine.errors import SpecError
from thetascope.engine.language.derivatives import jacobian
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.forms.sizes import TooLarge, cancels, check_jacobian, expanded, lie_derivative
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Matrix

_BALANCINGS = 20  # of rows and columns, before the rank of a matrix is taken
_RANK = 1e-9  # singular values below it count as zero, with entries of size one


@dataclass(frozen=True)
class CanonicalForm:
    """T (n×1) and its Jacobian J (n×n) in the model's symbols; ``identity`` if the plant already has the form."""

    T: ImmutableMatrix
    J: ImmutableMatrix
    identity: bool
    triangular: bool | None  # whether inputs enter as (5) requires; None: not decided


def canonical_form(model: Model) -> CanonicalForm:
    """Return T for a plant with one output. Raises SpecError with the reason where it does not exist."""
    if model.m != 1:
        raise _refused(model, Message("observer.reason.outputs", outputs=model.m))
    if model.time != "continuous":
        raise _refused(model, Message("observer.reason.discrete"))
    x = sympy.Matrix(model.x)
    f = model.f.xreplace(model.expansion)
    try:
        if _is_chain(model, f):
            return CanonicalForm(sympy.ImmutableMatrix(x), sympy.ImmutableMatrix(sympy.eye(model.n)), True, True)
        lie = _map(model, f.subs({u: 0 for u in model.u}))
    except TooLarge as why:
        raise _refused(model, why.message) from None
    map_ = sympy.Matrix(lie)
    outside = map_.free_symbols - set(model.x) - set(model.parameters)
    if outside:
        names = sorted(s.name for s in outside)
        raise _refused(model, Message("observer.reason.moving-coordinates", names=names))
    J = jacobian(map_, model.x).applyfunc(tidy)
    points = [sample(model, seed) for seed in range(8)]
    rank = max(rank_at(J, p) for p in points)
    if rank < model.n:
        raise _refused(model, Message("observer.reason.rank", rank=rank, states=model.n))
    return CanonicalForm(
        sympy.ImmutableMatrix(map_),
        sympy.ImmutableMatrix(J),
        sympy.eye(model.n) == J,
        _triangular(model, f, J, lie, points),
    )


def _map(model: Model, drift: Matrix) -> list[Expr]:
    """Return T: the output and its Lie derivatives along the drift. Raises TooLarge, also for ∂T/∂x."""
    lie = [model.h.xreplace(model.expansion)[0]]
    for _ in range(model.n - 1):
        lie.append(tidy(lie_derivative(lie[-1], model.x, drift)))
    check_jacobian(lie, model.x)
    return lie


def _is_chain(model: Model, f: Matrix) -> bool:
    """Return whether the plant is written in the form (3)–(5): y = x1, x_i' = x_{i+1} + f_i(x1…xi, u, φ, t)."""
    if model.h.xreplace(model.expansion)[0] != model.x[0]:
        return False
    rest = [expanded(f[i] - model.x[i + 1]) for i in range(model.n - 1)]
    return not any(e.free_symbols & set(model.x[i + 1 :]) for i, e in enumerate(rest))


def _refused(model: Model, why: Message) -> SpecError:
    return SpecError("observers.kind", model.id, Message("observer.canonical-form.none", why=why))


def tidy(e: Expr) -> Expr:
    """Return an expression with common factors cancelled, if it is rational and short enough for that."""
    return sympy.cancel(e) if e.is_rational_function() and e.count_ops() < 200 and cancels(e) else e


def sample(model: Model, seed: int) -> dict[str, float]:
    """Return a point near the plant's initial state and inside its domain, with the given parameters."""
    draw = random.Random(seed)
    point = {p["name"]: p["value"] for p in model.data["parameters"]}
    for s in model.data["states"]:
        low, high = s.get("domain") or (None, None)
        width = (high - low) / 4 if low is not None and high is not None else 1.0
        reach = 0.7 * abs(s["initial"]) or 0.2 * width
        value = s["initial"] + reach * draw.uniform(-1, 1) * (seed > 0)
        value = value if low is None else max(value, low)
        point[s["name"]] = value if high is None else min(value, high)
    for name in (*model.inputs, *model.signal_names):
        point[name] = draw.uniform(-1, 1)
    return point | {"t": draw.uniform(0, 10)}


def rank_at(M: Matrix, point: dict[str, float]) -> int:
    """Return the numerical rank of a matrix at a point; 0 where it is not finite. Units of rows and columns cancel."""
    values = numbers(M, point).reshape(M.shape)
    return scaled_rank(values) if np.isfinite(values).all() else 0


def scaled_rank(values: np.ndarray) -> int:
    """Return the rank of a matrix after dividing its rows and columns by their largest entries, several times."""
    rows, columns = np.ones((values.shape[0], 1)), np.ones((1, values.shape[1]))
    for _ in range(_BALANCINGS):
        largest = np.abs(values * rows * columns).max(axis=1, keepdims=True, initial=0.0) ** 0.5
        rows = rows / np.where(largest > 0, largest, 1.0)
        largest = np.abs(values * rows * columns).max(axis=0, keepdims=True, initial=0.0) ** 0.5
        columns = columns / np.where(largest > 0, largest, 1.0)
    return int(np.linalg.matrix_rank(values * rows * columns, tol=_RANK))


def _triangular(model: Model, f: Matrix, J: Matrix, lie: list, points: list[dict[str, float]]) -> bool | None:
    """Return whether (5) holds: input term i depends on the canonical z1 … zi only. Tested at several points."""
    undecided = False
    for u in model.u:
        g = jacobian(f, [u])
        for i in range(model.n - 1):
            term = (jacobian([lie[i]], model.x) * g)[0]
            gradient = jacobian([term], model.x)
            if not any(gradient):
                continue
            for point in points:
                above = J[: i + 1, :]
                with_it = above.col_join(gradient)
                if rank_at(above, point) != i + 1:
                    undecided = True
                elif rank_at(with_it, point) > i + 1:
                    return False
    return None if undecided else True
