"""Checks of observers whose gains are designed for a linearisation, at points frozen along a run."""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import DISTINCT, Point, at_rest
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, stability, verdict
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.excitation_checks import picked_rows, scaled_matrices, too_large
from thetascope.engine.observers.support.kalman_defaults import pace
from thetascope.messages import Message


def distinct_at_rest(run: Observed, source: str) -> Check:
    """Check that [A Φ; C Ψ] has full rank along the run: constant faults and the state show differently at rest."""
    name = Message("check.distinct-at-rest")
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    matrices, rate = scaled_matrices(run), pace(run.context)
    rows = picked_rows(*matrices)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    A, C, Phi, Psi = (M[rows] for M in matrices)
    points = (Point(a / rate, c, phi / rate, psi, run.channels) for a, c, phi, psi in zip(A, C, Phi, Psi, strict=True))
    found = [at_rest(point) for point in points]
    least, median = min(found), float(np.median(found))
    holds = True if least > DISTINCT else (None if median > DISTINCT else False)
    text = Message("check.singular.relative", least=least, median=median)
    return Check(name, verdict(holds), text, least, DISTINCT, source)


def error_dynamics(run: Observed, K: np.ndarray, K_theta: np.ndarray, source: str) -> Check:
    """Check the eigenvalues of the error in (x, θ) with gains K (n×m) and K_θ (p×m), frozen along the run."""
    name, (n, m, p) = stability("Aₑ − KₑCₑ", discrete=False), (run.context.n, run.context.m, len(run.channels))
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    A, C = run.matrix("A", n, n), run.matrix("C", m, n)
    Phi, Psi = run.matrix("Phi", n, p), run.matrix("Psi", m, p)
    rows = picked_rows(A, C, Phi, Psi)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    L, worst = np.vstack([K.reshape(n, m), K_theta.reshape(p, m)]), []
    for k in rows:
        joint = np.zeros((n + p, n + p))
        joint[:n] = np.hstack([A[k], Phi[k]])
        worst.append(np.linalg.eigvals(joint - L @ np.hstack([C[k], Psi[k]])).real.max())
    value = float(max(worst))
    holds = True if value < 0 else (False if np.median(worst) >= 0 else None)
    text = Message("check.closed-loop.real-part", count=len(rows), value=value)
    return Check(name, verdict(holds), text, value, 0.0, source)


def time_scales(run: Observed, source: str) -> Check:
    """Check that the observer is faster than the plant: its frozen gains are exact only for a plant that stands."""
    omega, rate = run.gain("omega"), pace(run.context)
    text = Message("check.bandwidth.value", omega=omega, rate=rate)
    return Check(Message("check.bandwidth"), verdict(True if omega >= rate else None), text, omega, rate, source)
