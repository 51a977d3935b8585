"""The flow of the plant's model over one sample interval, with its exact derivatives.

Continuous plants: classical Runge–Kutta steps of x' = f(x) + Φ(x)θ, with θ constant over the interval. The derivatives
are those of the Runge–Kutta map itself: every stage is differentiated. S = ∂(state at the stage)/∂(x, θ) goes through
the same stages, with ∂k = A S + [0 Φ]. Where the model is saturated, A and Φ are taken at the saturated point.
Discrete-time plants: the plant's own map.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.observers.support.declaration import Context, Option
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.matrices import Matrix, block, column, eye, zeros
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Rational

MOST = 20  # substeps


def _default_substeps(c: Context) -> int:
    """Return the number of substeps that keeps each within ten of the simulation's own steps, up to MOST."""
    return max(1, min(MOST, -int(-c.period // (10 * c.step)))) if c.step > 0 else 1


SUBSTEPS = Option("substeps", Message("option.substeps"), "integer", _default_substeps, low=1, high=MOST)

# the classical Runge–Kutta method: where each stage is taken, in half substeps, and its weight
STAGES = ((0, 1), (1, 2), (1, 2), (2, 1))


class Flow(NamedTuple):
    """The state at the end of the interval (n×1), and its derivatives F in x (n×n) and Phi in θ (n×p)."""

    x: Matrix
    F: Matrix
    Phi: Matrix


def flow(d: Draft, name: str, x: Matrix, theta: Matrix) -> Flow:
    """Carry the estimate x over one sample interval with θ constant. ``name`` is unique in the draft."""
    n, p = d.n, d.p
    if d.model.time == DISCRETE:
        at = d.at(x, theta)
        return Flow(d.let(f"{name}.x", at.f + at.Phi @ theta), d.let(f"{name}.F", at.A), d.let(f"{name}.Phi", at.Phi))
    S: Matrix | None = block([[eye(n), zeros(n, p)]])
    for i, start, length in _substeps(d):
        x, S = _step(d, f"{name}.{i}", x, S, theta, start, length)
        x, S = _events(d, f"{name}.{i}", x, S, start + length)
    assert S is not None
    return Flow(x, S[:, :n], S[:, n:])


def carried(d: Draft, name: str, x: Matrix, theta: Matrix) -> Matrix:
    """Carry the estimate x over one sample interval, as :func:`flow`, without derivatives (n×1)."""
    if d.model.time == DISCRETE:
        at = d.at(x, theta)
        return d.let(f"{name}.x", at.f + at.Phi @ theta)
    for i, start, length in _substeps(d):
        x, _ = _step(d, f"{name}.{i}", x, None, theta, start, length)
        x, _ = _events(d, f"{name}.{i}", x, None, start + length)
    return x


def _events(d: Draft, name: str, x: Matrix, S: Matrix | None, end: Rational) -> tuple[Matrix, Matrix | None]:
    """Return x and S after the plant's events at the end of a substep."""
    if not d.model.events:
        return x, S
    moved, slopes = d.events_at(f"{name}.events", list(x), end, S)
    after = column(moved)
    return after, S if S is None else Matrix(sympy.ImmutableMatrix(slopes), "", d)


def _substeps(d: Draft) -> list[tuple[int, Rational, Rational]]:
    """The number, start and length of each substep; start and length as fractions of the interval."""
    count = int(str(d.options.get("substeps", 1)))
    return [(i, sympy.Rational(i, count), sympy.Rational(1, count)) for i in range(count)]


def _step(
    d: Draft, name: str, x: Matrix, S: Matrix | None, theta: Matrix, start: Rational, length: Rational
) -> tuple[Matrix, Matrix | None]:
    """One Runge–Kutta step over [start, start + length] of the interval; S is not carried where it is None."""
    h = length * d.period
    k, dk = zeros(d.n), zeros(d.n, d.n + d.p)
    rise, dS = zeros(d.n), zeros(d.n, d.n + d.p)
    for j, (halves, weight) in enumerate(STAGES):
        c = sympy.Rational(halves, 2)
        at = d.at(d.let(f"{name}.x{j}", x + c * h * k), theta, start + c * length)
        k = d.let(f"{name}.k{j}", at.f + at.Phi @ theta)
        rise = rise + weight * k
        if S is not None:
            stage = d.let(f"{name}.S{j}", S + c * h * dk)
            dk = d.let(f"{name}.dk{j}", at.A @ stage + block([[zeros(d.n, d.n), at.Phi]]))
            dS = dS + weight * dk
    if S is not None:
        S = d.let(f"{name}.S", S + h / 6 * dS)
    return d.let(f"{name}.x", x + h / 6 * rise), S
