"""The flow of a plant from one row to the next, with its derivatives: loops in the subset of engine/loops.

Inputs are held over the interval. In continuous time the classical Runge–Kutta method integrates the plant and its
variational equation with the same stages, so that F and G are the derivatives of the computed flow itself. Stiff plants
take the Rosenbrock method ROS2, which is L-stable (Verwer, Spee, Blom and Hundsdorfer, SIAM J. Sci. Comput. 20, 1999).
Outside the plant's domain the equations continue along their tangent at the nearest point inside.
"""

from collections.abc import Callable

import numpy as np

from thetascope.engine.filtering.bundles import Equations
from thetascope.engine.loops.declaration import Sizes, empty, loops


@loops(x="n", u="nu", theta="p", T="n n+d", f="n", A="n n", K="n n+d")
def stage(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    used: int,
    t: float,
    x: np.ndarray,
    u: np.ndarray,
    theta: np.ndarray,
    T: np.ndarray,
    f: np.ndarray,
    A: np.ndarray,
    K: np.ndarray,
):
    """Compute f, A = ∂f/∂x and the rate K of the tangents T = [∂x/∂x₀ ∂x/∂d] at one stage."""
    inside = empty(size.n)
    B = empty(size.n, size.d)
    for i in range(size.n):
        inside[i] = min(max(x[i], plant.low[i]), plant.high[i])
    rates(t, inside, u, theta, plant.par, f, A, B)
    for i in range(size.n):
        for j in range(size.n):
            f[i] += A[i, j] * (x[j] - inside[j])
        for c in range(size.n + used):
            K[i, c] = 0.0
        for j in range(size.n):
            for c in range(size.n + used):
                K[i, c] += A[i, j] * T[j, c]
        for c in range(used):
            K[i, size.n + c] += B[i, int(plant.chosen[c])]


@loops(u="nu", theta="p", x="n", T="n n+d")
def runge_kutta(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    used: int,
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
    A = empty(size.n, size.n)
    K = empty(size.n, size.n + size.d)
    for i in range(size.n):
        total[i] = 0.0
        at[i] = x[i]
        for c in range(size.n + used):
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
                for c in range(size.n + used):
                    at_T[i, c] = T[i, c] + part * h * K[i, c]
        stage(rates, size, plant, used, t + part * h, at, u, theta, at_T, f, A, K)
        for i in range(size.n):
            total[i] += weight * f[i]
            for c in range(size.n + used):
                total_T[i, c] += weight * K[i, c]
    for i in range(size.n):
        x[i] += h * total[i]
        for c in range(size.n + used):
            T[i, c] += h * total_T[i, c]


@loops(A="n n", inverse="n n")
def invert(size: Sizes, scale: float, A: np.ndarray, inverse: np.ndarray):
    """Compute the inverse of I − scale·A by Gauss–Jordan elimination with row exchanges."""
    M = empty(size.n, size.n)
    for i in range(size.n):
        for j in range(size.n):
            M[i, j] = -scale * A[i, j]
            inverse[i, j] = 0.0
        M[i, i] += 1.0
        inverse[i, i] = 1.0
    for c in range(size.n):
        pivot = c
        for i in range(c + 1, size.n):
            if abs(M[i, c]) > abs(M[pivot, c]):
                pivot = i
        for j in range(size.n):
            swap = M[c, j]
            M[c, j] = M[pivot, j]
            M[pivot, j] = swap
            swap = inverse[c, j]
            inverse[c, j] = inverse[pivot, j]
            inverse[pivot, j] = swap
        factor = 1.0 / M[c, c]
        for j in range(size.n):
            M[c, j] *= factor
            inverse[c, j] *= factor
        for i in range(size.n):
            if i != c:
                factor = M[i, c]
                for j in range(size.n):
                    M[i, j] -= factor * M[c, j]
                    inverse[i, j] -= factor * inverse[c, j]


@loops(u="nu", theta="p", x="n", T="n n+d")
def rosenbrock(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    used: int,
    t: float,
    h: float,
    u: np.ndarray,
    theta: np.ndarray,
    x: np.ndarray,
    T: np.ndarray,
):
    """Advance x and its tangents T by one step of ROS2: two stages with one matrix I − γhA, γ = 1 − 1/√2."""
    A = empty(size.n, size.n)
    A_end = empty(size.n, size.n)
    inverse = empty(size.n, size.n)
    f = empty(size.n)
    K = empty(size.n, size.n + size.d)
    k = empty(size.n)
    k_T = empty(size.n, size.n + size.d)
    at = empty(size.n)
    at_T = empty(size.n, size.n + size.d)
    stage(rates, size, plant, used, t, x, u, theta, T, f, A, K)
    invert(size, 0.2928932188134524 * h, A, inverse)
    for i in range(size.n):
        k[i] = 0.0
        for c in range(size.n + used):
            k_T[i, c] = 0.0
        for j in range(size.n):
            k[i] += inverse[i, j] * f[j]
            for c in range(size.n + used):
                k_T[i, c] += inverse[i, j] * K[j, c]
        at[i] = x[i] + h * k[i]
        for c in range(size.n + used):
            at_T[i, c] = T[i, c] + h * k_T[i, c]
    stage(rates, size, plant, used, t + h, at, u, theta, at_T, f, A_end, K)
    for i in range(size.n):
        x[i] += 1.5 * h * k[i]
        for c in range(size.n + used):
            T[i, c] += 1.5 * h * k_T[i, c]
    for i in range(size.n):
        for j in range(size.n):
            x[i] += 0.5 * h * inverse[i, j] * (f[j] - 2.0 * k[j])
            for c in range(size.n + used):
                T[i, c] += 0.5 * h * inverse[i, j] * (K[j, c] - 2.0 * k_T[j, c])


@loops(x="n", u="nu", theta="p", end="n", F="n n", G="n d")
def flow(
    rates: Callable,
    size: Sizes,
    plant: Equations,
    used: int,
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
    """Compute the state `width` seconds later in `steps` steps, and its derivatives in x and in constant directions.

    A negative number of steps: as many of the method for stiff plants.
    """
    T = empty(size.n, size.n + size.d)
    K = empty(size.n, size.n + size.d)
    f = empty(size.n)
    A = empty(size.n, size.n)
    for i in range(size.n):
        end[i] = x[i]
        for c in range(size.n + used):
            T[i, c] = 0.0
        T[i, i] = 1.0
    h = width / max(abs(steps), 1.0)
    for s in range(int(abs(steps))):
        if size.discrete == 1:
            stage(rates, size, plant, used, t + s * h, end, u, theta, T, f, A, K)
            for i in range(size.n):
                end[i] = f[i]
                for c in range(size.n + used):
                    T[i, c] = K[i, c]
        elif steps < 0.0:
            rosenbrock(rates, size, plant, used, t + s * h, h, u, theta, end, T)
        else:
            runge_kutta(rates, size, plant, used, t + s * h, h, u, theta, end, T)
    for i in range(size.n):
        for c in range(size.n):
            F[i, c] = T[i, c]
        for c in range(size.d):
            G[i, c] = 0.0
        for c in range(used):
            G[i, int(plant.chosen[c])] = T[i, size.n + c]


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
