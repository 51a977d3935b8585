"""Non-smooth observer of sandwich systems with hysteresis: Zhou & Tan 2012, eq. (13), in the plant's discrete time.

    x̂(k+1) = Â(k) x̂(k) + B u(k) + η̂(k) + K (y(k) − ŷ(k))                    (13), (21)

is the plant's own text (11) at the estimates, f(x̂, u) = Â(k) x̂ + B u + η̂(k): Â and η̂ switch with the zone that each
operator is in at x̂. K corrects the states of L1 and L2; the memories of the operators follow the estimates. The paper
does not give x̂(−1). By default x̂ did not move before k = 0, so Δx̂(0) = 0 and all operators hold; the option
``before`` changes that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thetascope.engine.language.lazy_sympy import functions
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.forms.sandwich_parts import Sandwich, before, input_matrix
from thetascope.engine.observers.papers.sandwich_common import (
    SOURCE,
    K,
    begin,
    bounds,
    describe,
    injection,
    linear_checks,
    rank_check,
)
from thetascope.engine.observers.support.common_checks import NO_VALUE, verdict
from thetascope.engine.observers.support.declaration import Observed, Observer, Option
from thetascope.engine.observers.support.draft import Draft, Matrix
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Symbol

RISING, FALLING = 1, -1

BEFORE = Option(
    "before",
    Message("option.before"),
    "choice",
    "hold",
    ("hold", "given"),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError for a plant that is not a sandwich system."""
    parts = begin(d)
    x, u = d.estimate_of_state(start(d, parts)), d.inputs()
    at = d.at(x)
    A, B = at.A, at.matrix(input_matrix(d.model))  # Â(k) switches with the zones of the operators at x̂
    eta = at.f - A @ x - B @ u  # η̂(k): the offsets and memories of the operators
    r = d.let("r", (d.measured() - at.h)[0])

    d.set(x, A @ x + B @ u + eta + injection(d, parts) * r)  # (13)
    d.estimates(x, None, at.h)
    for i, o in enumerate(parts.operators, 1):
        rising, falling = o.zones()
        d.output(f"zone.{i}", at.put(RISING * rising + FALLING * falling))
    for s in hysteresis_outputs(d):
        d.output(s.name, at.put(s))
    d.facts["zones"] = [f"zone.{i + 1}" for i in range(len(parts.operators))]
    d.facts["hysteresis"] = [s.name for s in hysteresis_outputs(d)]
    describe(d, parts, at)


def start(d: Draft, parts: Sandwich) -> Matrix:
    """Return the initial estimates as given (n×1). With the option ``hold`` the previous x̂ equals the first."""
    initial = dict(zip(d.model.x, d.x0, strict=True))
    if d.options.get("before", "hold") == "hold":
        put = d.at(d.x0, saturate=False).put
        for o in parts.operators:
            state, factor = before(o, d.model.x)
            initial[state] = put(o.args[0]) / factor
    return column([initial[s] for s in d.model.x])


def hysteresis_outputs(d: Draft) -> list[Symbol]:
    """Definitions made of several operators: the output v of the hysteresis (5)."""
    expansion = d.model.expansion
    return [s for s, e in expansion.items() if e.has(functions.Backlash) and not isinstance(e, functions.Backlash)]


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``zone.i``: 1 rising, −1 falling, 0 memory, per operator; the estimated output v of the hysteresis, and
    ``true.v``: v of the model at the true states, the paper's Fig. 3."""
    hysteresis = run.facts["hysteresis"]
    columns = {name: run.values[name] for name in (*run.facts["zones"], *hysteresis)}
    if run.truth is None or run.probe is None or not hysteresis:
        return columns
    states = [f"xh.{state['name']}" for state in run.context.model["states"]]
    true = run.probe(hysteresis, run.values | dict(zip(states, run.truth.x.T, strict=True)))
    return columns | {f"true.{name}": values for name, values in zip(hysteresis, true, strict=True)}


def checks(run: Observed) -> list[Check]:
    """Check the conditions of Theorem 1."""
    return [*bounds(run), *linear_checks(run), zones_check(run), rank_check(run)]


def zones_check(run: Observed) -> Check:
    """Check that each operator is in both linear zones in the second half of the run.

    Once the error of L1 is gone, one visit to a linear zone makes ẑ = z; without one a wrong ẑ stays.
    """
    name = Message("check.zones")
    source = f"{SOURCE}, Theorem 1 (proof)"
    zones = np.array([run.values[z] for z in run.facts["zones"]])
    zones = zones[:, np.isfinite(zones).all(axis=0)]
    late = zones[:, zones.shape[1] // 2 :]
    if not late.shape[1]:
        return Check(name, CANNOT_TELL, NO_VALUE, source=source)
    reached = (late == RISING).any(axis=1) & (late == FALLING).any(axis=1)
    missing = [str(i + 1) for i in np.flatnonzero(~reached)]
    count = int(reached.sum())
    code = "check.zones.missing" if missing else "check.zones.all"
    text = Message(code, count=count, operators=len(reached), missing=missing)
    return Check(name, verdict(not missing), text, float(count), float(len(reached)), source)


OBSERVER = Observer(
    id="sandwich-nonsmooth",
    source="Zhou & Tan 2012, eq. (13)",
    gains=(K,),
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    options=(BEFORE,),
    time="plant",
    estimates_theta=False,
    equations=(
        ("(13)", "x̂(k + 1) = Â(k)x̂(k) + Bu(k) + η̂(k) + K(y(k) − ŷ(k))"),
        ("(5)", "v(k) = ∑ᵢ zᵢ(k)"),
        ("(6)", "zᵢ(k) = g₁mᵢ(x(k) − Dᵢ) + g₂mᵢ(x(k) + Dᵢ) + g₃zᵢ(k − 1)"),
    ),
    where=(
        ("Â", Message("symbol.switched-matrix")),
        ("g₁", Message("symbol.zone-indicators")),
        ("K", Message("symbol.sandwich-correction")),
    ),
)
