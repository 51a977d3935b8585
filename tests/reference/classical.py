"""Observers with constant gains, sliding modes, decoupling and mixing, in plain NumPy, for plants as `kalman.Model`.

Written from the equations of the sources, with pseudoinverses and adjugates instead of the program's own elimination
and minors: Beale & Shafai 1989; Edwards & Spurgeon 1998, ch. 6; Chen & Patton 1999, ch. 3; Aranovskiy et al. 2017.
"""

from collections.abc import Sequence

import numpy as np

from .integration import Scenario, simulate
from .kalman import Model


def proportional_integral(
    model: Model, scenario: Scenario, K_P: np.ndarray, K_I: np.ndarray, xhat0: Sequence[float], **options
) -> dict[str, np.ndarray]:
    """Plant and observer; adds xhat and thetahat."""
    n = model.n

    def observer(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, theta = o[:n], o[n:]
        r = y - model.output(t, x, u, s, theta)
        return np.concatenate([model.rate(t, x, u, s, theta) + K_P @ r, K_I @ r])

    out = _run(model, scenario, observer, [*xhat0, *np.zeros(model.p)], options)
    return out | {"xhat": out["o"][:, :n], "thetahat": out["o"][:, n:]}


def sliding_mode(
    model: Model, scenario: Scenario, G: np.ndarray, numbers: dict, xhat0: Sequence[float], **options
) -> dict[str, np.ndarray]:
    """``numbers``: kappa, rho (m,), layer (m,), tau."""
    n, none = model.n, np.zeros(model.p)

    def observer(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, theta = o[:n], o[n:]
        r = y - model.h(t, x, u, s)
        in_layers = r / numbers["layer"]
        v = numbers["kappa"] * r + numbers["rho"] * in_layers / np.sqrt(1 + in_layers @ in_layers)
        dx = model.f(t, x, u, s) + model.A(t, x, u, s, none) @ G @ r + G @ v
        effect = model.C(t, x, u, s, none) @ model.Phi(t, x, u, s)
        return np.concatenate([dx, (np.linalg.pinv(effect) @ v - theta) / numbers["tau"]])

    out = _run(model, scenario, observer, [*xhat0, *np.zeros(model.p)], options)
    return out | {"xhat": out["o"][:, :n], "thetahat": out["o"][:, n:]}


def unknown_input(
    model: Model,
    scenario: Scenario,
    H: np.ndarray,
    K: np.ndarray,
    tau: float,
    xhat0: Sequence[float],
    y0: Sequence[float],
    **options,
) -> dict[str, np.ndarray]:
    """``y0``: the measurement at the beginning."""
    n, m, none = model.n, model.m, np.zeros(model.p)

    def observer(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, filtered, theta = o[:n] + H @ y, o[n : n + m], o[n + m :]
        f, C = model.f(t, x, u, s), model.C(t, x, u, s, none)
        unexplained = (y - filtered) / tau
        dz = f - H @ (C @ f) + K @ (y - model.h(t, x, u, s))
        found = np.linalg.pinv(C @ model.Phi(t, x, u, s)) @ unexplained
        return np.concatenate([dz, unexplained + C @ f, (found - theta) / tau])

    start = np.concatenate([np.array(xhat0) - H @ np.array(y0), y0, np.zeros(model.p)])
    out = _run(model, scenario, observer, start, options)
    return out | {"xhat": out["o"][:, :n] + out["y"] @ H.T, "thetahat": out["o"][:, n + m :]}


def drem(model: Model, scenario: Scenario, numbers: dict, xhat0: Sequence[float], **options) -> dict[str, np.ndarray]:
    """``numbers``: Q (n, n), R (m, m), P0 (n, n), ell, gamma (p,), typical (p,)."""
    n, p = model.n, model.p
    R_inv, typical = np.linalg.inv(numbers["R"]), np.diag(numbers["typical"])
    ends = np.cumsum([n, n * n, n * p, p * p, p])

    def split(o: np.ndarray) -> list[np.ndarray]:
        plain, P, Upsilon, M, Y, theta = np.split(o, ends)
        return [plain, P.reshape(n, n), Upsilon.reshape(n, p), M.reshape(p, p), Y, theta]

    def observer(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        plain, P, Upsilon, M, Y, theta = split(o)
        x = plain + Upsilon @ theta
        A, C = model.A(t, x, u, s, theta), model.C(t, x, u, s, theta)
        K, Omega = P @ C.T @ R_inv, C @ Upsilon + model.Psi(t, x, u, s)
        without = y - model.h(t, x, u, s) - C @ (plain - x)
        seen = Omega @ typical
        mu = (1 + np.trace(M) / p) ** (p - 1)
        Delta, regressed = np.linalg.det(M) / mu, adjugate(M) @ Y / mu
        rates = [
            model.f(t, x, u, s) + A @ (plain - x) + K @ without,
            A @ P + P @ A.T + numbers["Q"] - P @ C.T @ R_inv @ C @ P,
            (A - K @ C) @ Upsilon + model.Phi(t, x, u, s) - K @ model.Psi(t, x, u, s),
            seen.T @ R_inv @ seen - numbers["ell"] * M,
            seen.T @ R_inv @ without - numbers["ell"] * Y,
            numbers["gamma"] * Delta * (typical @ regressed - Delta * theta) / (1 + Delta**2),
        ]
        return np.concatenate([np.ravel(rate) for rate in rates])

    start = [xhat0, np.ravel(numbers["P0"]), np.zeros(n * p + p * p + 2 * p)]
    out = _run(model, scenario, observer, np.concatenate(start), options)
    rows = [split(o) for o in out["o"]]
    return out | {"xhat": np.array([r[0] + r[2] @ r[5] for r in rows]), "thetahat": np.array([r[5] for r in rows])}


def adjugate(M: np.ndarray) -> np.ndarray:
    """Faddeev and LeVerrier's recursion, which needs no inverse."""
    size, term = len(M), np.eye(len(M))
    for k in range(1, size):
        product = M @ term
        term = product - np.trace(product) / k * np.eye(size)
    return (-1) ** (size - 1) * term


def _run(model: Model, scenario: Scenario, observer, start: Sequence[float], options: dict) -> dict[str, np.ndarray]:
    return simulate(model.rate, model.output, model.x0, scenario, observer, start, **options)
