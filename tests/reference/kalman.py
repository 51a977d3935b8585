"""Adaptive Kalman observer, continuous and discrete, and joint EKF and UKF, for plants in form (x' = f + Phi theta).

Continuous: the parameter filter of Zhang (IEEE TAC 47(3), 2002; exponential forgetting: Zhang, Clavel, CDC 2001) with
a Riccati state gain, and Psi for sensor faults as in Zhao, Li, Li 2012 (34). Discrete: Zhang, Automatica 93, 2018,
with Psi. With theta constant and no forgetting both equal the joint Kalman filter on linear plants (Friedland's
separation of bias estimation, IEEE TAC 14(4), 1969); a test uses that.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .integration import AFTER, Scenario, dop853, simulate


@dataclass(frozen=True)
class Model:
    """x' = f + Phi theta, y = h + Psi theta. Each callable takes (t, x, u, s); A and C take theta as well.

    f (n,), Phi (n, p), h (m,), Psi (m, p); A = d(f + Phi theta)/dx (n, n), C = d(h + Psi theta)/dx (m, n).
    """

    n: int
    p: int
    m: int
    f: Callable
    Phi: Callable
    h: Callable
    Psi: Callable
    A: Callable
    C: Callable
    x0: tuple[float, ...] = ()

    def rate(self, t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """f + Phi theta."""
        return self.f(t, x, u, s) + self.Phi(t, x, u, s) @ theta

    def output(self, t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """h + Psi theta."""
        return self.h(t, x, u, s) + self.Psi(t, x, u, s) @ theta


@dataclass(frozen=True)
class Gains:
    """Weights and initial values, for both kinds of time.

    Q (n, n), R (m, m): spectral densities in continuous time, covariances per sample in discrete time. P0 (n, n), S0
    (p, p): initial covariances of x and theta (S0 is Gamma(0) in continuous time). lam: forgetting; continuous
    Gamma' = lam Gamma - ... (0: none), discrete 0 < lam <= 1 (1: none). Q_theta (p, p): random walk of theta per
    sample, joint filters only.
    """

    Q: np.ndarray
    R: np.ndarray
    P0: np.ndarray
    S0: np.ndarray
    lam: float
    xhat0: np.ndarray
    thetahat0: np.ndarray
    Q_theta: np.ndarray | None = None


# --- continuous time --------------------------------------------------------------------------------------------------


def continuous(model: Model, scenario: Scenario, gains: Gains, solver: Callable = dop853, **options) -> dict:
    """Plant and continuous adaptive Kalman observer together; adds xhat, thetahat, P, Upsilon, Gamma, yhat."""
    n, p, R_inv = model.n, model.p, np.linalg.inv(gains.R)
    ends = np.cumsum([n, p, n * n, n * p])

    def split(o: np.ndarray) -> list[np.ndarray]:
        x, theta, P, upsilon, gamma = np.split(o, ends, axis=-1)
        rows = o.shape[:-1]
        return [x, theta, P.reshape(*rows, n, n), upsilon.reshape(*rows, n, p), gamma.reshape(*rows, p, p)]

    def observer(t: float, o: np.ndarray, u: np.ndarray, s: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, theta, P, upsilon, gamma = split(o)
        A, C = model.A(t, x, u, s, theta), model.C(t, x, u, s, theta)
        Phi, Psi = model.Phi(t, x, u, s), model.Psi(t, x, u, s)
        K = P @ C.T @ R_inv
        omega = C @ upsilon + Psi
        gain = gamma @ omega.T @ R_inv
        residual = y - model.h(t, x, u, s) - Psi @ theta
        dP = A @ P + P @ A.T + gains.Q - P @ C.T @ R_inv @ C @ P
        d_upsilon = (A - K @ C) @ upsilon + Phi - K @ Psi
        d_gamma = gains.lam * gamma - gain @ omega @ gamma
        dx = model.rate(t, x, u, s, theta) + (K + upsilon @ gain) @ residual
        return np.concatenate([dx, gain @ residual, dP.ravel(), d_upsilon.ravel(), d_gamma.ravel()])

    start = [gains.xhat0, gains.thetahat0, gains.P0.ravel(), np.zeros(n * p), gains.S0.ravel()]
    out = simulate(model.rate, model.output, model.x0, scenario, observer, np.concatenate(start), solver, **options)
    out.update(zip(("xhat", "thetahat", "P", "Upsilon", "Gamma"), split(out["o"]), strict=True))
    columns = zip(out["t"], out["xhat"], out["u"], out["signal"], out["thetahat"], strict=True)
    out["yhat"] = np.array([model.output(*row) for row in columns])
    return out


# --- discrete time ----------------------------------------------------------------------------------------------------


def measurements(model: Model, scenario: Scenario, **options) -> dict[str, np.ndarray]:
    """The plant alone (DOP853); y at scenario.grid as right limits, noise included."""
    return simulate(model.rate, model.output, model.x0, scenario, **options)


def flow(
    model: Model, scenario: Scenario, t0: float, t1: float, x: np.ndarray, theta: np.ndarray, substeps: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """RK4 map over [t0, t1] in equal substeps: x(t1) (n,), its exact derivatives by x (n, n) and by theta (n, p)."""
    by_x, by_theta, h = np.eye(model.n), np.zeros((model.n, model.p)), (t1 - t0) / substeps
    for i in range(substeps):
        a = t0 + i * h
        mid = a + 0.5 * h
        k, kx, kt, slopes = np.zeros(model.n), np.zeros((model.n, model.n)), np.zeros((model.n, model.p)), []
        for c, weight in ((0.0, 1), (0.5, 2), (0.5, 2), (1.0, 1)):
            t, at_x = a + c * h, x + c * h * k
            u, s, _ = scenario.at(t, mid)
            A = model.A(t, at_x, u, s, theta)
            kt = A @ (c * h * kt) + model.Phi(t, at_x, u, s)
            k, kx = model.rate(t, at_x, u, s, theta), A @ (np.eye(model.n) + c * h * kx)
            slopes.append((weight, k, kx, kt))
        x = x + h / 6 * sum(w * k for w, k, _, _ in slopes)
        step_x = np.eye(model.n) + h / 6 * sum(w * kx for w, _, kx, _ in slopes)
        by_theta = step_x @ by_theta + h / 6 * sum(w * kt for w, _, _, kt in slopes)
        by_x = step_x @ by_x
    return x, by_x, by_theta


def _readout(
    model: Model, scenario: Scenario, t: float, x: np.ndarray, theta: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """y_hat, C, Psi at t, with the right limits of the signals."""
    u, s, _ = scenario.at(t, t + AFTER)
    return model.output(t, x, u, s, theta), model.C(t, x, u, s, theta), model.Psi(t, x, u, s)


def adaptive_discrete(model: Model, scenario: Scenario, y: np.ndarray, gains: Gains, substeps: int = 1) -> dict:
    """Discrete adaptive Kalman filter on y (rows, m) at scenario.grid.

    Row 0 holds the initial estimates; y[0] is not used; row k >= 1 holds the estimates after y[k].
    Returns xhat, thetahat, P, Upsilon, S, each (rows, ...).
    """
    t, x, theta, P, S = scenario.grid, gains.xhat0, gains.thetahat0, gains.P0, gains.S0
    upsilon, rows = np.zeros((model.n, model.p)), []
    for k in range(len(t)):
        if k:
            x, A, Phi = flow(model, scenario, t[k - 1], t[k], x, theta, substeps)
            P, upsilon = A @ P @ A.T + gains.Q, A @ upsilon + Phi
            y_hat, C, Psi = _readout(model, scenario, t[k], x, theta)
            sigma = C @ P @ C.T + gains.R
            K = P @ C.T @ np.linalg.inv(sigma)
            omega = C @ upsilon + Psi
            Lambda = np.linalg.inv(gains.lam * sigma + omega @ S @ omega.T)
            G = S @ omega.T @ Lambda
            left = np.eye(model.p) - G @ omega
            S = (left @ S @ left.T + G @ (gains.lam * sigma) @ G.T) / gains.lam  # (S - S Omega' Lambda Omega S) / lam
            P = (np.eye(model.n) - K @ C) @ P
            upsilon = upsilon - K @ omega
            residual = y[k] - y_hat
            theta = theta + G @ residual
            x = x + K @ residual + upsilon @ (G @ residual)
        rows.append((x, theta, P, upsilon, S))
    names = ("xhat", "thetahat", "P", "Upsilon", "S")
    return {name: np.array(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


def _block(a: np.ndarray, d: np.ndarray) -> np.ndarray:
    return np.block([[a, np.zeros((len(a), len(d)))], [np.zeros((len(d), len(a))), d]])


def _joint(model: Model, gains: Gains) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """z(0) = (x, theta), its covariance, and the process covariance per sample."""
    Q_theta = np.zeros((model.p, model.p)) if gains.Q_theta is None else gains.Q_theta
    return np.concatenate([gains.xhat0, gains.thetahat0]), _block(gains.P0, gains.S0), _block(gains.Q, Q_theta)


def joint_ekf(model: Model, scenario: Scenario, y: np.ndarray, gains: Gains, substeps: int = 1) -> dict:
    """Extended Kalman filter of z = (x, theta), theta a random walk. Rows as in `adaptive_discrete`; adds P (joint)."""
    n, t = model.n, scenario.grid
    z, P, Q = _joint(model, gains)
    rows = []
    for k in range(len(t)):
        if k:
            x, A, Phi = flow(model, scenario, t[k - 1], t[k], z[:n], z[n:], substeps)
            F = np.block([[A, Phi], [np.zeros((model.p, n)), np.eye(model.p)]])
            z, P = np.concatenate([x, z[n:]]), F @ P @ F.T + Q
            y_hat, C, Psi = _readout(model, scenario, t[k], z[:n], z[n:])
            H = np.hstack([C, Psi])
            K = P @ H.T @ np.linalg.inv(H @ P @ H.T + gains.R)
            z = z + K @ (y[k] - y_hat)
            left = np.eye(len(z)) - K @ H
            P = left @ P @ left.T + K @ gains.R @ K.T  # Joseph
        rows.append((z, P))
    return _joint_rows(rows, n)


def _joint_rows(rows: list, n: int) -> dict[str, np.ndarray]:
    z, P = (np.array(column) for column in zip(*rows, strict=True))
    return {"xhat": z[:, :n], "thetahat": z[:, n:], "P": P}


def joint_ukf(
    model: Model,
    scenario: Scenario,
    y: np.ndarray,
    gains: Gains,
    substeps: int = 1,
    alpha: float = 1.0,
    beta: float = 2.0,
    kappa: float = 0.0,
    redraw: bool = True,
) -> dict:
    """Unscented Kalman filter of z = (x, theta) (Wan, van der Merwe 2000), additive noise, Cholesky square roots.

    redraw: sigma points for the update are drawn from the predicted mean and covariance, Q included; otherwise the
    propagated ones are used again. Rows as in `adaptive_discrete`; adds P (joint).
    """
    n, t = model.n, scenario.grid
    z, P, Q = _joint(model, gains)
    spread = alpha**2 * (len(z) + kappa)  # N + lambda
    mean_weights = np.full(2 * len(z) + 1, 0.5 / spread)
    mean_weights[0] = 1 - len(z) / spread
    weights = mean_weights.copy()
    weights[0] += 1 - alpha**2 + beta

    def draw(z: np.ndarray, P: np.ndarray) -> np.ndarray:
        root = np.linalg.cholesky(spread * P).T
        return np.vstack([z, z + root, z - root])

    rows = []
    for k in range(len(t)):
        if k:
            points = draw(z, P)
            points[:, :n] = [flow(model, scenario, t[k - 1], t[k], w[:n], w[n:], substeps)[0] for w in points]
            z = mean_weights @ points
            P = (weights[:, None] * (points - z)).T @ (points - z) + Q
            points = draw(z, P) if redraw else points
            outputs = np.array([_readout(model, scenario, t[k], w[:n], w[n:])[0] for w in points])
            y_hat = mean_weights @ outputs
            scaled = weights[:, None] * (outputs - y_hat)
            Pyy, Pzy = scaled.T @ (outputs - y_hat) + gains.R, (points - z).T @ scaled
            K = Pzy @ np.linalg.inv(Pyy)
            z, P = z + K @ (y[k] - y_hat), P - K @ Pyy @ K.T
        rows.append((z, P))
    return _joint_rows(rows, n)
