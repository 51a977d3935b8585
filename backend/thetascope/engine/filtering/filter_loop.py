"""The extended Kalman filter along rows, and the open-loop simulation: loops in the subset of engine/loops.

State z = [x; e], e the coloured part of the readings' noise (first-order autoregression):

    x⁺ = φ(x, u, θ, Δ) + w,  w ~ N(0, QΔ + X);   e⁺ = a^Δ e + N(0, s²(1 − a^{2Δ}));   y = h(x) + e + v,  v ~ N(0, R).

Readings of a row are processed one after the other, so that a missing cell is one update fewer. With ``linearise`` the
plant is linearised at the estimate and its values are stored; else the stored ones are used, which makes the filter
linear: −2 log L is then a function of the noise alone.
"""

from collections.abc import Callable
from math import exp, isnan, log, sqrt

import numpy as np

from thetascope.engine.filtering.bundles import Equations, Faults, Noise, Path, Rows
from thetascope.engine.filtering.flow import flow, read
from thetascope.engine.loops.declaration import Sizes, empty, loops


@loops(z="na", P="na na")
def correct(size: Sizes, noise: Noise, data: Rows, path: Path, k: int, z: np.ndarray, P: np.ndarray) -> float:
    """Correct z and P by the readings of row k, and return their share of −2 log L."""
    PH = empty(size.na)
    loss = 0.0
    for i in range(size.m):
        if isnan(data.y[k, i]):
            path.nu[k, i] = data.y[k, i]
            path.sd[k, i] = data.y[k, i]
            for a in range(size.na):
                path.K[k, i, a] = 0.0
        else:
            expected = path.h[k, i]
            for j in range(size.n):
                expected += path.H[k, i, j] * (z[j] - path.prior[k, j])
            for a in range(size.na):
                PH[a] = 0.0
                for j in range(size.n):
                    PH[a] += P[a, j] * path.H[k, i, j]
            if size.na > size.n:
                expected += z[size.n + i]
                for a in range(size.na):
                    PH[a] += P[a, size.n + i]
            variance = noise.r[i]
            for j in range(size.n):
                variance += path.H[k, i, j] * PH[j]
            if size.na > size.n:
                variance += PH[size.n + i]
            error = data.y[k, i] - expected
            path.sd[k, i] = sqrt(variance)
            path.nu[k, i] = error / path.sd[k, i]
            loss += log(variance) + error * error / variance
            for a in range(size.na):
                path.K[k, i, a] = PH[a] / variance
                z[a] += path.K[k, i, a] * error
            for a in range(size.na):
                for b in range(size.na):
                    P[a, b] -= path.K[k, i, a] * PH[b]
    return loss


@loops(P="na na")
def spread_ahead(size: Sizes, noise: Noise, data: Rows, path: Path, k: int, P: np.ndarray):
    """Replace P by its value at the end of the interval after row k."""
    W = empty(size.na, size.na)
    decay = empty(size.na)
    for a in range(size.na):
        decay[a] = 0.0
        if a >= size.n:
            decay[a] = exp(-noise.rate[a - size.n] * data.width[k])
        for b in range(size.na):
            W[a, b] = decay[a] * P[a, b]
    for a in range(size.n):
        for j in range(size.n):
            for b in range(size.na):
                W[a, b] += path.F[k, a, j] * P[j, b]
    for a in range(size.na):
        for b in range(size.na):
            total = W[a, b] * decay[b]
            if b < size.n:
                total = 0.0
                for j in range(size.n):
                    total += W[a, j] * path.F[k, b, j]
            P[a, b] = total
    for a in range(size.n):
        P[a, a] += noise.q[a] * data.width[k]
    if data.extra_at[k] >= 0.0:
        for a in range(size.n):
            for b in range(size.n):
                P[a, b] += data.extra[int(data.extra_at[k]), a, b]
    for a in range(size.na - size.n):
        P[size.n + a, size.n + a] += noise.s2[a] * (1.0 - decay[size.n + a] * decay[size.n + a])


@loops(z="na", P="na na")
def filter_rows(
    rates: Callable,
    readings: Callable,
    size: Sizes,
    rows: int,
    extras: int,
    linearise: int,
    used: int,
    plant: Equations,
    noise: Noise,
    data: Rows,
    faults: Faults,
    path: Path,
    z: np.ndarray,
    P: np.ndarray,
) -> float:
    """Filter the rows and return −2 log L; z and P are the prediction for the first row, then that for the next one."""
    loss = 0.0
    for k in range(rows):
        if linearise == 1:
            for j in range(size.n):
                path.prior[k, j] = z[j]
            read(readings, size, plant, data.t[k], z, data.u[k], faults.row[k], path.h[k], path.H[k], path.J[k])
        loss += correct(size, noise, data, path, k, z, P)
        for a in range(size.na):
            path.z[k, a] = z[a]
            path.spread[k, a] = P[a, a]
        if linearise == 1:
            for j in range(size.n):
                path.x[k, j] = z[j]
            flow(
                rates,
                size,
                plant,
                used,
                data.t[k],
                data.width[k],
                data.steps[k],
                z,
                data.between[k],
                faults.interval[k],
                path.phi[k],
                path.F[k],
                path.G[k],
            )
        for i in range(size.n):
            z[i] = path.phi[k, i]
            for j in range(size.n):
                z[i] += path.F[k, i, j] * (path.z[k, j] - path.x[k, j])
        for a in range(size.na - size.n):
            z[size.n + a] = exp(-noise.rate[a] * data.width[k]) * z[size.n + a]
        spread_ahead(size, noise, data, path, k, P)
    return loss


@loops(x="rows n", end="rows n")
def flow_rows(
    rates: Callable,
    size: Sizes,
    rows: int,
    extras: int,
    plant: Equations,
    data: Rows,
    faults: Faults,
    x: np.ndarray,
    end: np.ndarray,
):
    """Compute the state at the end of every interval from given states at its beginning."""
    F = empty(size.n, size.n)
    G = empty(size.n, size.d)
    for k in range(rows):
        flow(
            rates,
            size,
            plant,
            0,
            data.t[k],
            data.width[k],
            data.steps[k],
            x[k],
            data.between[k],
            faults.interval[k],
            end[k],
            F,
            G,
        )


@loops(x="rows n", y="rows m", start="n")
def simulate_rows(
    rates: Callable,
    readings: Callable,
    size: Sizes,
    rows: int,
    extras: int,
    plant: Equations,
    data: Rows,
    faults: Faults,
    start: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
):
    """Compute states and outputs of the plant along the recorded inputs, from `start` on, without corrections."""
    F = empty(size.n, size.n)
    G = empty(size.n, size.d)
    H = empty(size.m, size.n)
    J = empty(size.m, size.d)
    at = empty(size.n)
    for i in range(size.n):
        at[i] = start[i]
    for k in range(rows):
        for i in range(size.n):
            x[k, i] = at[i]
        read(readings, size, plant, data.t[k], x[k], data.u[k], faults.row[k], y[k], H, J)
        flow(
            rates,
            size,
            plant,
            0,
            data.t[k],
            data.width[k],
            data.steps[k],
            x[k],
            data.between[k],
            faults.interval[k],
            at,
            F,
            G,
        )
