"""Unknown-input observer: the estimate of the state does not depend on the chosen faults at all.

    z' = (I − HC) f(x̂, u) + K r,   x̂ = z + H y,   r = y − h(x̂)
    ξ' = (y − ξ)/τ + C f(x̂, u),   θ̂' = ((CΦ)⁺(y − ξ)/τ − θ̂)/τ

Chen & Patton, Robust Model-Based Fault Diagnosis, 1999, ch. 3. H = Φ(CΦ)⁺, so (I − HC)Φ = 0 and the faults that it
estimates do not reach the error x − x̂, whatever they do: e' = ((I − HC)A − KC)e. It exists where rank(CΦ) =
rank(Φ) and the invariant zeros of (A, Φ, C) are stable. The gains belong to the linearisation along the healthy
run; f is the plant's own, as in the extended observer of Witczak, Obuchowicz & Korbicz, Int. J. Control 75(13),
2002.

The residual r reacts to all other faults only. A set of such observers, each with other channels, therefore has
structured residuals: the fault is among the channels of the one whose residual stays at the noise. θ̂ is the part of
the outputs' rates that f(x̂, u) does not explain, filtered twice.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import (
    Point,
    bandwidth,
    chosen,
    in_units,
    refused,
    requested,
    weights,
)
from thetascope.engine.observers.classical.matching import (
    constants,
    faults_in_rates,
    matched,
    matching,
    require_still_outputs,
    slowest_possible,
)
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, stability, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer
from thetascope.engine.observers.support.dimensions import SECONDS, STATE_PER_OUTPUT, STATE_PER_OUTPUT_SECOND
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.excitation_checks import (
    offer_linearisation,
    picked_rows,
    scaled_matrices,
    too_large,
)
from thetascope.engine.observers.support.kalman_defaults import noise_std, output_scales, pace, state_scales
from thetascope.messages import Message

FAST = 4.0  # bandwidth, times the rate at which a run lets a fault be learned
DECOUPLED = 0.02  # part of a fault's effect that may pass I − HC
QUIET = 2.0  # standard deviations of the noise, up to which noise explains a residual
SOURCE = "Chen & Patton 1999, ch. 3"


def fits(point: Point) -> bool:
    """Return whether the faults are matched and the invariant zeros stable."""
    return matched(point) and design(point, np.ones(len(point.C)), 1.0) is not None


def design(point: Point, R: np.ndarray, omega: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return H and K (n×m), scaled; None where the error cannot be made stable."""
    H = point.Phi @ np.linalg.pinv(point.C @ point.Phi)
    K = slowest_possible(point.A - H @ point.C @ point.A, point.C, R, omega)
    return None if K is None else (H, K)


def default_gains(c: Context) -> tuple[list[list[float]], list[list[float]]]:
    """Return H and K in the plant's units. Raises SpecError for faults that are not matched."""
    found = design(requested(c, fits), weights(c), bandwidth(c, FAST))
    if found is None:
        raise refused(c, Message("observer.constant.unobservable"))
    x, y = state_scales(c), output_scales(c)
    H, K = (np.where(np.abs(M) > 1e-9 * np.abs(M).max(initial=0.0), M, 0.0) for M in found)
    return in_units(H, x, y), in_units(K, x, y, pace(c))


GAINS = (
    Gain(
        "h",
        Message("gain.decoupling"),
        lambda c: default_gains(c)[0],
        None,
        size="n",
        columns="m",
        symbol="H",
        unit=STATE_PER_OUTPUT,
        live=False,
    ),
    Gain(
        "k",
        Message("gain.decoupled-injection"),
        lambda c: default_gains(c)[1],
        None,
        size="n",
        columns="m",
        symbol="K",
        unit=STATE_PER_OUTPUT_SECOND,
    ),
    Gain(
        "tau",
        Message("gain.rate-filter"),
        lambda c: 1 / (bandwidth(c, FAST) * pace(c)),
        positive=True,
        symbol="τ",
        unit=SECONDS,
    ),
)


def write(d: Draft) -> None:
    """Write the equations of the observer. Raises SpecError where an input enters an output directly."""
    require_still_outputs(d)
    y, H, tau = d.measured(), d.gain("h"), d.gain("tau")
    z = d.states("via.z", d.n, initial=d.x0 - H @ y)
    filtered = d.states("via.y", d.m, initial=y)
    theta = d.estimate_of_theta()
    x = d.let("x", z + H @ y)
    at = d.at(x)
    r = d.let("r", y - at.h)
    rates = d.let("Cf", at.C @ at.f)
    unexplained = d.let("unexplained", (y - filtered) / tau)

    d.set(z, at.f - H @ rates + d.gain("k") @ r)
    d.set(filtered, unexplained + rates)
    d.set(theta, (faults_in_rates(d, at, unexplained) - theta) / tau)
    d.estimates(x, theta, at.h)
    d.outputs("r", r)
    offer_linearisation(d, at.A, at.C, at.Phi, at.Psi)


def carried(c: Context) -> list[tuple[float, float]]:
    """Return the scales of z and of the filtered outputs, and the deviations of their first values."""
    return [*((s, s) for s in state_scales(c)), *((s, 0.0) for s in output_scales(c))]


def checks(run: Observed) -> list[Check]:
    """Check the assumptions on this plant, these gains and this run."""
    return [matching(run, SOURCE), decoupling(run), error_motion(run), quiet(run)]


def decoupling(run: Observed) -> Check:
    """Check (I − HC)Φ = 0 along the run: the largest part of a fault's effect that reaches the error."""
    name = Message("check.decoupled")
    if not run.facts["linearised"]:
        return too_large(name, run, SOURCE)
    _, C, Phi, _ = scaled_matrices(run)
    rows = picked_rows(C, Phi)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=SOURCE)
    n, m, c = run.context.n, run.context.m, run.context
    H = run.gains("h").reshape(n, m) * np.array(output_scales(c)) / np.array(state_scales(c))[:, None]
    left = np.linalg.norm(Phi[rows] - H @ C[rows] @ Phi[rows], axis=1)
    size = np.linalg.norm(Phi[rows], axis=1)
    value = float((left / np.where(size > 0, size, 1.0)).max(initial=0.0))
    text = Message("check.decoupled.share", share=100 * value)
    return Check(name, verdict(value <= DECOUPLED), text, value, DECOUPLED, SOURCE)


def error_motion(run: Observed) -> Check:
    """Check the eigenvalues of (I − HC)A − KC, frozen along the run."""
    name, n, m = stability("(I − HC)A − KC", discrete=False), run.context.n, run.context.m
    if not run.facts["linearised"]:
        return too_large(name, run, SOURCE)
    A, C = run.matrix("A", n, n), run.matrix("C", m, n)
    H, K = run.gains("h").reshape(n, m), run.gains("k").reshape(n, m)
    rows = picked_rows(A, C)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=SOURCE)
    worst = [np.linalg.eigvals(A[k] - H @ C[k] @ A[k] - K @ C[k]).real.max() for k in rows]
    value = float(max(worst))
    holds = True if value < 0 else (False if np.median(worst) >= 0 else None)
    text = Message("check.closed-loop.real-part", count=len(rows), value=value)
    return Check(name, verdict(holds), text, value, 0.0, SOURCE)


def quiet(run: Observed) -> Check:
    """Check that no other fault acts: noise explains the residual in the second half of the run.

    With as many decoupled faults as outputs, C H = I and the residual is zero, so it says nothing.
    """
    name, m = Message("check.residual"), run.context.m
    r = run.matrix("r", m, 1)[:, :, 0]
    late = r[len(r) // 2 :]
    late = late[np.isfinite(late).all(axis=1)]
    if not len(late) or len(run.channels) >= m:
        return Check(name, CANNOT_TELL, Message("check.residual.none") if len(late) else NO_ESTIMATE, source=SOURCE)
    value = float((np.sqrt((late**2).mean(axis=0)) / np.array(noise_std(run.context))).max())
    return Check(name, verdict(value <= QUIET), Message("check.residual.size", value=value), value, QUIET, SOURCE)


OBSERVER = Observer(
    id="unknown-input",
    source="Chen & Patton 1999, ch. 3; Witczak, Obuchowicz & Korbicz 2002, Int. J. Control 75(13), 1012–1031",
    gains=GAINS,
    write=write,
    checks=checks,
    chooses=lambda c: chosen(c, fits),
    constants=constants,
    carried=carried,
    equations=(
        ("", "ż = (I − HC)f(x̂, u) + Kr"),
        ("", "x̂ = z + Hy"),
        ("", "r = y − h(x̂)"),
        ("", "H = Φ(CΦ)⁺"),
        ("", "ξ̇ = {1 / τ}(y − ξ) + Cf(x̂, u)"),
        ("", "θ̇̂ = {1 / τ}({1 / τ}(CΦ)⁺(y − ξ) − θ̂)"),
    ),
    where=(
        ("z", Message("symbol.decoupled-state")),
        ("r", Message("symbol.structured-residual")),
        ("ξ", Message("symbol.filtered-output")),
    ),
)
