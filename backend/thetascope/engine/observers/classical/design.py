"""Design of constant gains at the operating point of a plant: the linearisation along its healthy run (`Slopes`).

All matrices here are scaled: states, outputs and faults by their sizes, time by the plant's pace. So neither units nor
the speed of a plant change a rank, an eigenvalue in paces, or a choice.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import (
    learning_rate,
    noise_std,
    output_scales,
    pace,
    state_scales,
    typical_sizes,
)
from thetascope.messages import Message

DISTINCT = 1e-4  # relative size of a singular value from which directions count as distinct
_ROUNDING = 1e-9  # entries of a gain below this part of the largest one are rounding, and depend on units


@dataclass(frozen=True)
class Point:
    """A plant at its operating point, scaled: A (n×n), C (m×n), Phi (n×p) and Psi (m×p) of all its fault channels."""

    A: np.ndarray
    C: np.ndarray
    Phi: np.ndarray
    Psi: np.ndarray
    channels: tuple[str, ...]

    def of(self, channels: Sequence[str]) -> Point:
        """Return the same plant with some of its channels."""
        columns = [self.channels.index(c) for c in channels]
        return Point(self.A, self.C, self.Phi[:, columns], self.Psi[:, columns], tuple(channels))

    @property
    def joint(self) -> tuple[np.ndarray, np.ndarray]:
        """Return A (n+p × n+p) and C (m × n+p) of the state augmented by constant faults."""
        n, p = self.Phi.shape
        A = np.zeros((n + p, n + p))
        A[:n, :n], A[:n, n:] = self.A, self.Phi
        return A, np.hstack([self.C, self.Psi])


def operating_point(c: Context) -> Point:
    """Return a plant at its operating point, with all its channels. Raises SpecError where there is none."""
    slopes, names = c.scales.slopes, tuple(channel["name"] for channel in c.model.get("channels", ()))
    if slopes is None:
        raise refused(c, Message("observer.constant.no-point"))
    x, y, rate = np.array(state_scales(c)), np.array(output_scales(c)), pace(c)
    theta = np.array([float(channel.get("typical", 1.0)) for channel in c.model.get("channels", ())])
    n, m, p = len(x), len(y), len(names)
    A, C = np.reshape(slopes.A, (n, n)), np.reshape(slopes.C, (m, n))
    Phi, Psi = np.reshape(slopes.Phi, (n, p)), np.reshape(slopes.Psi, (m, p))
    return Point(
        A * x / x[:, None] / rate, C * x / y[:, None], Phi * theta / x[:, None] / rate, Psi * theta / y[:, None], names
    )


def refused(c: Context, why: Message) -> SpecError:
    """Return the error of a plant for which an observer with constant gains cannot be designed."""
    return SpecError("observers.kind", c.model.get("id"), Message("observer.constant.none", why=why))


def at_rest(point: Point) -> float:
    """Return how distinctly constant faults and the state show in the outputs at rest, 0 … 1.

    It is the smallest singular value of [A Φ; C Ψ] relative to the largest; at most as many faults as outputs can be
    distinct.
    """
    A, C = point.joint
    stacked = np.vstack([A[: len(point.A)], C])
    if stacked.shape[0] < stacked.shape[1]:
        return 0.0
    norms = np.linalg.norm(stacked, axis=0)
    return distinctness(stacked / np.where(norms > 0, norms, 1.0))


def distinctness(matrix: np.ndarray) -> float:
    """Return the smallest singular value relative to the largest; 1 for a matrix without columns."""
    if not matrix.shape[1]:
        return 1.0
    singular = np.linalg.svd(matrix, compute_uv=False)
    return float(singular[-1] / singular[0]) if singular[0] > 0 and len(singular) == matrix.shape[1] else 0.0


def chosen(c: Context, fits: Callable[[Point], bool]) -> tuple[str, ...]:
    """Return the channels, taken in the plant's order, that fit together. Raises SpecError where not even one fits."""
    point, found = operating_point(c), ()
    for name in point.channels:
        if fits(point.of((*found, name))):
            found = (*found, name)
    if point.channels and not found:
        raise refused(c, Message("observer.constant.no-channel"))
    return found


def requested(c: Context, fits: Callable[[Point], bool]) -> Point:
    """Return the operating point with the channels to estimate. Raises SpecError, with channels that fit, otherwise."""
    whole = operating_point(c)
    point = whole.of(c.channels)
    if not fits(point):
        raise refused(c, Message("observer.constant.indistinct", channels=c.channels, names=chosen(c, fits)))
    return point


# ---- gains -----------------------------------------------------------------------------------------------------------


def bandwidth(c: Context, factor: float) -> float:
    """Return a bandwidth as a multiple of the rate at which a run lets a fault be learned, in paces."""
    return factor * learning_rate(c) / pace(c)


def weights(c: Context) -> np.ndarray:
    """Return the variance of each output's noise, relative to the square of its scale (m,)."""
    return (np.array(noise_std(c)) / np.array(output_scales(c))) ** 2


def mirrored(A: np.ndarray, C: np.ndarray, R: np.ndarray, omega: float) -> np.ndarray | None:
    """Return L (n×m) that moves every eigenvalue λ of A with Re λ > −ω/2 to −ω − λ̄ and leaves the others.

    Anderson & Moore, Optimal Control, 1990, §4.3: L = PCᵀR⁻¹ with the Riccati equation of A + ω/2 without process
    noise. Its solution is P = W Y⁻¹ Wᵀ, W (n×k) spanning the slow eigenspace of A, on which A is S, and Y that of a
    Lyapunov equation, (S + ω/2)ᵀY + Y(S + ω/2) = WᵀCᵀR⁻¹CW. None where an eigenvalue cannot be moved.
    """
    from scipy.linalg import schur

    n, shift = len(A), omega / 2
    if not n:
        return np.zeros((0, len(C)))
    T, U, k = schur(A, sort=lambda re, im=0.0: re > -shift)
    if not k:
        return np.zeros((n, len(C)))
    W, S = U[:, :k], T[:k, :k] + shift * np.eye(k)
    CW, one = C @ W, np.eye(k)
    Y = np.linalg.solve(np.kron(S.T, one) + np.kron(one, S.T), (CW.T @ (CW / R[:, None])).ravel()).reshape(k, k)
    values = np.linalg.eigvalsh((Y + Y.T) / 2)
    if not values[0] > 1e-12 * values[-1]:
        return None
    return W @ np.linalg.solve(Y, CW.T / R)


def in_units(L: np.ndarray, rows: Sequence[float], columns: Sequence[float], rate: float = 1.0) -> list[list[float]]:
    """Return a scaled gain in the plant's units: entry (i, j) times rows_i/columns_j and the rate."""
    return (L * np.array(rows)[:, None] / np.array(columns) * rate).tolist()


def of_state_and_faults(c: Context, L: np.ndarray) -> tuple[list[list[float]], list[list[float]]]:
    """Return the rows of a scaled gain for the state and for the faults, in the plant's units."""
    y, n = output_scales(c), c.n
    L = np.where(np.abs(L) > _ROUNDING * np.abs(L).max(initial=0.0), L, 0.0)
    return in_units(L[:n], state_scales(c), y, pace(c)), in_units(L[n:], typical_sizes(c), y, pace(c))
