"""The flow of a plant from one row to the next, with its derivatives: loops in the subset of engine/loops.

Inputs are held over the interval. In continuous time the classical Runge–Kutta method integrates the plant and its
variational equation with the same stages, so that F and G are the derivatives of the computed flow itself. Outside the
plant's domain the equations continue along their tangent at the nearest point inside.
"""

from collections.abc import Callable

import numpy as np

from thetascope.engine.filtering.bundles import Equations
from thetascope.engine.loops.declaration import Sizes, empty, loops


@loops(x="n", u="nu", theta="p", T="n n+d", f="n", K="n n+d")
def stage(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    t: float,
    x: np.ndarray,
    u: np.ndarray,
    theta: np.ndarray,
    T: np.ndarray,
    f: np.ndarray,
    K: np.ndarray,
):
    """Compute f and the rate K of the tangents T = [∂x/∂x₀ ∂x/∂d] at one stage."""
    inside = empty(size.n)
    A = empty(size.n, size.n)
    B = empty(size.n, size.d)
    for i in range(size.n):
        inside[i] = min(max(x[i], plant.low[i]), plant.high[i])
    rates(t, inside, u, theta, plant.par, f, A, B)
    for i in range(size.n):
        for j in range(size.n):
            f[i] += A[i, j] * (x[j] - inside[j])
        for c in range(size.n + size.d):
            K[i, c] = 0.0
        for j in range(size.n):
            for c in range(size.n + size.d):
                K[i, c] += A[i, j] * T[j, c]
        for c in range(size.d):
            K[i, size.n + c] += B[i, c]


@loops(u="nu", theta="p", x="n", T="n n+d")
def runge_kutta(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    t: float,
    h: float,
    u: np.ndarray,
    theta: np.ndarray,
    x: np.ndarray,
    T: np.ndarray,
):
    """Advance x and its tangents T by one step of the classical Runge–Kutta method."""
    at = empty(size.n)
    at_T = empty(size.n, size.n + size.d)
    total = empty(size.n)
    total_T = empty(size.n, size.n + size.d)
    f = empty(size.n)
    K = empty(size.n, size.n + size.d)
    for i in range(size.n):
        total[i] = 0.0
        at[i] = x[i]
        for c in range(size.n + size.d):
            total_T[i, c] = 0.0
            at_T[i, c] = T[i, c]
    for k in range(4):
        part = 0.5
        weight = 1.0 / 3.0
        if k == 0:
            part = 0.0
        if k == 3:
            part = 1.0
        if k == 0 or k == 3:
            weight = 1.0 / 6.0
        if k > 0:
            for i in range(size.n):
                at[i] = x[i] + part * h * f[i]
                for c in range(size.n + size.d):
                    at_T[i, c] = T[i, c] + part * h * K[i, c]
        stage(rates, size, plant, t + part * h, at, u, theta, at_T, f, K)
        for i in range(size.n):
            total[i] += weight * f[i]
            for c in range(size.n + size.d):
                total_T[i, c] += weight * K[i, c]
    for i in range(size.n):
        x[i] += h * total[i]
        for c in range(size.n + size.d):
            T[i, c] += h * total_T[i, c]


@loops(x="n", u="nu", theta="p", end="n", F="n n", G="n d")
def flow(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    t: float,
    width: float,
    steps: float,
    x: np.ndarray,
    u: np.ndarray,
    theta: np.ndarray,
    end: np.ndarray,
    F: np.ndarray,
    G: np.ndarray,
):
    """Compute the state `width` seconds later in `steps` steps, and its derivatives in x and in constant directions."""
    T = empty(size.n, size.n + size.d)
    K = empty(size.n, size.n + size.d)
    f = empty(size.n)
    for i in range(size.n):
        end[i] = x[i]
        for c in range(size.n + size.d):
            T[i, c] = 0.0
        T[i, i] = 1.0
    h = width / max(steps, 1.0)
    for s in range(int(steps)):
        if size.discrete == 1:
            stage(rates, size, plant, t + s * h, end, u, theta, T, f, K)
            for i in range(size.n):
                end[i] = f[i]
                for c in range(size.n + size.d):
                    T[i, c] = K[i, c]
        else:
            runge_kutta(rates, size, plant, t + s * h, h, u, theta, end, T)
    for i in range(size.n):
        for c in range(size.n):
            F[i, c] = T[i, c]
        for c in range(size.d):
            G[i, c] = T[i, size.n + c]


@loops(x="n", u="nu", theta="p", value="m", H="m n", J="m d")
def read(
    readings: Callable,
    size: Sizes,
    plant: Equations,
    t: float,
    x: np.ndarray,
    u: np.ndarray,
    theta: np.ndarray,
    value: np.ndarray,
    H: np.ndarray,
    J: np.ndarray,
):
    """Compute the outputs and their derivatives in x and in the directions."""
    inside = empty(size.n)
    for i in range(size.n):
        inside[i] = min(max(x[i], plant.low[i]), plant.high[i])
    readings(t, inside, u, theta, plant.par, value, H, J)
    for k in range(size.m):
        for j in range(size.n):
            value[k] += H[k, j] * (x[j] - inside[j])
