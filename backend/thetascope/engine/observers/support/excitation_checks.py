"""Checks of observability and excitation along a run, from the Jacobians that an observer recorded.

States are scaled by their size, faults by their typical size and outputs by R, so that the numbers have no units: an
excitation of 1 means that within one window a fault of typical size changes the outputs by one standard deviation.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.support.common_checks import (
    NO_ESTIMATE,
    excitation_above,
    smallest_eigenvalue,
    stability,
    verdict,
    windowed_gramian,
)
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.draft import Draft
from thetascope.engine.observers.support.kalman_defaults import output_scales, state_scales, typical_sizes
from thetascope.engine.observers.support.matrices import Matrix
from thetascope.messages import Message

LARGEST = 12  # number of states up to which Jacobians are recorded
RANK = 1e-9  # relative size of a singular value that counts as zero
_POINTS = 60
_WINDOW = 600  # rows


def offer_linearisation(d: Draft, A: Matrix, C: Matrix, Phi: Matrix, Psi: Matrix) -> None:
    """Declare the model's Jacobians as outputs for the checks, unless a large plant would make this slow the run."""
    d.facts["linearised"] = d.n <= LARGEST
    if d.facts["linearised"]:
        for name, matrix in (("A", A), ("C", C), ("Phi", Phi), ("Psi", Psi)):
            d.outputs(name, matrix)


def scaled_matrices(run: Observed) -> tuple[np.ndarray, ...]:
    """Return A, C, Φ, Ψ at every row, scaled: (time, n, n), (time, m, n), (time, n, p), (time, m, p)."""
    c, p = run.context, len(run.channels)
    x, y, theta = (np.array(s) for s in (state_scales(c), output_scales(c), typical_sizes(c)))
    A = run.matrix("A", c.n, c.n) * x / x[:, None]
    C = run.matrix("C", c.m, c.n) * x / y[:, None]
    Phi = run.matrix("Phi", c.n, p) * theta / x[:, None]
    Psi = run.matrix("Psi", c.m, p) * theta / y[:, None]
    return A, C, Phi, Psi


def picked_rows(*matrices: np.ndarray) -> np.ndarray:
    """Return rows, spread over the run, at which all matrices are finite."""
    finite = np.flatnonzero(np.all([np.isfinite(M).all(axis=(1, 2)) for M in matrices], axis=0))
    return (
        finite[np.unique(np.linspace(0, len(finite) - 1, min(_POINTS, len(finite))).astype(int))]
        if len(finite)
        else finite
    )


def too_large(name: Message, run: Observed, source: str) -> Check:
    """Return the check of a plant whose Jacobians were not recorded."""
    return Check(
        name,
        CANNOT_TELL,
        Message("check.too-large", most=LARGEST, states=run.context.n),
        source=source,
    )


def observability(run: Observed, source: str) -> Check:
    """Check the rank of the observability matrix of (A, C), frozen along the run."""
    name = Message("check.observability")
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    A, C, _, _ = scaled_matrices(run)
    rows = picked_rows(A, C)
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    ratios = []
    for k in rows:
        block, blocks = C[k], [C[k]]
        for _ in range(run.context.n - 1):
            block = block @ A[k] / max(np.abs(A[k]).max(), 1e-30)
            blocks.append(block)
        singular = np.linalg.svd(np.vstack(blocks), compute_uv=False)
        ratios.append(singular[-1] / singular[0] if singular[0] > 0 else 0.0)
    least, most = min(ratios), max(ratios)
    holds = True if least > RANK else (False if most <= RANK else None)
    return Check(
        name,
        verdict(holds),
        Message("check.observability.singular", least=least, most=most),
        least,
        RANK,
        source,
    )


def _over(run: Observed, A: np.ndarray, time: float) -> np.ndarray:
    """Return the transition matrix over ``time`` for constant A; for a discrete plant, that of one step."""
    return A if run.context.model["time"]["kind"] == "discrete" else _exponential(A * time)


def _exponential(M: np.ndarray) -> np.ndarray:
    """Return exp of a matrix or of a stack of matrices: Taylor to order 8 on M/2^s, squared s times."""
    norm = np.abs(M).sum(axis=-1).max()
    squarings = max(0, int(np.ceil(np.log2(norm))) + 2) if norm > 0 else 0
    term = result = np.broadcast_to(np.eye(M.shape[-1]), M.shape)
    for order in range(1, 9):
        term = term @ M * (0.5**squarings / order)
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result


def closed_loop(run: Observed, source: str, period: float | None = None) -> Check:
    """Check the eigenvalues of A − KC (F(I − KC) over a sample ``period``), K = P Cᵀ R⁻¹, frozen along the run."""
    name = stability("A − KC", discrete=False) if period is None else stability("F(I − KC)", discrete=True)
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    n, m = run.context.n, run.context.m
    A, C, P = run.matrix("A", n, n), run.matrix("C", m, n), run.matrix("P", n, n, symmetric=True)
    rows = picked_rows(A, C, P)
    rows = rows[rows > len(P) // 10]  # the transient of P(0) is not subject to the theorem
    if not len(rows):
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=source)
    worst = []
    for k in rows:
        with np.errstate(all="ignore"):
            K = P[k] @ C[k].T / run.gains("r")
            closed = A[k] - K @ C[k] if period is None else _over(run, A[k], period) @ (np.eye(n) - K @ C[k])
        if not np.isfinite(closed).all():
            return Check(name, CANNOT_TELL, Message("check.closed-loop.infinite"), source=source)
        poles = np.linalg.eigvals(closed)
        worst.append(poles.real.max() if period is None else np.abs(poles).max())
    value, limit = float(max(worst)), 0.0 if period is None else 1.0
    holds = True if value < limit else (False if np.median(worst) >= limit else None)
    code = "check.closed-loop.real-part" if period is None else "check.closed-loop.modulus"
    return Check(
        name,
        verdict(holds),
        Message(code, count=len(rows), value=value),
        value,
        limit,
        source,
    )


def excitation(run: Observed, samples: float = 1.0) -> np.ndarray:
    """Return λmin of ∫ ΩᵀR⁻¹Ω dt over the last window, in typical faults, at every row.

    ``samples``: measurements per second where R is the variance of one measurement, 1 where it is an intensity.
    """
    omega = run.matrix("Omega", run.context.m, len(run.channels))
    r = np.stack([np.broadcast_to(run.values[f"g.r.{i}"], len(omega)) for i in range(run.context.m)], axis=1)
    scaled = omega * typical_sizes(run.context) / np.sqrt(r)[:, :, None]
    return smallest_eigenvalue(windowed_gramian(scaled * samples**0.5, run), run)


def excitation_check(run: Observed, level: np.ndarray, source: str) -> Check:
    """Check that λmin of ∫ΩᵀR⁻¹Ω dt, ``level`` at every row (``excitation``), stays above δ once Υ has settled."""
    return excitation_above(run, level, source, "check.excitation.weighted")


def joint_observability(run: Observed, period: float, source: str) -> Check:
    """Check λmin of the observability Gramian of (x, θ) over windows: whether this input excites all directions."""
    name, delta = Message("check.joint-observability"), run.gain("delta")
    if not run.facts["linearised"]:
        return too_large(name, run, source)
    requested = max(2, round(run.gain("window") / run.interval))
    length = min(requested, _WINDOW)
    matrices = scaled_matrices(run)
    rows = len(run.values["t"])
    starts = np.unique(np.linspace(0, rows - length, 6).astype(int)) if rows >= length else np.empty(0, dtype=int)
    smallest = [g for g in (_gramian(run, matrices, k, length, period) for k in starts) if g is not None]
    if not smallest:
        return Check(name, CANNOT_TELL, Message("check.window.short-or-infinite"), None, delta, source)
    value, span = float(min(smallest)), length * run.interval
    holds = (
        None if value < delta and length < requested else value >= delta
    )  # a window shorter than requested proves nothing
    return Check(
        name,
        verdict(holds),
        Message("check.joint-observability.gramian", window=span, least=value, most=max(smallest), level=delta),
        value,
        delta,
        source,
    )


def _gramian(run: Observed, matrices: tuple[np.ndarray, ...], first: int, length: int, period: float) -> float | None:
    """Return λmin of Σ Φᵀ Hᵀ R⁻¹ H Φ over ``length`` rows, with Φ the transition of (x, θ) since the first row."""
    A, C, Phi, Psi = (M[first : first + length] for M in matrices)
    if not all(np.isfinite(M).all() for M in (A, C, Phi, Psi)):
        return None
    n, p = run.context.n, len(run.channels)
    R = run.gains("r") / np.array(output_scales(run.context)) ** 2
    carried, total = np.eye(n + p), np.zeros((n + p, n + p))
    blocks = np.zeros((length, n + p, n + p))
    blocks[:, :n, :n], blocks[:, :n, n:] = A, Phi
    if run.context.model["time"]["kind"] == "discrete":
        blocks[:, n:, n:] = np.eye(p)
    transitions = _over(run, blocks, run.interval)
    for k in range(length):
        sensitivity = np.hstack([C[k], Psi[k]]) @ carried
        total += sensitivity.T @ (sensitivity / R[:, None]) * (run.interval / period)
        carried = transitions[k] @ carried
    return float(np.linalg.eigvalsh(total)[0])
