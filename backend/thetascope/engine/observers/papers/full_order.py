"""Full-order observer in the normal form (6) of normal_form.py: the baseline for the reduced-order observer.

    ẑ' = A ẑ + B [α(ẑ, t) + F(ẑ, t) u] + L (y − C ẑ)

L is block diagonal with one column an output, like H of the reduced-order observer; A − LC must be stable.
"""

from __future__ import annotations

from math import comb

from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import Check
from thetascope.engine.observers.forms.normal_form import PAPER, block_column, brunovsky, normal_form
from thetascope.engine.observers.forms.wished_poles import POLES, injection
from thetascope.engine.observers.papers.reduced_order import (
    at_coordinates,
    decoupling,
    describe,
    eigenvalues,
    local,
    orders,
    parameters,
    relative_degree,
)
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import RATE_TO_ORDER
from thetascope.engine.observers.support.draft import Draft, Matrix
from thetascope.engine.observers.support.kalman_defaults import pace
from thetascope.messages import Message


def default_L(context: Context) -> list[float]:
    """Return L for the wished poles of A − LC, block after block; by default all are at ten times the plant's rate."""
    blocks = normal_form(Model(context.model)).blocks
    if (wished := injection(context, blocks)) is not None:
        return wished
    return [comb(rho, i) * (10.0 * pace(context)) ** i for rho in blocks for i in range(1, rho + 1)]


L = Gain(
    "L",
    Message("gain.injection-l"),
    default_L,
    None,
    size="n",
    rows=lambda context: normal_form(Model(context.model)).coordinate_names,
    symbol="L",
    unit=RATE_TO_ORDER,
    orders=lambda context: orders(normal_form(Model(context.model)).blocks),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant without a normal form."""
    form = normal_form(d.model)
    A, B, C = brunovsky(form.blocks)
    L = block_column(d.gain("L"), form.blocks)
    start = Matrix(form.T.xreplace(dict(zip(d.model.x, d.x0, strict=True))).xreplace(parameters(d)))
    z = d.states("z", d.n, initial=start)
    x, at = at_coordinates(d, form, z)
    top = d.let("top", at.matrix(form.top))  # α(ẑ, t) + F(ẑ, t) u
    r = d.let("r", d.measured() - C @ z)

    d.set(z, A @ z + B @ top + L @ r)
    d.estimates(x, None, C @ z)
    describe(d, form, at)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions of the normal form, and A − LC."""
    blocks = run.facts["relative degree"]
    return [
        relative_degree(run),
        decoupling(run),
        *eigenvalues(run, "A − LC", "L", blocks, "eq. (7)"),
        local(run),
    ]


OBSERVER = Observer(
    id="full-order",
    source=f"{PAPER}, eq. (6) with output injection",
    gains=(L,),
    options=(POLES,),
    write=write,
    checks=checks,
    estimates_theta=False,
    equations=(
        ("(6)", "ż̂ = Aẑ + B[α(ẑ, t) + F(ẑ, t)u] + L(y − Cẑ)"),
        ("", "x̂ = T⁻¹(ẑ, t)"),
    ),
    where=(
        ("T", Message("symbol.normal-coordinates")),
        ("L", Message("symbol.injection-columns")),
    ),
)
