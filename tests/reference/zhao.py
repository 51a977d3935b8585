"""Zhao, Li, Li 2012 (Control Theory & Applications 29(1), 11-18): observers (9) and (34a-d), plants (43), (44).

Plants in canonical form (10): x' = A0 x + f(x, u) + Phi theta, y = c0 x + Psi theta, f triangular as in (5). The
observer uses the saturated f, which is globally Lipschitz as Theorem 2 asks; x_hat itself is never clamped.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from . import integration
from .integration import Scenario, held, pulse, simulate, sine, steps


@dataclass(frozen=True)
class Plant:
    """Canonical form (10). f(x, u) (n,), Phi(x, u, s) (n, p), Psi(u, s) (p,); *_saturated are the observer's."""

    n: int
    p: int
    f: Callable
    Phi: Callable
    Psi: Callable
    x0: tuple[float, ...]
    f_saturated: Callable
    Phi_saturated: Callable


@dataclass(frozen=True)
class Gains:
    """rho of (6), the forgetting factor lam of (34b) (printed as rho too), initial estimates, Gamma(0) = gamma0 I."""

    rho: float = 4.0
    lam: float = 4.0
    xhat0: tuple[float, ...] | None = None
    thetahat0: tuple[float, ...] | None = None
    gamma0: float = 1.0


def chain(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A0 (n, n) and c0 (n,) of (4)."""
    return np.eye(n, k=1), np.eye(n)[0]


def injection(n: int) -> tuple[np.ndarray, np.ndarray]:
    """S of (7), A0' S + S A0 + S = c0' c0, and k0 = S^-1 c0' / 2 of (8)."""
    A0, c0 = chain(n)
    S = solve_continuous_lyapunov(A0.T + 0.5 * np.eye(n), np.outer(c0, c0))
    return S, 0.5 * np.linalg.solve(S, c0)


# --- plants -----------------------------------------------------------------------------------------------------------

FLOOR = 1e-3  # of x1 in the observer's f2


def contois_f(x1: float, w: float, u: float, a1: float, a2: float, a3: float, a4: float) -> float:
    """f2 of (44) with x2 written as x1 w."""
    x2 = x1 * w
    return x2 * (w * w - a1 * u) / a1 + (a1 - w) ** 2 * (a4 * u - a3 * x2) / (a1 * a2)


def contois(a1: float = 1.0, a2: float = 1.0, a3: float = 1.0, a4: float = 0.1, physical: bool = False) -> Plant:
    """(44); with physical=True the faults theta1 phi1 + theta2 phi2 enter (43)'s first equation instead of (44)'s.

    Signals: phi1, phi2, phi3. Then Phi is carried over by the Jacobian of the coordinate change, whose column for
    x1_bar is (1, w^2 / a1), w = x2 / x1.
    """

    def saturated(x: np.ndarray) -> tuple[float, float]:
        x1 = max(x[0], FLOOR)
        return x1, min(max(x[1] / x1, 0.0), a1)

    def f(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return np.array([-u[0] * x[0], contois_f(x[0], x[1] / x[0], u[0], a1, a2, a3, a4)])

    def f_saturated(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return np.array([-u[0] * x[0], contois_f(*saturated(x), u[0], a1, a2, a3, a4)])

    def phi(w: float, s: np.ndarray) -> np.ndarray:
        slope = w * w / a1 if physical else 0.0
        return np.array([[s[0], s[1], 0.0], [slope * s[0], slope * s[1], 0.0]])

    return Plant(
        2,
        3,
        f,
        lambda x, u, s: phi(x[1] / x[0], s),
        lambda u, s: np.array([0.0, 0.0, s[2]]),
        (0.09, 0.01),
        f_saturated,
        lambda x, u, s: phi(saturated(x)[1], s),
    )


def from_physical(xbar: np.ndarray, a1: float = 1.0, a2: float = 1.0) -> np.ndarray:
    """(43) -> (44): x1 = x1_bar, x2 = a1 x1_bar x2_bar / (a2 x1_bar + x2_bar); shape (..., 2)."""
    one, two = xbar[..., 0], xbar[..., 1]
    return np.stack([one, a1 * one * two / (a2 * one + two)], axis=-1)


def to_physical(x: np.ndarray, a1: float = 1.0, a2: float = 1.0) -> np.ndarray:
    """(44) -> (43), the inverse: x2_bar = a2 x1 x2 / (a1 x1 - x2)."""
    return np.stack([x[..., 0], a2 * x[..., 0] * x[..., 1] / (a1 * x[..., 0] - x[..., 1])], axis=-1)


def contois_physical(
    x: np.ndarray, u: float, a1: float = 1.0, a2: float = 1.0, a3: float = 1.0, a4: float = 0.1
) -> np.ndarray:
    """Right-hand side of (43), without faults."""
    growth = a1 * x[0] * x[1] / (a2 * x[0] + x[1])
    return np.array([growth - u * x[0], -a3 * growth - u * x[1] + a4 * u])


def pendulum(g: float = 9.0, d: float = 0.5, tau: float = 0.5, b: float = 4.0) -> Plant:
    """A damped pendulum driven through a first-order actuator, angle measured. Globally Lipschitz: no saturation.

    States: x1 angle, x2 rate, x3 torque per inertia. Input u. Signals s1, s2, s3. Faults theta1..3:
        x1' = x2
        x2' = x3 - g*sin(x1) - d*x2 + s1*theta1     (a torque disturbance, switched by s1; process)
        x3' = (b*u - x3)/tau + (b/tau)*s2*theta2    (an offset of u, switched by s2; actuator)
        y   = x1 + s3*theta3                        (sensor)
    Defaults g = 9, d = 0.5, tau = 0.5, b = 4, x(0) = (0.3, 0, 0).
    """

    def f(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return np.array([0.0, -g * np.sin(x[0]) - d * x[1], (b * u[0] - x[2]) / tau])

    def phi(x: np.ndarray, u: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.array([[0.0, 0.0, 0.0], [s[0], 0.0, 0.0], [0.0, b / tau * s[1], 0.0]])

    return Plant(3, 3, f, phi, lambda u, s: np.array([0.0, 0.0, s[2]]), (0.3, 0.0, 0.0), f, phi)


PAPER, CONTOIS, PENDULUM = contois(), contois(physical=True), pendulum()


def paper_scenario(
    horizon: float = 100.0, record: float = 0.01, noise: tuple | None = None, sample: float | None = None
) -> Scenario:
    """The run of section 4. noise = (array of values, their sample time in s)."""
    phi = [pulse(0, 1, 0.5, 0.25), pulse(0, -1, 1.0, 0.5), pulse(0, 1, 0.5, 0.25)]
    theta = [steps([40], [0, 0.01]), steps([70], [0, 0.015]), steps([20], [0, 0.02])]
    u = steps([10, 20], [0.08, 0.02, 0.08])
    return Scenario(horizon, record, [u], phi, theta, [held(*noise)] if noise is not None else [], sample)


PAPER_GAINS, PENDULUM_GAINS = Gains(), Gains(rho=4.0, lam=1.0, gamma0=100.0)


def pendulum_scenario(horizon: float = 20.0, record: float = 0.01, noise: tuple | None = None) -> Scenario:
    """u = sin(2 pi 0.3 t). s1 is 1 on the first half of each 1.5 s, s2 of each 4 s, s3 of each 0.5 s, else 0.

    theta1 = 0.5 from 2 s, theta2 = -0.1 from 3 s, theta3 = 0.05 from 4 s.
    """
    s = [pulse(0, 1, 1.5, 0.75), pulse(0, 1, 4.0, 2.0), pulse(0, 1, 0.5, 0.25)]
    theta = [steps([2], [0, 0.5]), steps([3], [0, -0.1]), steps([4], [0, 0.05])]
    return Scenario(horizon, record, [sine(1.0, 0.3)], s, theta, [held(*noise)] if noise is not None else [])


# --- observers --------------------------------------------------------------------------------------------------------


def adaptive(plant: Plant, gains: Gains) -> tuple[Callable, np.ndarray]:
    """Observer (34a-d) as (right-hand side, initial value) of o = (x_hat, theta_hat, Upsilon, Gamma), flattened."""
    n, p, rho = plant.n, plant.p, gains.rho
    A0, c0 = chain(n)
    k0 = injection(n)[1]
    delta = rho ** np.arange(1, n + 1)  # the diagonal of Delta, (6)
    A = rho * (A0 - np.outer(k0, c0))

    def rhs(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, theta, upsilon, gamma = split(o, n, p)
        Phi, Psi = plant.Phi_saturated(x, u, s), plant.Psi(u, s)
        omega = upsilon[0] + Psi  # c0 Upsilon + Psi
        d_upsilon = A @ upsilon + rho * Phi / delta[:, None] - rho * k0[:, None] * Psi  # (34a)
        gain = gamma @ omega
        # (34b), not -gain gain': with that, an asymmetry of Gamma born of rounding would grow like exp(lam t)
        d_gamma = -gain[:, None] * (omega @ gamma) + gains.lam * gamma
        residual = y[0] - x[0] - Psi @ theta
        d_x = A0 @ x + plant.f_saturated(x, u) + Phi @ theta + delta * (k0 + upsilon @ gain / rho) * residual  # (34c)
        return np.concatenate([d_x, gain * residual, d_upsilon.ravel(), d_gamma.ravel()])  # (34d) is gain residual

    x0 = np.zeros(n) if gains.xhat0 is None else np.asarray(gains.xhat0, float)
    theta0 = np.zeros(p) if gains.thetahat0 is None else np.asarray(gains.thetahat0, float)
    return rhs, np.concatenate([x0, theta0, np.zeros(n * p), gains.gamma0 * np.eye(p).ravel()])


def split(o: np.ndarray, n: int, p: int) -> tuple[np.ndarray, ...]:
    """x_hat (n), theta_hat (p), Upsilon (n, p), Gamma (p, p) out of o; works on rows (..., len(o)) too."""
    rows, a, b = o.shape[:-1], n + p, n + p + n * p
    return o[..., :n], o[..., n:a], o[..., a:b].reshape(*rows, n, p), o[..., b:].reshape(*rows, p, p)


def high_gain(plant: Plant, gains: Gains) -> tuple[Callable, np.ndarray]:
    """Observer (9), blind to theta: x_hat' = A0 x_hat + f(x_hat, u) + Delta k0 (y - c0 x_hat)."""
    A0, _ = chain(plant.n)
    injected = gains.rho ** np.arange(1, plant.n + 1) * injection(plant.n)[1]

    def rhs(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        return A0 @ o + plant.f_saturated(o, u) + injected * (y[0] - o[0])

    return rhs, np.zeros(plant.n) if gains.xhat0 is None else np.asarray(gains.xhat0, float)


def run(plant: Plant, scenario: Scenario, gains: Gains, solver: Callable, kind: str = "adaptive", **options) -> dict:
    """Plant and observer together; adds xhat, yhat and, for kind 'adaptive', thetahat, Upsilon, Gamma to the dict."""
    A0, _ = chain(plant.n)
    observer, o0 = (adaptive if kind == "adaptive" else high_gain)(plant, gains)
    out = simulate(
        lambda t, x, u, s, theta: A0 @ x + plant.f(x, u) + plant.Phi(x, u, s) @ theta,
        lambda t, x, u, s, theta: np.array([x[0] + plant.Psi(u, s) @ theta]),
        plant.x0,
        scenario,
        observer,
        o0,
        solver,
        **options,
    )
    if kind == "adaptive":
        names = ("xhat", "thetahat", "Upsilon", "Gamma")
        out.update(zip(names, split(out["o"], plant.n, plant.p), strict=True))
        psi = np.array([plant.Psi(u, s) for u, s in zip(out["u"], out["signal"], strict=True)])
        out["yhat"] = out["xhat"][:, :1] + np.sum(psi * out["thetahat"], axis=1, keepdims=True)
    else:
        out.update(xhat=out["o"], yhat=out["o"][:, :1])
    return out


def dop853(plant: Plant = PAPER, scenario: Scenario | None = None, gains: Gains = PAPER_GAINS, **options) -> dict:
    """`run` with DOP853; options: kind ('adaptive', 'high-gain'), rtol, atol."""
    return run(plant, scenario or paper_scenario(), gains, integration.dop853, **options)


def rk4(plant: Plant = PAPER, scenario: Scenario | None = None, gains: Gains = PAPER_GAINS, **options) -> dict:
    """`run` with plain RK4; options: kind, h."""
    return run(plant, scenario or paper_scenario(), gains, integration.rk4, **options)


def excitation(plant: Plant, scenario: Scenario, rho: float, window: float, **options) -> np.ndarray:
    """Smallest eigenvalue of the windowed Gramian (36) at each recorded t with t + window inside the run.

    The filter (35) is driven by Phi and Psi only (plants whose Phi does not depend on x); the Gramian's integral is
    integrated with it. `window` must be a multiple of scenario.record.
    """
    n, p = plant.n, plant.p
    A0, c0 = chain(n)
    k0 = injection(n)[1]
    delta = rho ** np.arange(1, n + 1)

    def rhs(t: float, z: np.ndarray, inside: float) -> np.ndarray:
        u, s, _ = scenario.at(t, inside)
        upsilon = z[: n * p].reshape(n, p)
        Phi, Psi = plant.Phi(np.ones(n), u, s), plant.Psi(u, s)
        omega = upsilon[0] + Psi
        d = rho * (A0 - np.outer(k0, c0)) @ upsilon + rho * Phi / delta[:, None] - rho * np.outer(k0, Psi)
        return np.concatenate([d.ravel(), np.outer(omega, omega).ravel()])

    z = integration.dop853(rhs, np.zeros(n * p + p * p), scenario, **options)
    gramian, lag = z[:, n * p :].reshape(-1, p, p), round(window / scenario.record)
    return np.linalg.eigvalsh(gramian[lag:] - gramian[:-lag])[:, 0]
