"""Conventional observer of sandwich systems: Zhou & Tan 2012, eq. (22), the baseline of the non-smooth one.

    x̂(k+1) = A x̂(k) + B u(k) + K (y(k) − ŷ(k)),   with v = Σ wᵢ mᵢ x for the hysteresis        (22)

The plant's text with each operator replaced by its mean slope times x. It estimates the states of L1 and L2 only.
"""

from __future__ import annotations

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.result import FAILS, Check
from thetascope.engine.observers.forms.sandwich_parts import smooth
from thetascope.engine.observers.papers.sandwich_common import (
    SOURCE,
    K,
    begin,
    describe,
    injection,
    linear_checks,
    rank_check,
)
from thetascope.engine.observers.support.declaration import Observed, Observer
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant that is not a sandwich system."""
    parts = begin(d)
    linear = parts.linear_states
    x = d.states("xh", len(linear), initial=column([d.x0[i] for i in linear]))
    position = {i: k for k, i in enumerate(linear)}
    at = d.at([x[position[i]] if i in position else sympy.S.Zero for i in range(d.n)], model=smooth(d.model))
    r = d.let("r", (d.measured() - at.h)[0])
    following = at.f + injection(d, parts) * r  # A x̂ + B u + K (y − ŷ)
    d.set(x, column([following[i] for i in linear]))  # (22)
    for i in linear:
        d.output(f"x.{d.model.states[i]}", x[position[i]])
    d.output(f"y.{d.model.outputs[0]}", at.h[0])
    describe(d, parts, at)


def checks(run: Observed) -> list[Check]:
    """Check the conditions of Theorem 1, and that there is no hysteresis."""
    return [*linear_checks(run), no_hysteresis(run), rank_check(run)]


def no_hysteresis(run: Observed) -> Check:
    """Check this observer's assumption on the plant, which a sandwich system never meets."""
    count = run.facts["operators"]
    text = Message("check.no-hysteresis.operators", n=count)
    return Check(Message("check.no-hysteresis"), FAILS, text, float(count), 0.0, f"{SOURCE}, eq. (22)")


OBSERVER = Observer(
    id="sandwich-conventional",
    source="Zhou & Tan 2012, eq. (22)",
    gains=(K,),
    write=write,
    checks=checks,
    time="plant",
    estimates_theta=False,
    equations=(
        ("(22)", "x̂(k + 1) = Ax̂(k) + Bu(k) + K(y(k) − ŷ(k))"),
        ("", "v = ∑ᵢ mᵢx"),
    ),
    where=(("v", Message("symbol.constant-slope")),),
)
