"""Reduced-order observer for MIMO nonlinear time-varying systems (Control Theory & Applications 17, 2000), its (17).

Normal form (6): z' = A z + B [alpha(z, t) + F(z, t) u], y = C z, m blocks of sizes r_1, ..., r_m (the vector relative
degree), z = (y1, y1', ..., y2, ...). The reduced-order observer estimates everything but y; beside it stands the
full-order observer of the same form, z_hat' = A z_hat + B [alpha(z_hat, t) + F(z_hat, t) u] + L (y - C z_hat).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from . import integration
from .integration import Scenario, constant, held, simulate, smooth


@dataclass(frozen=True)
class Plant:
    """A plant in its own coordinates and its normal form.

    f(t, x, u) (n,); h(t, x) (m,); to_z(t, x), from_z(t, z) (n,); drift(t, z, u) (m,) is alpha + F u; blocks: r_i.
    """

    f: Callable
    h: Callable
    to_z: Callable
    from_z: Callable
    drift: Callable
    blocks: tuple[int, ...]
    x0: tuple[float, ...]

    @property
    def n(self) -> int:
        return sum(self.blocks)

    @property
    def firsts(self) -> np.ndarray:
        """Positions of y1, y2, ... in z."""
        return np.cumsum([0, *self.blocks[:-1]])

    @property
    def lasts(self) -> np.ndarray:
        """Positions of the highest derivatives in z."""
        return np.cumsum(self.blocks) - 1


# --- the paper's plant ------------------------------------------------------------------------------------------------


def _paper_f(t: float, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    x1, x2, x3, x4 = x
    return np.array(
        [x1 - (2 + np.cos(t)) * x2, x4**2 - 2 * x1 * x3 + np.exp(-t) * u[0], x3 + x4, x2 * np.sin(t) + u[1]]
    )


def _paper_drift(t: float, z: np.ndarray, u: np.ndarray) -> np.ndarray:
    """(z2', z4') of z2 = x1 - (2 + cos t) x2, z4 = x3 + x4."""
    x1, x2, x3, x4 = _paper_from_z(t, z)
    dx2 = x4**2 - 2 * x1 * x3 + np.exp(-t) * u[0]
    return np.array([z[1] - (2 + np.cos(t)) * dx2 + np.sin(t) * x2, z[3] + x2 * np.sin(t) + u[1]])


def _paper_from_z(t: float, z: np.ndarray) -> np.ndarray:
    return np.array([z[0], (z[0] - z[1]) / (2 + np.cos(t)), z[2], z[3] - z[2]])


PAPER = Plant(
    _paper_f,
    lambda t, x: np.array([x[0], x[2]]),
    lambda t, x: np.array([x[0], x[0] - (2 + np.cos(t)) * x[1], x[2], x[2] + x[3]]),
    _paper_from_z,
    _paper_drift,
    (2, 2),
    (1.0, 0.0, 0.5, 0.5),
)


def paper_scenario(horizon: float = 2.0, record: float = 0.01, noise: Sequence[tuple] = ()) -> Scenario:
    """u1 = -1, u2 = -sin t; the plant escapes at t = 2.515 s. noise: (values, sample time) per output."""
    inputs = [constant(-1.0), smooth(lambda t: -np.sin(t))]
    return Scenario(horizon, record, inputs, noise=[held(*one) for one in noise])


def paper_errors(t: np.ndarray, H: Sequence[float] = (5.0, 8.0), e0: Sequence[float] = (-2.0, 3.0)) -> np.ndarray:
    """e2, e4 (e = x_hat - x) at the times t, from the exact error equations; shape (len(t), 2).

    e2' = -(H1 - 1) e2 + 2 x4 e4 + e4^2,  e4' = -(H2 - 1) e4 + e2 sin t, integrated along the plant.
    """
    scenario = Scenario(float(t[-1]), float(t[1] - t[0]), paper_scenario().inputs)

    def rhs(at: float, w: np.ndarray, inside: float) -> np.ndarray:
        x, (e2, e4) = w[:4], w[4:]
        u = scenario.at(at, inside)[0]
        errors = [-(H[0] - 1) * e2 + 2 * x[3] * e4 + e4**2, -(H[1] - 1) * e4 + e2 * np.sin(at)]
        return np.concatenate([_paper_f(at, x, u), errors])

    return integration.dop853(rhs, np.array([*PAPER.x0, *e0]), scenario)[:, 4:]


# --- a second plant ---------------------------------------------------------------------------------------------------

D, Q = 0.4, 0.1  # linear and quadratic damping of the first cart


def _k(t: float) -> float:
    return 2 + np.cos(t)


def _carts_f(t: float, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    x1, x2, x3, x4, x5 = x
    return np.array(
        [
            x2,
            -_k(t) * (x1 - x4) - D * x2 - Q * x2**2 + x3,
            -2 * x3 + (1 + 0.2 * np.cos(x2)) * u[0],
            x5,
            _k(t) * (x1 - x4) - x5 - np.sin(x4) + (1 + 0.2 * np.sin(t)) * u[1],
        ]
    )


def _carts_drift(t: float, z: np.ndarray, u: np.ndarray) -> np.ndarray:
    """(z3', z5'), derived by hand: z3 = x2' as above, z5 = x5."""
    z1, z2, z3, z4, z5 = z
    x3 = z3 + _k(t) * (z1 - z4) + D * z2 + Q * z2**2
    dk = -np.sin(t)
    dz3 = -dk * (z1 - z4) - _k(t) * (z2 - z5) - (D + 2 * Q * z2) * z3 - 2 * x3 + (1 + 0.2 * np.cos(z2)) * u[0]
    return np.array([dz3, _k(t) * (z1 - z4) - z5 - np.sin(z4) + (1 + 0.2 * np.sin(t)) * u[1]])


CARTS = Plant(
    _carts_f,
    lambda t, x: np.array([x[0], x[3]]),
    lambda t, x: np.array([x[0], x[1], _carts_f(t, x, np.zeros(2))[1], x[3], x[4]]),
    lambda t, z: np.array([z[0], z[1], z[2] + _k(t) * (z[0] - z[3]) + D * z[1] + Q * z[1] ** 2, z[3], z[4]]),
    _carts_drift,
    (3, 2),
    (0.5, 0.0, 0.2, -0.3, 0.1),
)
"""Two carts coupled by a spring whose stiffness varies, the first one driven through a lag; y = (x1, x4):
x1' = x2
x2' = -(2 + cos(t))*(x1 - x4) - 0.4*x2 - 0.1*x2^2 + x3
x3' = -2*x3 + (1 + 0.2*cos(x2))*u1
x4' = x5
x5' = (2 + cos(t))*(x1 - x4) - x5 - sin(x4) + (1 + 0.2*sin(t))*u2
x(0) = (0.5, 0, 0.2, -0.3, 0.1). Vector relative degree (3, 2); H per block, e.g. ((12, 36), (6,)).
"""


def carts_scenario(horizon: float = 8.0, record: float = 0.01, noise: Sequence[tuple] = ()) -> Scenario:
    """u1 = sin 1.3 t, u2 = 0.5 cos 0.7 t."""
    inputs = [smooth(lambda t: np.sin(1.3 * t)), smooth(lambda t: 0.5 * np.cos(0.7 * t))]
    return Scenario(horizon, record, inputs, noise=[held(*one) for one in noise])


# --- observers --------------------------------------------------------------------------------------------------------


def reduced_zhat(plant: Plant, H: Sequence[Sequence[float]], omega: np.ndarray, y: np.ndarray) -> np.ndarray:
    """z_hat (n,) = (y_i, omega_i + H_i y_i) per block, the second line of (17)."""
    parts, start = [], 0
    for yi, Hi in zip(y, H, strict=True):
        parts.append(np.concatenate([[yi], omega[start : start + len(Hi)] + np.asarray(Hi) * yi]))
        start += len(Hi)
    return np.concatenate(parts)


def reduced(plant: Plant, H: Sequence[Sequence[float]], xhat0: Sequence[float]) -> tuple[Callable, np.ndarray]:
    """(17): omega' = (A_ - H C_)(omega + H y) + B_ [alpha(z_hat, t) + F(z_hat, t) u], per block of size r_i - 1."""

    def rhs(t: float, omega: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        zhat = reduced_zhat(plant, H, omega, y)
        drift, out = plant.drift(t, zhat, u), []
        for i, (first, size) in enumerate(zip(plant.firsts, plant.blocks, strict=True)):
            unmeasured = zhat[first + 1 : first + size]  # omega_i + H_i y_i
            moved = np.append(unmeasured[1:], drift[i])  # A_ (omega + H y) + B_ (alpha + F u)
            out.append(moved - np.asarray(H[i]) * unmeasured[0])
        return np.concatenate(out)

    z0, y0 = plant.to_z(0.0, np.array(xhat0, float)), plant.h(0.0, np.array(plant.x0))
    omega0 = [
        z0[first + 1 : first + size] - np.asarray(H[i]) * y0[i]
        for i, (first, size) in enumerate(zip(plant.firsts, plant.blocks, strict=True))
    ]
    return rhs, np.concatenate(omega0)


def full(plant: Plant, L: Sequence[Sequence[float]], xhat0: Sequence[float]) -> tuple[Callable, np.ndarray]:
    """Full-order observer in z; L holds r_i gains per block."""
    gain = np.zeros((plant.n, len(plant.blocks)))
    for i, first in enumerate(plant.firsts):
        gain[first : first + plant.blocks[i], i] = L[i]

    def rhs(t: float, z: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        dz = np.append(z[1:], 0.0)  # A z, the blocks' last rows set next
        dz[plant.lasts] = plant.drift(t, z, u)
        return dz + gain @ (y - z[plant.firsts])

    return rhs, plant.to_z(0.0, np.array(xhat0, float))


def run(
    plant: Plant,
    scenario: Scenario,
    gains: Sequence[Sequence[float]],
    xhat0: Sequence[float],
    solver: Callable,
    kind: str = "reduced",
    **options,
) -> dict[str, np.ndarray]:
    """Plant and observer ('reduced' with H per block, or 'full' with L per block); adds zhat and xhat (rows, n).

    xhat0 is the initial estimate in x; the reduced observer replaces its measured part by y(0).
    """
    rhs, o0 = (reduced if kind == "reduced" else full)(plant, gains, xhat0)
    out = simulate(
        lambda t, x, u, s, theta: plant.f(t, x, u),
        lambda t, x, u, s, theta: plant.h(t, x),
        plant.x0,
        scenario,
        rhs,
        o0,
        solver,
        **options,
    )
    if kind == "reduced":
        out["zhat"] = np.array([reduced_zhat(plant, gains, o, y) for o, y in zip(out["o"], out["y"], strict=True)])
    else:
        out["zhat"] = out["o"]
    out["xhat"] = np.array([plant.from_z(t, z) for t, z in zip(out["t"], out["zhat"], strict=True)])
    return out


PAPER_H, PAPER_XHAT0 = ((5.0,), (8.0,)), (1.0, -2.0, 0.5, 3.5)


def dop853(plant: Plant = PAPER, scenario: Scenario | None = None, gains=PAPER_H, xhat0=PAPER_XHAT0, **options) -> dict:
    """`run` with DOP853; options: kind, rtol, atol."""
    return run(plant, scenario or paper_scenario(), gains, xhat0, integration.dop853, **options)


def rk4(plant: Plant = PAPER, scenario: Scenario | None = None, gains=PAPER_H, xhat0=PAPER_XHAT0, **options) -> dict:
    """`run` with plain RK4; options: kind, h."""
    return run(plant, scenario or paper_scenario(), gains, xhat0, integration.rk4, **options)
