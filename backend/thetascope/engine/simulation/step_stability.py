"""Check the step against RK4's stability region: eigenvalues λ must satisfy |h·λ| ≲ 2.78 (on the real axis).

High gains make observers stiff, most of all the gain matrix Γ in its initial transient. The eigenvalues are those of
the Jacobian of the observer's (or plant's) equations along the run, by central differences.
"""

import numpy as np

from thetascope.engine.compiler.graph import evaluate
from thetascope.engine.compiler.system import Program

LIMIT = 2.6  # limit of |h·λ|, slightly inside RK4's 2.785 on the negative real axis and 2.828 on the imaginary one
TARGET = 2.0  # target of |h·λ| when substeps are chosen
MOST_SUBSTEPS = 64
_POINTS = 16
_DENSE = 40  # states up to which all eigenvalues are computed


def fastest(program: Program, values: dict[str, np.ndarray | float], rows: np.ndarray) -> float:
    """Return the largest |λ| of stable eigenvalues of ∂(update)/∂(states) over the rows (1/s); 0 if none is finite."""
    n = len(program.states)
    if not n or not len(rows):
        return 0.0
    picked = {k: (v if np.ndim(v) == 0 else np.asarray(v)[rows]) for k, v in values.items()}
    states = np.stack([picked[s] for s in program.states], axis=1)  # (points, n)
    sizes = np.abs(states).max(axis=0)  # of each state over the rows, so that one near 0 is moved by its own measure
    width = 1e-6 * np.maximum(np.abs(states), np.where(sizes > 0, 1e-3 * sizes, 1e-3))
    moved = {k: (v if np.ndim(v) == 0 else np.repeat(v, 2 * n)) for k, v in picked.items()}
    table = np.repeat(states, 2 * n, axis=0).reshape(len(rows), 2, n, n)
    for sign, half in ((1, 0), (-1, 1)):
        table[:, half, np.arange(n), np.arange(n)] += sign * width
    flat = table.reshape(-1, n)
    for j, s in enumerate(program.states):
        moved[s] = flat[:, j]
    rates = [np.broadcast_to(r, len(flat)) for r in evaluate(program.graph, list(program.update), moved)]
    slopes = np.stack(rates, axis=-1).reshape(len(rows), 2, n, n)  # [point, side, perturbed state, rate]
    jacobians = ((slopes[:, 0] - slopes[:, 1]) / (2 * width[:, :, None])).transpose(0, 2, 1)
    finite = jacobians[np.isfinite(jacobians).all(axis=(1, 2))]
    if not len(finite):
        return 0.0
    eigenvalues = np.linalg.eigvals(finite).ravel() if n <= _DENSE else np.concatenate([_largest(j) for j in finite])
    stable = np.abs(eigenvalues)[np.real(eigenvalues) < 0]
    return float(stable.max()) if len(stable) else 0.0


def _largest(jacobian: np.ndarray) -> np.ndarray:
    """Return the few largest eigenvalues of a large matrix by Arnoldi iteration; all if that does not converge."""
    from scipy.sparse.linalg import ArpackError, eigs

    try:
        return eigs(jacobian, k=6, which="LM", v0=np.ones(len(jacobian)), tol=1e-3, return_eigenvectors=False)
    except ArpackError:
        return np.linalg.eigvals(jacobian)


def sample_rows(count: int, size: int, opening: bool) -> np.ndarray:
    """Return the rows to test: dense in the initial transient (``opening``), sparse later; fewer for large systems."""
    if count <= 0:
        return np.empty(0, dtype=int)
    points = max(2, min(_POINTS if opening else 3, 600 // max(1, size)))
    late = np.linspace(0, count - 1, points // 2 + 1).astype(int)
    return np.unique(np.concatenate([np.geomspace(1, count, points // 2).astype(int) - 1, late])) if opening else late


def substeps_needed(step: float, rate: float) -> int:
    """Return the number of substeps per base step for eigenvalues of this size; 1 if the base step is small enough."""
    return 1 if step * rate <= LIMIT else int(np.ceil(step * rate / TARGET))
