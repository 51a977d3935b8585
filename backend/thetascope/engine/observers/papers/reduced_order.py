"""Reduced-order observer for MIMO nonlinear time-varying plants: eq. (17) of the paper named in normal_form.py.

    ω' = (Ã − HC̃)(ω + Hy) + B̃ [α(ẑ, t) + F(ẑ, t) u],   ẑ = (y1, ω1 + H1 y1, y2, ω2 + H2 y2, …)        (17)

Only unmeasured coordinates are estimated: in the normal form (6) the coordinates of each output but the first, n − m in
all. Ã, B̃, C̃ are the chains of integrators shortened by one, H is block diagonal with one column an output. α + F u
is the highest derivative of the outputs at x̂, so the observer is written down for the plant's own states.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model, symbols
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.forms.normal_form import PAPER, NormalForm, block_column, brunovsky, normal_form
from thetascope.engine.observers.forms.wished_poles import POLES, injection
from thetascope.engine.observers.papers.reduced_order_rates import linear_part, rates
from thetascope.engine.observers.support.common_checks import NO_VALUE, stable, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import RATE_TO_ORDER
from thetascope.engine.observers.support.draft import Draft, Matrix, ModelAt
from thetascope.engine.observers.support.kalman_defaults import pace
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol


def default_H(context: Context) -> list[float]:
    """Return H for the wished poles (Remark 3); by default all are at five times the plant's rate."""
    blocks = [rho - 1 for rho in normal_form(Model(context.model)).blocks]
    if (wished := injection(context, blocks)) is not None:
        return wished
    return [comb(size, i) * (5.0 * pace(context)) ** i for size in blocks for i in range(1, size + 1)]


def hidden_names(context: Context) -> list[str]:
    """Return the labels of the unmeasured coordinates: the time-varying Lie derivatives of each output."""
    form = normal_form(Model(context.model))
    return [form.coordinate_names[k] for k in form.unmeasured]


def orders(blocks: Iterable[int]) -> list[int]:
    """Return 1, 2, … for the rows of each block: they multiply an output's error in the rate of its derivatives."""
    return [i for size in blocks for i in range(1, size + 1)]


H = Gain(
    "H",
    Message("gain.injection-h"),
    default_H,
    None,
    size="n-m",
    rows=hidden_names,
    symbol="H",
    unit=RATE_TO_ORDER,
    orders=lambda context: orders([rho - 1 for rho in normal_form(Model(context.model)).blocks]),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant without a normal form."""
    form = normal_form(d.model)
    blocks = [rho - 1 for rho in form.blocks]
    A, B, C = brunovsky(blocks)
    H, y = block_column(d.gain("H"), blocks), d.measured()
    omega = d.states("omega", sum(blocks), initial=initial(d, form) - H @ y)
    hidden = d.let("hidden", omega + H @ y)  # (14)
    z = dict(zip((*form.firsts, *form.unmeasured), (*y, *hidden), strict=True))
    x, at = at_coordinates(d, form, [z[k] for k in range(d.n)])
    top = d.let("top", at.matrix(form.top))  # α(ẑ, t) + F(ẑ, t) u

    d.set(omega, (A - H @ C) @ hidden + B @ top)  # (17)
    d.estimates(x, None, at.h)
    d.outputs("top", top)  # for Remark 1
    describe(d, form, at)


def at_coordinates(d: Draft, form: NormalForm, z: Iterable[Expr]) -> tuple[Matrix, ModelAt]:
    """Return x̂ = T⁻¹(ẑ, t) (n×1) and the model at it."""
    x = d.let("x", Matrix(form.from_z(z).xreplace(parameters(d))))
    return x, d.at(x)


def initial(d: Draft, form: NormalForm) -> Matrix:
    """Return the unmeasured coordinates at the start (n − m × 1).

    That is T(x, 0) with the initial estimates for x, and with the measurement for the states that the outputs alone
    determine.
    """
    outputs = {form.z[k]: y for k, y in zip(form.firsts, d.measured(), strict=True)}
    start = dict(zip(d.model.x, d.x0, strict=True))
    start |= {x: e.xreplace(outputs) for x, e in form.from_outputs.items()}
    z = form.T.xreplace(start).xreplace(parameters(d))
    return column([z[k] for k in form.unmeasured])


def parameters(d: Draft) -> dict[Symbol, Symbol]:
    """Return the symbol of each of the plant's parameters in an observer."""
    return dict(zip(d.model.parameters, symbols("m", d.model.parameter_names), strict=True))


def describe(d: Draft, form: NormalForm, at: ModelAt) -> None:
    """Facts for the report, and the decoupling matrix for the checks."""
    d.facts["relative degree"] = list(form.blocks)
    d.facts["coordinates"] = [f"{z} = {e}" for z, e in zip(form.z, form.T, strict=True)]
    d.facts["inverse"] = [f"{x} = {e}" for x, e in form.inverse.items()]
    d.facts["affine"] = not (form.top.jacobian(sympy.Matrix(d.model.x)).free_symbols & set(d.model.x))
    d.facts["inputs"] = len(d.model.inputs)
    if form.F.shape[1]:
        d.outputs("F", at.matrix(form.F))


# ---- the assumptions of Theorem 2 ------------------------------------------------------------------------------------


def checks(run: Observed) -> list[Check]:
    """Check the assumptions of Theorem 2."""
    blocks = [rho - 1 for rho in run.facts["relative degree"]]
    return [
        relative_degree(run),
        decoupling(run),
        *eigenvalues(run, "Ã − HC̃", "H", blocks, "eq. (16)"),
        local(run),
        *rates(run, blocks),
    ]


def eigenvalues(run: Observed, matrix: str, gain: str, blocks: list[int], equation: str) -> list[Check]:
    """Check that the chains of integrators are stable with these gains; nothing where all chains are empty."""
    if not sum(blocks):
        return []
    return [stable(matrix, linear_part(run.gains(gain), blocks), f"{PAPER}, {equation}")]


def relative_degree(run: Observed) -> Check:
    """Check that the vector relative degree sums to n; a plant where it does not is refused before."""
    degrees = run.facts["relative degree"]
    total = sum(degrees)
    text = Message("check.relative-degree.sum", degrees=degrees, total=total, coordinates=run.facts["coordinates"])
    source = f"{PAPER}, Definition 2 and Assumption 1"
    return Check(Message("check.relative-degree"), verdict(True), text, float(total), float(run.context.n), source)


def decoupling(run: Observed) -> Check:
    """Check (4), that the decoupling matrix is nonsingular along the estimates of this run (smallest |det|)."""
    name, source, m, inputs = Message("check.decoupling"), f"{PAPER}, eq. (4)", run.context.m, run.facts["inputs"]
    if inputs != m:
        text = Message("check.decoupling.not-square", outputs=m, inputs=inputs)
        return Check(name, CANNOT_TELL, text, source=source)
    F = run.matrix("F", m, m)
    F = F[np.isfinite(F).all(axis=(1, 2))]
    if not len(F):
        return Check(name, CANNOT_TELL, NO_VALUE, None, 0.0, source)
    value = float(np.abs(np.linalg.det(F)).min())
    return Check(name, verdict(value > 1e-12), Message("check.decoupling.smallest", value=value), value, 0.0, source)


def local(run: Observed) -> Check:
    """Check Assumption 2, α and F Lipschitz, which decides where the observer converges."""
    affine = run.facts["affine"]
    text = Message("check.alpha-f-lipschitz.affine" if affine else "check.alpha-f-lipschitz.local")
    source = f"{PAPER}, Assumption 2, Remark 4"
    return Check(Message("check.alpha-f-lipschitz"), verdict(True if affine else None), text, source=source)


OBSERVER = Observer(
    id="reduced-order",
    source=f"{PAPER}, eq. (17)",
    gains=(H,),
    options=(POLES,),
    write=write,
    checks=checks,
    estimates_theta=False,
    equations=(
        ("(17)", "ω̇ = (Ã − HC̃)(ω + Hy) + B̃[α(ẑ, t) + F(ẑ, t)u]"),
        ("(14)", "ẑ = (y, ω + Hy)"),
        ("", "x̂ = T⁻¹(ẑ, t)"),
        ("(3)", "T(x, t) = (h, Lh, …)"),
        ("", "Lφ = {∂φ / ∂t} + {∂φ / ∂x}f"),
    ),
    where=(
        ("ω", Message("symbol.omega-unmeasured")),
        ("T", Message("symbol.normal-coordinates")),
    ),
)
