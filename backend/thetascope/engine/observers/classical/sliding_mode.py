"""Sliding mode observer: a discontinuous injection holds the output error at zero, and its mean is the fault.

    x̂' = f(x̂, u) + A Gₙ r + Gₙ v,   v = κ r + ν,   νᵢ = ρᵢ sᵢ / √(1 + sᵀs),   sᵢ = rᵢ/δᵢ,   r = y − h(x̂)
    θ̂' = ((CΦ)⁺ v − θ̂)/τ

Edwards & Spurgeon, Sliding Mode Control, 1998, ch. 6; for the fault from the equivalent injection Edwards, Spurgeon &
Patton, Automatica 36, 2000. For a nonlinear plant the canonical form is that of the linearisation along the healthy
run, and the plant's own f is integrated: Yan & Edwards, Automatica 43, 2007.

C Gₙ = I. In the coordinates e = N ε + Gₙ r of their canonical form (C N = 0) the error obeys ε' = F ε, with F the
motion on r = 0, and r' = C A N ε − κ r + CΦθ − ν. Where faults are matched, rank(CΦ) = p, Gₙ decouples ε from them;
the other m − p outputs place F, except for the invariant zeros of (A, Φ, C), which must be stable. ν is the unit vector
with a boundary layer δ: with δ → 0 it chatters at the step of the integration and at the noise; within the layer v is
still exactly (CΦ)θ at rest, because κ r belongs to it.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import (
    Point,
    bandwidth,
    chosen,
    distinctness,
    in_units,
    refused,
    requested,
)
from thetascope.engine.observers.classical.matching import (
    constants,
    faults_in_rates,
    matched,
    matching,
    require_still_outputs,
    slowest_possible,
    swings,
)
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, stability, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import (
    OUTPUT,
    OUTPUT_PER_SECOND,
    RATE,
    SECONDS,
    STATE_PER_OUTPUT,
)
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import offer_linearisation, picked_rows, too_large
from thetascope.engine.observers.support.kalman_defaults import noise_std, output_scales, pace, state_scales
from thetascope.engine.observers.support.matrices import column
from thetascope.messages import Message

FAST = 4.0  # κ and 1/τ, times the rate at which a run lets a fault be learned
LARGEST_FAULT = 5.0  # typical faults that ν can balance
NOISE = 4.0  # standard deviations of the noise within the boundary layer
STEEP = 10.0  # largest ρ/δ, times κ
SOURCE = "Edwards & Spurgeon 1998"


def fits(point: Point) -> bool:
    """Return whether the faults are matched, the outputs independent and the invariant zeros stable."""
    return matched(point) and distinctness(point.C.T) > 1e-6 and sliding_design(point, 1.0) is not None


def sliding_design(point: Point, omega: float) -> np.ndarray | None:
    """Return Gₙ (n×m), scaled; None where the motion on r = 0 is unstable."""
    n, m, effects = len(point.A), len(point.C), point.C @ point.Phi
    back = np.linalg.pinv(effects)
    Q = np.eye(m) - effects @ back
    G = point.Phi @ back + np.linalg.pinv(point.C) @ Q
    if n == m:
        return G
    N = np.linalg.svd(point.C)[2][m:].T
    motion = N.T @ (np.eye(n) - G @ point.C) @ point.A @ N
    X = slowest_possible(motion, Q @ point.C @ point.A @ N, np.ones(m), omega)
    return None if X is None else G + N @ X @ Q


def default_injection(c: Context) -> list[list[float]]:
    """Return Gₙ (n×m) in the plant's units. Raises SpecError for faults that are not matched."""
    G = sliding_design(requested(c, fits), bandwidth(c, FAST))
    if G is None:
        raise refused(c, Message("observer.constant.unobservable"))
    return in_units(np.where(np.abs(G) > 1e-9 * np.abs(G).max(), G, 0.0), state_scales(c), output_scales(c))


def _amplitude(c: Context) -> np.ndarray:
    return LARGEST_FAULT * swings(c, requested(c, fits))


def default_amplitude(c: Context) -> list[float]:
    """Return ρ of each output: what five typical faults together do to its rate."""
    return [float(a * y * pace(c)) for a, y in zip(_amplitude(c), output_scales(c), strict=True)]


def default_layer(c: Context) -> list[float]:
    """Return δ of each output: four standard deviations of its noise, and so wide that ρ/δ is at most 10 κ."""
    steep, kappa = _amplitude(c), STEEP * bandwidth(c, FAST)
    noise = zip(noise_std(c), output_scales(c), steep / kappa, strict=True)
    return [float(max(NOISE * std, least * y)) for std, y, least in noise]


GAINS = (
    Gain(
        "gn",
        Message("gain.sliding-injection"),
        default_injection,
        None,
        size="n",
        columns="m",
        symbol="Gₙ",
        unit=STATE_PER_OUTPUT,
    ),
    Gain("kappa", Message("gain.linear-rate"), lambda c: bandwidth(c, FAST) * pace(c), symbol="κ", unit=RATE),
    Gain("rho", Message("gain.switching"), default_amplitude, size="m", symbol="ρ", unit=OUTPUT_PER_SECOND),
    Gain("layer", Message("gain.boundary-layer"), default_layer, positive=True, size="m", symbol="δ", unit=OUTPUT),
    Gain(
        "tau",
        Message("gain.injection-filter"),
        lambda c: 1 / (bandwidth(c, FAST) * pace(c)),
        positive=True,
        symbol="τ",
        unit=SECONDS,
    ),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError where an input enters an output directly."""
    require_still_outputs(d)
    x, theta = d.estimate_of_state(), d.estimate_of_theta()
    at, G = d.at(x), d.gain("gn")
    r = d.let("r", d.measured() - at.h)
    s = [error / width for error, width in zip(r, d.gain("layer"), strict=True)]
    length = d.let("length", sympy.sqrt(1 + sympy.Add(*[e**2 for e in s])))
    nu = column([rho * e / length for rho, e in zip(d.gain("rho"), s, strict=True)])
    v = d.let("v", r * d.gain("kappa") + nu)

    d.set(x, at.f + at.A @ G @ r + G @ v)
    d.set(theta, (faults_in_rates(d, at, v) - theta) / d.gain("tau"))
    d.estimates(x, theta, at.h)
    d.outputs("r", r)
    offer_linearisation(d, at.A, at.C, at.Phi, at.Psi)


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [matching(run, f"{SOURCE}, ch. 6"), sliding_motion(run), in_layer(run), noise_in_layer(run)]


def sliding_motion(run: Observed) -> Check:
    """Check that the motion on r = 0 is stable: the eigenvalues of (I − GₙC)A on the kernel of C, along the run."""
    name, n, m = stability("(I − GₙC)A", discrete=False), run.context.n, run.context.m
    if not run.facts["linearised"]:
        return too_large(name, run, SOURCE)
    A, C, G = run.matrix("A", n, n), run.matrix("C", m, n), run.gains("gn").reshape(n, m)
    rows = picked_rows(A, C)
    if n <= m or not len(rows):
        return Check(name, verdict(True if len(rows) else None), Message("check.sliding.all-measured"), source=SOURCE)
    x, worst = np.array(state_scales(run.context)), []
    for k in rows:
        kernel = np.linalg.svd(C[k] * x)[2][m:].T * x[:, None]
        worst.append(np.linalg.eigvals(np.linalg.pinv(kernel) @ (np.eye(n) - G @ C[k]) @ A[k] @ kernel).real.max())
    value = float(max(worst))
    holds = True if value < 0 else (False if np.median(worst) >= 0 else None)
    return Check(
        name, verdict(holds), Message("check.closed-loop.real-part", count=len(rows), value=value), value, 0.0, SOURCE
    )


def _errors(run: Observed) -> np.ndarray:
    """Return the errors of the outputs in the second half of the run, in boundary layers (rows, m)."""
    r = run.matrix("r", run.context.m, 1)[:, :, 0]
    late = r[len(r) // 2 :]
    return late[np.isfinite(late).all(axis=1)] / run.gains("layer")


def in_layer(run: Observed) -> Check:
    """Check that ρ holds the output error in the boundary layer: the share of late rows with sᵀs ≤ 1."""
    name, late = Message("check.sliding"), _errors(run)
    if not len(late):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=SOURCE)
    value = float(np.mean((late**2).sum(axis=1) <= 1.0))
    return Check(name, verdict(value >= 0.9), Message("check.sliding.share", share=100 * value), value, 0.9, SOURCE)


def noise_in_layer(run: Observed) -> Check:
    """Check that the boundary layer is wider than the noise, which makes ν chatter otherwise."""
    declared = np.array(run.context.noise_std) / run.gains("layer")
    value = float(declared.max(initial=0.0))
    text = Message("check.chattering.share", share=100 * value)
    return Check(Message("check.chattering"), verdict(value <= 0.5), text, value, 0.5, SOURCE)


OBSERVER = Observer(
    id="sliding-mode",
    source="Edwards & Spurgeon 1998, ch. 6; Edwards, Spurgeon & Patton 2000, Automatica 36; Yan & Edwards 2007",
    gains=GAINS,
    write=write,
    checks=checks,
    chooses=lambda c: chosen(c, fits),
    constants=constants,
    equations=(
        ("", "ẋ̂ = f(x̂, u) + AGₙr + Gₙv"),
        ("", "v = κr + ν"),
        ("", "νᵢ = {ρᵢsᵢ / √(1 + sᵀs)}"),
        ("", "sᵢ = {rᵢ / δᵢ}"),
        ("", "θ̇̂ = {1 / τ}((CΦ)⁺v − θ̂)"),
        ("", "r = y − h(x̂)"),
    ),
    where=(
        ("v", Message("symbol.equivalent-injection")),
        ("ν", Message("symbol.switching")),
        ("δ", Message("symbol.boundary-layer")),
    ),
)
