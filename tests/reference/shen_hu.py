"""Shen, Hu 2015 (Guangxi Sciences 22(4), 421-424): continuous nonsmooth adaptive observer (11)-(12) and baselines.

Plants (1): x' = A x + gamma(x, t) + b w(t) theta, y = x1, A the chain of integrators. The matching condition (8),
P f = C' g', makes every column of f(x, u) a multiple of one vector b when P is regular; hence f = b w with a row w of
p known signals, and g = scale w'.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import minimize

from . import integration
from .integration import Scenario, constant, held, simulate, sine, smooth


@dataclass(frozen=True)
class Plant:
    """Form (1) with f = b w: gamma(x, t) (n,), b (n,); w are the scenario's signals (p,)."""

    n: int
    gamma: Callable
    b: tuple[float, ...]
    x0: tuple[float, ...]


@dataclass(frozen=True)
class Gains:
    """K, rho, alpha and lambda of (11)-(12); `scale` of g = scale w. rho = 0: the linear observer of reference [5]."""

    K: tuple[float, ...] = (3.0, 2.0)
    rho: float = 0.8
    alpha: float = 0.85
    lam: float = 10.0
    scale: float = 1.0
    xhat0: tuple[float, ...] | None = None
    thetahat0: tuple[float, ...] | None = None

    def linear(self) -> "Gains":
        """The linear baseline: no homogeneous term."""
        return self._with(self.K, 0.0)

    def linear_fair(self) -> "Gains":
        """The fair linear baseline: gain (1 + rho) K, what (9) compares with."""
        return self._with(tuple((1 + self.rho) * k for k in self.K), 0.0)

    def _with(self, K: tuple[float, ...], rho: float) -> "Gains":
        return Gains(K, rho, self.alpha, self.lam, self.scale, self.xhat0, self.thetahat0)


PAPER = Plant(2, lambda x, t: np.array([0.1 * np.sin(x[0] * x[1]), 0.0]), (1.0, 1.0), (1.0, -1.0))

CHAIN = Plant(
    3,
    lambda x, t: np.array([-0.5 * x[0], -0.5 * x[1] + 0.2 * np.sin(x[0]), -0.5 * x[2] + 0.2 * np.cos(x[1])]),
    (1.0, 4.0, 3.75),
    (0.5, -0.5, 1.0),
)
"""A leaky chain with two parameters, signals w1 = sin t - cos t and w2 = cos 2.3 t, no input:
x1' = x2 - 0.5*x1 + w1*theta1 + w2*theta2
x2' = x3 - 0.5*x2 + 0.2*sin(x1) + 4*w1*theta1 + 4*w2*theta2
x3' = -0.5*x3 + 0.2*cos(x2) + 3.75*w1*theta1 + 3.75*w2*theta2
y = x1,   x(0) = (0.5, -0.5, 1).
With CHAIN_GAINS, C (sI - A + KC)^-1 b = (s + 1.5)(s + 2.5) / ((s + 1)(s + 2)(s + 3)): strictly positive real.
"""

PAPER_GAINS, CHAIN_GAINS = Gains(), Gains(K=(6.0, 11.0, 6.0), rho=0.5, alpha=0.9, lam=20.0)


def paper_scenario(
    horizon: float = 100.0, record: float = 0.01, noise: tuple | None = None, theta: float = 1.0
) -> Scenario:
    """theta constant from t = 0, w = sin t - cos t; noise = (array of values, their sample time in s)."""
    w = smooth(lambda t: np.sin(t) - np.cos(t))
    return Scenario(horizon, record, (), [w], [constant(theta)], [held(*noise)] if noise is not None else [])


def chain_scenario(horizon: float = 20.0, record: float = 0.01, noise: tuple | None = None) -> Scenario:
    """theta = (0.8, -0.5) from t = 0."""
    w = [smooth(lambda t: np.sin(t) - np.cos(t)), sine(1.0, 2.3 / (2 * np.pi), np.pi / 2)]
    theta = [constant(0.8), constant(-0.5)]
    return Scenario(horizon, record, (), w, theta, [held(*noise)] if noise is not None else [])


def signed_power(e: float, alpha: np.ndarray) -> np.ndarray:
    """|e|^alpha sign(e)."""
    return np.sign(e) * np.abs(e) ** alpha


def exponents(n: int, alpha: float) -> np.ndarray:
    """alpha_i = i alpha - (i - 1), i = 1..n; all positive when alpha > 1 - 1/n (the paper prints 1/(n - 1))."""
    i = np.arange(1, n + 1)
    return i * alpha - (i - 1)


def observer(plant: Plant, gains: Gains, p: int) -> tuple[Callable, np.ndarray]:
    """(11)-(12) as (right-hand side, initial value) of o = (x_hat, theta_hat); e1 = y - x_hat_1."""
    A, b, K = np.eye(plant.n, k=1), np.array(plant.b), np.array(gains.K)
    alpha = exponents(plant.n, gains.alpha)

    def rhs(t: float, o: np.ndarray, u: np.ndarray, w: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, theta = o[: plant.n], o[plant.n :]
        e1 = y[0] - x[0]
        F = K * signed_power(e1, alpha)
        dx = A @ x + plant.gamma(x, t) + b * (w @ theta) + K * e1 + gains.rho * F  # (11)
        return np.concatenate([dx, gains.lam * gains.scale * w * e1])  # (12)

    x0 = np.zeros(plant.n) if gains.xhat0 is None else np.array(gains.xhat0)
    return rhs, np.concatenate([x0, np.zeros(p) if gains.thetahat0 is None else np.array(gains.thetahat0)])


def run(plant: Plant, scenario: Scenario, gains: Gains, solver: Callable, **options) -> dict[str, np.ndarray]:
    """Plant and observer together; adds xhat (rows, n) and thetahat (rows, p) to the dict of `simulate`."""
    A, b = np.eye(plant.n, k=1), np.array(plant.b)
    rhs, o0 = observer(plant, gains, len(scenario.theta))
    out = simulate(
        lambda t, x, u, w, theta: A @ x + plant.gamma(x, t) + b * (w @ theta),
        lambda t, x, u, w, theta: x[:1],
        plant.x0,
        scenario,
        rhs,
        o0,
        solver,
        **options,
    )
    out.update(xhat=out["o"][:, : plant.n], thetahat=out["o"][:, plant.n :])
    return out


def dop853(plant: Plant = PAPER, scenario: Scenario | None = None, gains: Gains = PAPER_GAINS, **options) -> dict:
    """`run` with DOP853; options: rtol, atol."""
    return run(plant, scenario or paper_scenario(), gains, integration.dop853, **options)


def rk4(plant: Plant = PAPER, scenario: Scenario | None = None, gains: Gains = PAPER_GAINS, **options) -> dict:
    """`run` with plain RK4; options: h."""
    return run(plant, scenario or paper_scenario(), gains, integration.rk4, **options)


def lyapunov_margin(P: np.ndarray, K: np.ndarray) -> float:
    """Largest eigenvalue of (A - KC)'P + P(A - KC); negative when the plain Lyapunov inequality holds."""
    closed = np.eye(len(P), k=1) - np.outer(K, np.eye(len(P))[0])
    return float(np.linalg.eigvalsh(closed.T @ P + P @ closed)[-1])


def matching(K: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, float]:
    """P > 0 with P b = C' (so g = w in (8)) and margin: the eigenvalues of (A - KC)'P + P(A - KC) are <= -margin tr P.

    P is a particular solution of the linear equation plus a combination of its homogeneous ones, found by Nelder-Mead
    on the margin (quasi-convex; 1 unknown for n = 2, 3 for n = 3). margin <= 0: none found.
    """
    n, b = len(b), np.asarray(b, float)
    pairs = [{i, j} for i in range(n) for j in range(i + 1)]
    basis = np.array([[[float(pair == {r, c}) for c in range(n)] for r in range(n)] for pair in pairs])
    equations = np.stack([M @ b for M in basis], axis=1)
    particular = np.linalg.lstsq(equations, np.eye(n)[0], rcond=None)[0]
    free = null_space(equations)

    def P(q: np.ndarray) -> np.ndarray:
        return np.tensordot(particular + free @ q, basis, axes=1)

    def cost(q: np.ndarray) -> float:
        low = np.linalg.eigvalsh(P(q))[0]
        # lead the search into the cone of positive definite P first
        return lyapunov_margin(P(q), K) / np.trace(P(q)) if low > 1e-9 else 1e3 - low

    options = {"maxiter": 4000, "xatol": 1e-10, "fatol": 1e-12}
    starts = [s * np.ones(free.shape[1]) for s in (0.0, 1.0, -1.0)]
    best = min((minimize(cost, q, method="Nelder-Mead", options=options) for q in starts), key=lambda found: found.fun)
    return P(best.x), -float(best.fun)
