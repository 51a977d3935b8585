"""How fast the errors of the reduced-order observer decay: Theorem 2 and Remark 1 of its paper, in numbers.

With e = ẑ − z in the unmeasured coordinates, V(Ã − HC̃)V⁻¹ = Λ as in (16) and γ a Lipschitz constant of α + F u,

    ‖V e(t)‖ ≤ ‖V e(0)‖ exp(αt),   α = max Re Λ + γ ‖V B̃‖ ‖V⁻¹‖                                     (21), (22)

and Remark 1 asks for α < 0. Along one run the largest slope of α + F u is a lower bound of γ. To first order the errors
obey e' = (Ã − HC̃ + B̃ ∂(α + F u)/∂ẑ) e; the print leaves the last term out where it speaks of the rates H.
"""

from __future__ import annotations

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.forms.normal_form import PAPER
from thetascope.engine.observers.support.common_checks import NO_VALUE, verdict
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.kalman_defaults import state_scales
from thetascope.messages import Message

_POINTS = 400
"""Rows at which slopes are taken."""
_DIFFERENCE = 1e-5
"""Half the distance of a central difference, of a coordinate's size along the run."""
_DISTINCT = 1e8
"""Condition of V above which (16) has no usable V: poles coincide."""
_POOR = 0.1
"""Of the variance of log ‖e‖: a line that leaves more of it gives no rate."""
_FEWEST = 10
"""Rows from which a rate is taken."""
_ROUNDING = 1e-9
"""Of the largest error: below it errors are rounding and have no rate."""


def linear_part(H: np.ndarray, blocks: list[int]) -> np.ndarray:
    """Return Ã − HC̃ in numbers (n−m × n−m): a run from the cache needs no SymPy."""
    closed, at = np.zeros((sum(blocks), sum(blocks))), 0
    for size in blocks:
        closed[at : at + size, at : at + size] = np.eye(size, k=1)
        closed[at : at + size, at] -= H[at : at + size]
        at += size
    return closed


def rates(run: Observed, blocks: list[int]) -> list[Check]:
    """Check Remark 1, and that the errors' first-order equations are stable along the run."""
    if not sum(blocks):
        return []
    slopes = _slopes(run, blocks)
    closed = linear_part(run.gains("H"), blocks)
    return [_remark(run, closed, slopes, blocks), _first_order(closed, slopes)]


def _remark(run: Observed, closed: np.ndarray, slopes: np.ndarray | None, blocks: list[int]) -> Check:
    name, source = Message("check.reduced-rate"), f"{PAPER}, Remark 1"
    if slopes is None:
        return Check(name, CANNOT_TELL, NO_VALUE, source=source)
    poles, vectors = np.linalg.eig(closed)
    slowest = float(np.real(poles).max())
    if np.linalg.cond(vectors) > _DISTINCT:
        return Check(name, CANNOT_TELL, Message("check.reduced-rate.equal-poles"), source=source)
    gamma = float(np.linalg.norm(slopes, 2, axis=(1, 2)).max())
    V = np.linalg.inv(vectors)
    ends = np.cumsum([size for size in blocks if size]) - 1  # the rows of B̃ with an entry
    alpha = float(slowest + gamma * np.linalg.norm(V[:, ends], 2) * np.linalg.norm(vectors, 2))
    args = {"alpha": alpha, "gamma": gamma, "pole": slowest}
    code, measured = _measured(run)
    text = Message(code, **args, **measured)
    met = None if alpha < 0 and not run.facts["affine"] else alpha < 0  # elsewhere γ may be larger
    return Check(name, verdict(met), text, alpha, 0.0, source)


def _first_order(closed: np.ndarray, slopes: np.ndarray | None) -> Check:
    """Check the eigenvalues of Ã − HC̃ + B̃ ∂(α + F u)/∂ẑ, frozen along the run."""
    name, source = Message("check.error-matrix"), f"{PAPER}, eq. (20) to first order"
    if slopes is None:
        return Check(name, CANNOT_TELL, NO_VALUE, source=source)
    found = np.linalg.eigvals(closed + slopes)
    largest = found.real.max(axis=1)
    first, plain = (
        [f"{e.real:.4g}" if e.imag == 0 else f"{e:.4g}" for e in np.sort_complex(values)]
        for values in (found[0], np.linalg.eigvals(closed))
    )
    value = float(largest.max())
    met = True if value < 0 else (False if np.median(largest) >= 0 else None)
    args = {"start": first, "without": plain, "value": value, "share": float((largest >= 0).mean())}
    return Check(name, verdict(met), Message("check.error-matrix.eigenvalues", **args), value, 0.0, source)


def _slopes(run: Observed, blocks: list[int]) -> np.ndarray | None:
    """Return B̃ ∂(α + F u)/∂ẑ in the unmeasured coordinates at some rows (rows, n−m, n−m), by central differences.

    ω + H y is ẑ, so ω is moved. Rows of B̃ with an entry are the last of each block.
    """
    hidden = sum(blocks)
    omega = np.stack([run.values[f"omega.{j}.0"] for j in range(hidden)], 1)
    finite = np.flatnonzero(np.isfinite(omega).all(axis=1))
    probe = run.probe
    if probe is None or not len(finite):
        return None
    some = run.at(finite[np.unique(np.linspace(0, len(finite) - 1, _POINTS).astype(int))])
    at, outputs = -1, []
    for i, size in enumerate(blocks):
        at += size
        if size:
            outputs.append((at, f"top.{i}.0"))
    made = np.zeros((len(some.values["t"]), hidden, hidden))
    for j in range(hidden):
        name = f"omega.{j}.0"
        here = some.values[name]
        step = _DIFFERENCE * (float(np.abs(here).max()) or 1.0)
        above, below = (probe([o for _, o in outputs], some.values | {name: here + s}) for s in (step, -step))
        for place, (row, _) in enumerate(outputs):
            made[:, row, j] = (above[place] - below[place]) / (2 * step)
    made = made[np.isfinite(made).all(axis=(1, 2))]
    return made if len(made) else None


def _measured(run: Observed) -> tuple[str, dict[str, float]]:
    """Return how the scaled error of the state changes along the run: the code of the sentence and its numbers.

    A rate in 1/s where one line fits the logarithm of the error well; otherwise the share of the error that is left.
    """
    if run.truth is None:
        return "check.reduced-rate.bound", {}
    states = [state["name"] for state in run.context.model["states"]]
    error = np.stack([run.values[f"x.{s}"] for s in states], 1) - run.truth.x
    size = np.linalg.norm(error / np.array(state_scales(run.context)), axis=1)
    usable = np.isfinite(size)
    usable &= size > _ROUNDING * np.max(size, initial=0.0, where=usable)
    end = int(np.argmin(usable)) if not usable.all() else len(usable)
    if end < _FEWEST:
        return "check.reduced-rate.bound", {}
    t, logarithm = run.values["t"][:end], np.log(size[:end])
    rate, start = np.polyfit(t, logarithm, 1)
    left = logarithm - start - rate * t
    if rate < 0 and left @ left <= _POOR * float(np.sum((logarithm - logarithm.mean()) ** 2)):
        return "check.reduced-rate.measured", {"rate": -float(rate)}
    return "check.reduced-rate.left", {"ratio": float(size[end - 1] / size[0])}
