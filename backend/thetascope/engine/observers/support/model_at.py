"""The plant's model at an estimate, written into a Draft: f, h, Φ, Ψ and the Jacobians A and C."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Definition, Model, clock, symbols
from thetascope.engine.observers.support.matrices import Matrix, column, expression

if TYPE_CHECKING:
    from sympy import Expr, Rational, Symbol

START, MIDDLE, END, NOW = "", "mid.", "end.", "now."
"""Instants of a sample interval: just after its start, its middle, just before its end; and the end itself, at which y
is measured, just after any jump there."""


@dataclass(frozen=True)
class ModelAt:
    """The plant's model at an estimate.

    f (n×1), h (m×1), Phi (n×p), Psi (m×p) and the Jacobians A (n×n), C (m×n) are saturated to the plant's physical
    domain; the estimate is not. A is the Jacobian of f + Φθ̂ in x, C that of h + Ψθ̂, with the given θ̂, or zero by
    default.
    """

    f: Matrix
    h: Matrix
    Phi: Matrix
    Psi: Matrix
    jacobians: Callable[[], tuple[Matrix, Matrix]]
    put: Callable[[Expr], Expr]
    """Replaces the model's own symbols in an expression by their values at this estimate."""

    @cached_property
    def A(self) -> Matrix:
        """Return ∂(f + Φθ̂)/∂x (n×n)."""
        return self.jacobians()[0]

    @cached_property
    def C(self) -> Matrix:
        """Return ∂(h + Ψθ̂)/∂x (m×n)."""
        return self.jacobians()[1]

    def matrix(self, entries: Any) -> Matrix:
        """Return a SymPy matrix in the model's own symbols at this estimate."""
        return Matrix(sympy.ImmutableMatrix(entries).applyfunc(self.put))


class Points:
    """Writes the model at estimates, for ``Draft.at``.

    Args:
        channels: the fault channels, the columns of Φ and Ψ.
        period: the symbol of the sample period.
        let: names an intermediate scalar.
    """

    def __init__(self, channels: Sequence[str], period: Symbol, let: Callable[[str, Expr], Expr]) -> None:
        self.channels, self.period, self.let = tuple(channels), period, let
        self._count = 0
        self._between: dict[tuple[str, Rational], list[Expr]] = {}

    def at(
        self, model: Model, x: Iterable[Expr], theta: Sequence[Expr] | None, when: str | Rational, saturate: bool
    ) -> ModelAt:
        """Return the model at an estimate; see ``Draft.at``."""
        self._count += 1
        mark = f"m{self._count}"
        estimate = [expression(e) for e in x]
        plain: dict[Symbol, Expr] = dict(zip(model.x, estimate, strict=True)) | self.known(model, when)
        inside = dict(plain)
        if saturate:
            for s, e in zip(model.x, estimate, strict=True):
                inside[s] = self.let(f"{mark}.{s.name}", _clip(e, *map(_number, model.domain(s.name))))
        for d in model.definitions:
            inside[d.symbol] = self.let(f"{mark}.{d.symbol.name}", _clipped(d, inside, saturate))
        plain |= {d.symbol: inside[d.symbol] for d in model.definitions}

        def put(e: Expr) -> Expr:
            return e.xreplace(inside)

        f = [e.xreplace(plain if affine else inside) for e, affine in zip(model.f, model.is_affine, strict=True)]
        affine_h = [not (model.jacobian(sympy.Matrix([e])).free_symbols & set(model.x)) for e in model.h]
        h = [e.xreplace(plain if affine else inside) for e, affine in zip(model.h, affine_h, strict=True)]
        Phi, Psi = (Matrix(M(self.channels).applyfunc(put)) for M in (model.Phi, model.Psi))
        return ModelAt(column(f), column(h), Phi, Psi, lambda: self._jacobians(model, theta, put), put)

    def known(self, model: Model, when: str | Rational) -> dict[Symbol, Expr]:
        """Return inputs, known signals, parameters and t at an instant."""
        instants = {START: sympy.S.Zero, MIDDLE: sympy.S.Half, END: sympy.S.One, NOW: sympy.S.One}
        fraction = instants[when] if isinstance(when, str) else when
        swap: dict[Symbol, Expr] = {}
        for known, prefix, names in ((model.u, "u", model.inputs), (model.signals, "signal", model.signal_names)):
            values = symbols(f"{when}{prefix}", names) if isinstance(when, str) else self._at(prefix, names, when)
            swap |= dict(zip(known, values, strict=True))
        swap |= dict(zip(model.parameters, symbols("m", model.parameter_names), strict=True))
        if fraction:
            swap[clock()] = clock() + fraction * self.period
        return swap

    def _at(self, prefix: str, names: Sequence[str], fraction: Rational) -> Sequence[Expr]:
        """Return known quantities at a fraction of the sample interval: the parabola through START, MIDDLE and END."""
        start, middle, end = (symbols(f"{when}{prefix}", names) for when in (START, MIDDLE, END))
        exact = {sympy.S.Zero: start, sympy.S.Half: middle, sympy.S.One: end}
        if fraction in exact:
            return exact[fraction]
        if (prefix, fraction) not in self._between:
            by_middle, by_end = 4 * fraction * (1 - fraction), fraction * (2 * fraction - 1)
            self._between[prefix, fraction] = [
                self.let(f"{prefix}.{n}.at{fraction}", a + by_middle * (b - a) + by_end * (c - a))
                for n, a, b, c in zip(names, start, middle, end, strict=True)
            ]
        return self._between[prefix, fraction]

    def _jacobians(
        self, model: Model, theta: Sequence[Expr] | None, put: Callable[[Expr], Expr]
    ) -> tuple[Matrix, Matrix]:
        A, C = model.jacobian(model.f), model.jacobian(model.h)
        if theta is not None and self.channels:
            Phi, Psi = model.Phi(self.channels), model.Psi(self.channels)
            marks = [sympy.Symbol(f"theta#{j}") for j in range(len(self.channels))]
            for j, mark in enumerate(marks):  # ∂(Φθ)/∂x, one channel at a time
                A = A + model.jacobian(Phi[:, j]) * mark
                C = C + model.jacobian(Psi[:, j]) * mark
            swap = dict(zip(marks, theta, strict=True))
            A, C = A.xreplace(swap), C.xreplace(swap)
        return Matrix(A.applyfunc(put)), Matrix(C.applyfunc(put))


def _clipped(d: Definition, inside: Mapping[Symbol, Expr], saturate: bool) -> Expr:
    """Return the value of a definition, saturated to its range."""
    value = d.expression.xreplace(inside)
    if not saturate or (d.low is None and d.high is None):
        return value
    low, high = (b.xreplace(inside) if b is not None else None for b in (d.low, d.high))
    return _clip(value, low, high)


def _number(bound: float | None) -> Expr | None:
    return None if bound is None else sympy.Float(bound)


def _clip(value: Expr, low: Expr | None, high: Expr | None) -> Expr:
    if low is not None:
        value = sympy.Max(value, low, evaluate=False)
    return value if high is None else sympy.Min(value, high, evaluate=False)
