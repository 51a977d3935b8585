"""The proof of Theorem 2 of Zhao, Li & Li 2012, in numbers: its Lyapunov function and its constants.

V = ηᵀSη + θ̃ᵀΓ⁻¹θ̃ with η = z̃ − Υθ̃ and z̃ = ρΔ⁻¹x̃ in canonical coordinates, x̃ = x̂ − x, θ̃ = θ̂ − θ. The constants
c1 … c10 of (39)–(42) are suprema; along one run the largest values are lower bounds of them. Norms are spectral, in the
plant's own units, as the paper has them. The proof takes all but ρ for constants, but Υ and Γ are those of the present
ρ and λ: with other gains the constants, and the ρ that they ask for, are others.
"""

from __future__ import annotations

import math

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.support.common_checks import NO_VALUE, NOTHING, verdict
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.kalman_defaults import state_scales
from thetascope.messages import Message

SOURCE = "Zhao, Li & Li 2012, Theorem 2"
_POINTS = 400
"""Rows at which Jacobians are taken."""
_DIFFERENCE = 1e-5
"""Of a state's scale: half the distance of a central difference."""
_ROUNDING = 1e-16
"""Of the largest V: below it V is rounding, and its rises mean nothing."""


def solution(n: int) -> np.ndarray:
    """Return S of (7) in numbers (n×n): a run from the cache needs no SymPy."""
    return np.array([[(-1.0) ** (i + j) * math.comb(i + j, j) for j in range(n)] for i in range(n)])


def lyapunov(run: Observed) -> dict[str, np.ndarray]:
    """Return the columns V, V1 = ηᵀSη and V2 = θ̃ᵀΓ⁻¹θ̃ along the rows; nothing where the truth is not known."""
    if run.truth is None:
        return {}
    n, p, rho = run.context.n, len(run.channels), np.asarray(run.values["g.rho"], dtype=float)
    theta = np.stack([run.values[f"theta.{c}"] - run.truth.theta[:, j] for j, c in enumerate(run.channels)] or [[]], 1)
    z = _coordinates(run, None) - _coordinates(run, run.truth.x)
    z *= rho[..., None] ** -np.arange(n) if rho.ndim else rho ** -np.arange(n)
    upsilon = run.matrix("Upsilon", n, p)
    for j in range(p):  # one column at a time: the sums then do not depend on how many rows there are
        z = z - upsilon[:, :, j] * theta[:, j, None]
    v1 = np.zeros(len(z))
    for i, row in enumerate(solution(n)):
        for j, entry in enumerate(row):
            v1 += entry * z[:, i] * z[:, j]
    v2 = _inverse_form(run.matrix("Gamma", p, p, symmetric=True), theta)
    return {"V": v1 + v2, "V1": v1, "V2": v2}


def _coordinates(run: Observed, x: np.ndarray | None) -> np.ndarray:
    """Return canonical coordinates (rows, n) of the estimates, or of other states `x` (rows, n)."""
    states = [state["name"] for state in run.context.model["states"]]
    if run.facts["canonical"]:
        return np.stack([run.values[f"x.{s}"] for s in states], 1) if x is None else x
    names = [f"T.{i}.0" for i in range(len(states))]
    if x is None:
        return np.stack([run.values[name] for name in names], 1)
    assert run.probe is not None
    return run.probe(names, run.values | {f"xh.{s}": x[:, i] for i, s in enumerate(states)}).T


def _inverse_form(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return vᵀM⁻¹v for symmetric positive definite M (rows, p, p) and v (rows, p), by elimination."""
    M, v = matrices.copy(), vectors.copy()
    total = np.zeros(len(v))
    with np.errstate(all="ignore"):
        for k in range(v.shape[1]):
            total += v[:, k] ** 2 / M[:, k, k]
            for i in range(k + 1, v.shape[1]):
                share = M[:, i, k] / M[:, k, k]
                v[:, i] -= share * v[:, k]
                M[:, i, k:] -= share[:, None] * M[:, k, k:]
    return total


def falls(run: Observed) -> Check:
    """Check that V falls between rows with the same true θ, as the proof says."""
    name = Message("check.lyapunov-falls")
    if "V" not in run.values or run.truth is None:
        return Check(name, CANNOT_TELL, Message("check.lyapunov-falls.record"), source=SOURCE)
    V, t = run.values["V"], run.values["t"]
    same = (np.diff(run.truth.theta, axis=0) == 0).all(axis=1)
    judged = same & np.isfinite(V[1:]) & np.isfinite(V[:-1])
    judged &= V[:-1] > _ROUNDING * np.max(V, initial=0.0, where=np.isfinite(V))
    if not judged.any():
        return Check(name, CANNOT_TELL, NO_VALUE, source=SOURCE)
    growth = np.where(judged, V[1:] / np.where(judged, V[:-1], 1.0) - 1.0, -np.inf)
    share = float((growth[judged] > 1e-9).mean())
    worst = int(np.argmax(growth))
    args = {"share": share, "interval": run.interval, "time": float(t[worst]), "growth": float(growth[worst])}
    code = "check.lyapunov-falls.rises" if share else "check.lyapunov-falls.all"
    return Check(name, verdict(share == 0), Message(code, **args), share, 0.0, SOURCE)


def constants(run: Observed) -> Check:
    """Check that ρ is as large as the proof asks for: (ρ − c5)(λ − c9) > (c6 + c10)²/4 with ρ > c5, λ > c9."""
    name = Message("check.theorem2")
    n, p = run.context.n, len(run.channels)
    if not p:
        return Check(name, CANNOT_TELL, NOTHING, source=SOURCE)
    if not run.facts["triangular"]:
        return Check(name, CANNOT_TELL, Message("check.theorem2.not-triangular"), source=SOURCE)
    upsilon, gamma = run.matrix("Upsilon", n, p), run.matrix("Gamma", p, p, symmetric=True)
    omega = run.matrix("Omega", 1, p)
    finite = np.flatnonzero(np.all([np.isfinite(M).all(axis=(1, 2)) for M in (upsilon, gamma, omega)], axis=0))
    slopes = _slopes(run, finite)
    if slopes is None:
        return Check(name, CANNOT_TELL, NO_VALUE, source=SOURCE)
    rho, lam = run.gain("rho"), run.gain("lambda")
    S = solution(n)
    of_S = np.linalg.eigvalsh(S)
    largest_gamma = float(np.linalg.eigvalsh(gamma[finite]).max())  # 1/λmin(Γ⁻¹)
    c1 = max(_norm(slopes), _norm(slopes * (rho ** np.arange(n) / rho ** np.arange(n)[:, None])))
    c2 = c1 * _norm(upsilon[finite])
    c3, c4 = 2 * c1 * of_S[-1], 2 * c2 * of_S[-1]
    c5, c6 = c3 / of_S[0], c4 * math.sqrt(largest_gamma / of_S[0])
    size = _norm(omega[finite])
    c7, c8 = size**2, 2 * size
    c9, c10 = c7 * largest_gamma, c8 * math.sqrt(largest_gamma / of_S[0])
    k = c6 + c10
    needed = (c5 + c9) / 2 + math.hypot((c5 - c9) / 2, k / 2)
    enough = rho > c5 and lam > c9 and (rho - c5) * (lam - c9) > k**2 / 4
    known = [c1, c2, c3, c4, c5, c6, c7, c8, c9, c10]
    args = {"constants": [f"{c:.3g}" for c in known], "needed": needed, "rho": rho, "lambda": lam}
    met = None if enough and not run.facts["affine"] else enough  # elsewhere the constants may be larger
    return Check(name, verdict(met), Message("check.theorem2.constants", **args), rho, needed, SOURCE)


def _norm(matrices: np.ndarray) -> float:
    """Return the largest spectral norm of matrices (rows, n, m)."""
    return float(np.linalg.norm(matrices, 2, axis=(1, 2)).max())


def _slopes(run: Observed, finite: np.ndarray) -> np.ndarray | None:
    """Return ∂W/∂z in canonical coordinates at some of the finite rows (rows, n, n), W = f + g u of (3).

    The outputs F = J f and T are differenced in the plant's states, which takes no symbolic derivative.
    """
    probe = run.probe
    if probe is None or not len(finite):
        return None
    some = run.at(finite[np.unique(np.linspace(0, len(finite) - 1, _POINTS).astype(int))])
    states = [f"xh.{state['name']}" for state in run.context.model["states"]]
    n = len(states)
    names = [f"F.{i}.0" for i in range(n)] + ([] if run.facts["canonical"] else [f"T.{i}.0" for i in range(n)])
    slopes = []
    for state, scale in zip(states, state_scales(run.context), strict=True):
        step = _DIFFERENCE * scale
        above, below = (probe(names, some.values | {state: some.values[state] + side}) for side in (step, -step))
        slopes.append((above - below) / (2 * step))
    table = np.array(slopes)  # (state, output, rows)
    F = np.moveaxis(table[:, :n], 2, 0).swapaxes(1, 2)
    if not run.facts["canonical"]:
        J = np.moveaxis(table[:, n:], 2, 0).swapaxes(1, 2)
        usable = np.isfinite(J).all(axis=(1, 2)) & (np.abs(np.linalg.det(np.nan_to_num(J))) > 0)
        if not usable.any():
            return None
        F = F[usable] @ np.linalg.inv(J[usable])
    W = F - np.eye(n, k=1)
    W = W[np.isfinite(W).all(axis=(1, 2))]
    return W if len(W) else None
