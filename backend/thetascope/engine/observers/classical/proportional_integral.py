"""Proportional-integral observer: faults are the integral of the output error, with constant gains.

    x̂' = f(x̂, u) + Φθ̂ + K_P r,   θ̂' = K_I r,   r = y − h(x̂) − Ψθ̂

Wojciechowski 1978; Beale & Shafai, Int. J. Control 50(1), 1989; for nonlinear plants, with the gains of the
linearisation, Söffker, Yu & Müller, Int. J. Systems Science 26(9), 1995. θ̂ has no error where faults are constant and
lags behind ones that move. Excitation is not needed; in exchange, the faults must be distinct at rest, so that there
are at most as many as outputs.

The default gains are those of the linearisation along the healthy run. They move each eigenvalue λ of the augmented
plant (A, Φ; 0, 0) that is slower than ω/2 to −ω − λ̄, so that θ̂ converges like e^(−ωt).
"""

from __future__ import annotations

from thetascope.engine.model.result import Check
from thetascope.engine.observers.classical.design import (
    DISTINCT,
    Point,
    at_rest,
    bandwidth,
    chosen,
    mirrored,
    of_state_and_faults,
    refused,
    requested,
    weights,
)
from thetascope.engine.observers.classical.frozen_checks import distinct_at_rest, error_dynamics
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import FAULT_PER_OUTPUT_SECOND, STATE_PER_OUTPUT_SECOND
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import offer_linearisation
from thetascope.messages import Message

FAST = 4.0  # bandwidth, times the rate at which a run lets a fault be learned
SOURCE = "Beale & Shafai 1989"


def fits(point: Point) -> bool:
    """Return whether constant gains can tell the faults, and the state, apart."""
    return at_rest(point) > DISTINCT


def default_gains(c: Context) -> tuple[list[list[float]], list[list[float]]]:
    """Return K_P (n×m) and K_I (p×m). Raises SpecError where the faults are not distinct at rest."""
    A, C = requested(c, fits).joint
    L = mirrored(A, C, weights(c), bandwidth(c, FAST))
    if L is None:
        raise refused(c, Message("observer.constant.unobservable"))
    return of_state_and_faults(c, L)


K_P = Gain(
    "kp",
    Message("gain.proportional"),
    lambda c: default_gains(c)[0],
    None,
    size="n",
    columns="m",
    symbol="K_P",
    unit=STATE_PER_OUTPUT_SECOND,
)
K_I = Gain(
    "ki",
    Message("gain.integral"),
    lambda c: default_gains(c)[1],
    None,
    size="p",
    columns="m",
    symbol="K_I",
    unit=FAULT_PER_OUTPUT_SECOND,
)


def write(d: Draft) -> None:
    """Write the equations of the observer."""
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    at = d.at(x, theta)
    y_hat = d.let("y_hat", at.h + at.Psi @ theta)
    r = d.let("r", d.measured() - y_hat)

    d.set(x, at.f + at.Phi @ theta + d.gain("kp") @ r)
    d.set(theta, d.gain("ki") @ r)
    d.estimates(x, theta, y_hat)
    offer_linearisation(d, at.A, at.C, at.Phi, at.Psi)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [
        distinct_at_rest(run, SOURCE),
        error_dynamics(run, run.gains("kp"), run.gains("ki"), SOURCE),
    ]


OBSERVER = Observer(
    id="proportional-integral",
    source="Wojciechowski 1978; Beale & Shafai 1989, Int. J. Control 50(1), 97–111; Söffker, Yu & Müller 1995",
    gains=(K_P, K_I),
    write=write,
    checks=checks,
    chooses=lambda c: chosen(c, fits),
    equations=(
        ("", "ẋ̂ = f(x̂, u) + Φθ̂ + Kₚ(y − ŷ)"),
        ("", "θ̇̂ = Kᵢ(y − ŷ)"),
        ("", "ŷ = h(x̂) + Ψθ̂"),
    ),
    where=(("Kᵢ", Message("symbol.integral-gain")),),
)
