"""The flow of the plant's model over one sample interval, with its exact derivatives.

Continuous plants: classical Runge–Kutta steps of x' = f(x) + Φ(x)θ, θ constant over the interval. The derivatives are
those of the Runge–Kutta map itself: every stage is differentiated, so they belong to the very numbers that are used
(S is ∂(state at the stage)/∂(x, θ) and obeys the same stages, with ∂k = A S + [0 Φ]). Where the model is saturated, A
and Φ are taken at the saturated point. Discrete-time plants: the plant's own map.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.observers.support.declaration import Context, Option
from thetascope.engine.observers.support.draft import START, Draft
from thetascope.engine.observers.support.draft_linalg import product

if TYPE_CHECKING:
    from sympy import ImmutableMatrix, Matrix

MOST = 20  # substeps


def _enough(c: Context) -> int:
    """As many as keep a substep within ten of the simulation's own steps, where that is possible."""
    return max(1, min(MOST, -int(-c.period // (10 * c.step)))) if c.step > 0 else 1


SUBSTEPS = Option(
    "substeps", "Runge–Kutta steps of the model in one sample interval", "integer", _enough, low=1, high=MOST
)

# the classical Runge–Kutta method: where each stage is taken, in half substeps, and its weight
STAGES = ((0, 1), (1, 2), (1, 2), (2, 1))


@dataclass(frozen=True)
class Flow:
    """The state at the end of the interval (n×1), and its derivatives F in x (n×n) and Phi in θ (n×p)."""

    x: ImmutableMatrix
    F: ImmutableMatrix | None
    Phi: ImmutableMatrix | None


def flow(d: Draft, name: str, x: Matrix, theta: Matrix, derivatives: bool = True) -> Flow:
    """Carry the estimate x over one sample interval with θ constant. ``name`` must differ from call to call."""
    n, p = d.n, d.p
    if d.model.time == DISCRETE:
        at = d.at(x, theta, START)
        moved = d.let(f"{name}.x", at.f + product(at.Phi, theta))
        return (
            Flow(moved, d.let(f"{name}.F", at.A), d.let(f"{name}.Phi", at.Phi))
            if derivatives
            else Flow(moved, None, None)
        )
    substeps = int(d.options.get("substeps", 1))
    S = sympy.eye(n).row_join(sympy.zeros(n, p)) if derivatives else None
    x = sympy.ImmutableMatrix(x)
    for i in range(substeps):
        x, S = _step(d, f"{name}.{i}", x, S, theta, sympy.Rational(i, substeps), sympy.Rational(1, substeps))
    return Flow(x, S[:, :n], S[:, n:]) if derivatives else Flow(x, None, None)


def _step(
    d: Draft, name: str, x: Matrix, S: Matrix | None, theta: Matrix, start: sympy.Rational, length: sympy.Rational
):
    """One Runge–Kutta step over [start, start + length] of the interval (fractions of the period)."""
    h = length * d.period
    zero = sympy.zeros(d.n, d.p + d.n)
    k, dk = sympy.zeros(d.n, 1), zero
    rise, dS = sympy.zeros(d.n, 1), zero
    for j, (halves, weight) in enumerate(STAGES):
        c = sympy.Rational(halves, 2)
        at = d.at(d.let(f"{name}.x{j}", x + c * h * k), theta, start + c * length)
        k = d.let(f"{name}.k{j}", at.f + product(at.Phi, theta))
        rise = rise + weight * k
        if S is not None:
            stage = d.let(f"{name}.S{j}", S + c * h * dk)
            dk = d.let(f"{name}.dk{j}", product(at.A, stage) + sympy.zeros(d.n, d.n).row_join(at.Phi))
            dS = dS + weight * dk
    S = d.let(f"{name}.S", S + h / 6 * dS) if S is not None else None
    return d.let(f"{name}.x", x + h / 6 * rise), S
