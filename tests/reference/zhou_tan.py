"""Zhou, Tan 2012 (Control Theory & Applications 29): sandwich systems with hysteresis, observer (13), discrete time.

L1 (1)-(2), parallel backlash operators (5)-(9), L2 (3)-(4); y is L2's last state, the hysteresis is driven by x, L1's
last state. Each operator's threshold is its own z_i(k-1), as the observer's formulas have it.
"""

from dataclasses import dataclass

import numpy as np

LINEAR_UP, LINEAR_DOWN, MEMORY = 1, -1, 0


@dataclass(frozen=True)
class Plant:
    """Matrices of L1 and L2, weights w_i, slopes m1_i, m2_i and half-widths D1_i, D2_i of the operators."""

    A11: np.ndarray
    B11: np.ndarray
    A22: np.ndarray
    B22: np.ndarray
    w: np.ndarray
    m1: np.ndarray
    m2: np.ndarray
    D1: np.ndarray
    D2: np.ndarray

    @property
    def n1(self) -> int:
        return len(self.A11)


def _paper(B: float) -> Plant:
    c, one = np.array([0.14, 0.12, 0.1, 0.08, 0.06, 0.04, 0.02]), np.ones(7)
    A11, A22 = np.array([[0.8, 0.0], [0.01, 0.45]]), np.array([[0.8, 0.0], [0.01, 0.9]])
    return Plant(A11, np.array([B, 0.0]), A22, np.array([0.25, 0.0]), one, one, one, c / 2, c / 2)


PAPER = _paper(0.4107)
AS_PRINTED = _paper(0.004107)

OTHER = Plant(
    A11=np.array([[0.7, 0.05], [0.04, 0.5]]),
    B11=np.array([0.3, 0.0]),
    A22=np.array([[0.75, -0.02], [0.05, 0.85]]),
    B22=np.array([0.4, 0.0]),
    w=np.array([0.5, 0.8, 0.3]),
    m1=np.array([1.2, 1.0, 0.9]),
    m2=np.array([1.0, 1.1, 0.9]),
    D1=np.array([0.03, 0.02, 0.01]),
    D2=np.array([0.02, 0.025, 0.01]),
)
"""Three operators, slopes and half-widths that differ with the direction. K = (0, 0, 0.1, 0.1) for the observer."""


def operators(plant: Plant, x: float, x_before: float, z_before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(6)-(9): z (operators,) and the zone of each operator (LINEAR_UP, LINEAR_DOWN or MEMORY)."""
    dx = x - x_before
    m = plant.m1 if dx >= 0 else plant.m2  # (6)
    g1 = (x > z_before / plant.m1 + plant.D1) & (dx > 0)
    g2 = (x < z_before / plant.m2 - plant.D2) & (dx < 0)
    linear = m * (x - plant.D1 * g1 + plant.D2 * g2)  # (7)
    return np.where(g1 | g2, linear, z_before), g1.astype(int) - g2.astype(int)  # (8)


def advance(plant: Plant, x: np.ndarray, z: np.ndarray, u: float) -> np.ndarray:
    """(11)-(12): x(k+1) from x(k) and z(k), v = sum w_i z_i of (5)."""
    x1, x2 = x[: plant.n1], x[plant.n1 :]
    v = plant.w @ z
    return np.concatenate([plant.A11 @ x1 + plant.B11 * u, plant.A22 @ x2 + plant.B22 * v])


def nonsmooth(
    plant: Plant,
    u: np.ndarray,
    K: np.ndarray,
    xhat0: np.ndarray,
    x0: np.ndarray | None = None,
    y_noise: np.ndarray | None = None,
    before_hat: float | None = None,
) -> dict[str, np.ndarray]:
    """Plant (12) and observer (13) for k = 0 .. len(u), operators from z(-1) = 0, the plant with delta x(0) = 0.

    before_hat is x_hat_12(-1), which the paper does not give; None: delta x_hat_12(0) = 0, operators hold at k = 0.
    Returns x, xhat (rows, n1 + n2), y (rows,), z, zhat, zone, zonehat (rows, operators): row k holds time k, its z and
    zone are those of step k. u (N,) gives N + 1 rows.
    """
    out, last = _empty(plant, len(u) + 1), plant.n1 - 1
    xh = np.array(xhat0, float)
    x = np.zeros_like(xh) if x0 is None else np.array(x0, float)
    z, zh = np.zeros(len(plant.w)), np.zeros(len(plant.w))
    x_before, xh_before = x[last], xh[last] if before_hat is None else before_hat
    for k in range(len(u) + 1):
        z, zone = operators(plant, x[last], x_before, z)
        zh, zone_hat = operators(plant, xh[last], xh_before, zh)
        y = x[-1] + (0.0 if y_noise is None else y_noise[k])
        row = {"x": x, "xhat": xh, "y": y, "z": z, "zhat": zh, "zone": zone, "zonehat": zone_hat}
        for name, value in row.items():
            out[name][k] = value
        if k < len(u):
            x_before, xh_before = x[last], xh[last]
            xh = advance(plant, xh, zh, u[k]) + K * (y - xh[-1])
            x = advance(plant, x, z, u[k])
    return out


def conventional(
    plant: Plant, u: np.ndarray, y: np.ndarray, K: np.ndarray, xhat0: np.ndarray, slope: float
) -> np.ndarray:
    """(22): the hysteresis replaced by v = slope x. y (N + 1,) from `nonsmooth`; returns xhat (N + 1, n1 + n2)."""
    rows = np.empty((len(u) + 1, len(xhat0)))
    rows[0] = xhat0
    for k, uk in enumerate(u):
        x1, x2 = rows[k, : plant.n1], rows[k, plant.n1 :]
        x2_next = plant.A22 @ x2 + plant.B22 * slope * x1[-1]
        rows[k + 1] = np.concatenate([plant.A11 @ x1 + plant.B11 * uk, x2_next]) + K * (y[k] - x2[-1])
    return rows


def frozen_rank(plant: Plant, active: np.ndarray) -> int:
    """Rank of the observability matrix of (C, A(k)) with the operators `active` (bool) in their linear zone."""
    n1, n = plant.n1, plant.n1 + len(plant.A22)
    A = np.zeros((n, n))
    A[:n1, :n1], A[n1:, n1:] = plant.A11, plant.A22
    A[n1:, n1 - 1] = plant.B22 * np.sum(plant.w * plant.m1 * active)  # beta_2 of (11)
    C = np.eye(n)[-1]
    return int(np.linalg.matrix_rank(np.array([C @ np.linalg.matrix_power(A, k) for k in range(n)]), tol=1e-12))


def _empty(plant: Plant, rows: int) -> dict[str, np.ndarray]:
    n, p = plant.n1 + len(plant.A22), len(plant.w)
    widths = {"x": (n,), "xhat": (n,), "y": (), "z": (p,), "zhat": (p,), "zone": (p,), "zonehat": (p,)}
    return {name: np.zeros((rows, *shape)) for name, shape in widths.items()}
