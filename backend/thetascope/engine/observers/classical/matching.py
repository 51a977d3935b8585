"""The matching condition of observers that reconstruct a fault from an output's rate: rank(CΦ) = p.

ẏ = Cf + CΦθ, so θ = (CΦ)⁺(ẏ − Cf). With E_ij the effect of a typical fault j on the rate of output i, relative to what
that rate usually has, (CΦ)⁺ is computed as (EᵀE + εI)⁻¹Eᵀ in these units, which is finite where a fault has no effect.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.model.plant_model import clock
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import DISTINCT, Point, distinctness, mirrored, operating_point
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, NOTHING, verdict
from thetascope.engine.observers.support.declaration import Context, Observed
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.draft_linalg import solve
from thetascope.engine.observers.support.excitation_checks import picked_rows, scaled_matrices, too_large
from thetascope.engine.observers.support.kalman_defaults import output_scales, pace, typical_sizes
from thetascope.engine.observers.support.matrices import Matrix, diag, eye, zeros
from thetascope.engine.observers.support.model_at import ModelAt
from thetascope.messages import Message

RIDGE = 1e-8  # ε
_TRACE = 1e-3  # of ‖C‖‖Φⱼ‖, from which a fault enters the rate of an output
_SLOWER = (1.0, 0.5, 0.2, 0.05, 0.01, 1e-3)


def matched(point: Point) -> bool:
    """Return whether the faults enter the rates of the outputs, independently of each other, and no output directly."""
    effects = point.C @ point.Phi
    size = np.linalg.norm(point.C, 2) * np.linalg.norm(point.Phi, axis=0)
    norms = np.linalg.norm(effects, axis=0)
    if point.Psi.any() or effects.shape[1] > effects.shape[0] or not (norms > _TRACE * size).all():
        return False
    return distinctness(effects / np.where(norms > 0, norms, 1.0)) > DISTINCT


def slowest_possible(A: np.ndarray, C: np.ndarray, R: np.ndarray, omega: float) -> np.ndarray | None:
    """Return L of `mirrored` for ω or, where fixed eigenvalues are slower, a smaller one; None if one is unstable."""
    found = (mirrored(A, C, R, omega * factor) for factor in _SLOWER)
    return next((L for L in found if L is not None), None)


def swings(c: Context, point: Point) -> np.ndarray:
    """Return the change of each output's rate by typical faults together, scaled, at least a fifth of the largest."""
    each = np.abs(point.C @ point.Phi).sum(axis=1)
    return np.maximum(each, max(0.2 * float(each.max(initial=0.0)), 1e-3))


def constants(c: Context) -> dict[str, np.ndarray]:
    """Return the typical faults (p×1) and the usual changes of the outputs' rates (m×1)."""
    point = operating_point(c).of(c.channels)
    rates = swings(c, point) * np.array(output_scales(c)) * pace(c)
    return {"typical": np.reshape(typical_sizes(c), (-1, 1)), "swing": rates[:, None]}


def faults_in_rates(d: Draft, at: ModelAt, rates: Matrix) -> Matrix:
    """Return (CΦ)⁺ at the estimate, with its ridge, times an unexplained part of ẏ (m×1)."""
    if d.p == 0:
        return zeros(0)
    typical = diag(d.constant("typical", d.p, 1))
    inverse = diag([1 / s for s in d.constant("swing", d.m, 1)])
    E = d.let("E", inverse @ at.C @ at.Phi @ typical)
    normal = d.let("EE", E.T @ E + eye(d.p) * RIDGE)
    return typical @ solve(d, "theta", normal, d.let("Er", E.T @ d.let("Ey", inverse @ rates)))


def require_still_outputs(d: Draft) -> None:
    """Raise SpecError where an input, a known signal or time enters an output directly: its rate is not known."""
    model = d.model
    moving = {*model.u, *model.signals, clock()}
    for name, h in zip(model.outputs, model.h.xreplace(model.expansion), strict=True):
        if h.free_symbols & moving:
            raise SpecError(
                "observers.kind",
                model.id,
                Message("observer.constant.none", why=Message("observer.reason.direct", output=name)),
            )


def matching(run: Observed, source: str) -> Check:
    """Check rank(CΦ) = rank(Φ) along the run, by the singular values of CΦ."""
    name = Message("check.rank-condition")
    if not run.channels:
        return Check(name, CANNOT_TELL, NOTHING, source=source)
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    matrices, rate = scaled_matrices(run), pace(run.context)
    rows = picked_rows(*matrices)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    effects = matrices[1][rows] @ matrices[2][rows] / rate
    sizes = np.linalg.norm(effects, axis=(1, 2)).max()
    found = [np.linalg.svd(effect, compute_uv=False)[-1] / max(sizes, 1e-300) for effect in effects]
    least, median = float(min(found)), float(np.median(found))
    holds = True if least > DISTINCT else (None if median > DISTINCT else False)
    text = Message("check.singular.relative", least=least, median=median)
    return Check(name, verdict(holds), text, least, DISTINCT, source)
