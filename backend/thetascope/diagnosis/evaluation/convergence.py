"""Whether an observer still converges: its estimates move, or its residual is larger, than noise explains.

The truth is not asked.
"""

import numpy as np

SHARE = 1 / 3
"""The part of the time since the last change, at its end, over which an estimate is looked at."""
MOVED = 4.0
"""Standard deviations of an estimate by which it moves over that time while it converges."""
EXCESS = 2.0
"""Times the noise of a measurement that the residual exceeds while an observer converges."""
FEWEST = 8  # rows


def converges(t: np.ndarray, estimate: np.ndarray, sigma: np.ndarray) -> bool | None:
    """Return whether an estimate still moves along the rows; None without enough values.

    A straight line is fitted, so noise matters little; an exponential approach counts until its remaining bias is
    about as small as the noise.

    t, estimate, sigma: shape (rows,), from `looked_at` to now. sigma: standard deviation by noise alone.
    """
    rows = np.isfinite(estimate) & np.isfinite(sigma)
    if rows.sum() < FEWEST:
        return None
    x, values = t[rows] - t[rows].mean(), estimate[rows]
    spread = float(x @ x)
    slope = float(x @ (values - values.mean())) / spread if spread > 0 else 0.0
    return bool(abs(slope) * float(np.ptp(x)) > MOVED * float(np.median(sigma[rows])))


def misses(residual: np.ndarray, noise: float) -> bool | None:
    """Return whether an observer's ŷ is further from y than the noise explains; None without noise or enough values.

    residual: y − ŷ, shape (rows,), from `looked_at` to now. noise: standard deviation of the measurement.
    """
    known = residual[np.isfinite(residual)]
    if known.size < FEWEST or noise <= 0:
        return None
    return bool(np.sqrt(np.mean(known**2)) > EXCESS * noise)


def looked_at(changed: float, now: float) -> float:
    """Return the time in s from which on an estimate is looked at, given the time of the last change.

    The span grows with the time that has passed, so no time constant of the observer needs to be known.
    """
    return now - SHARE * max(0.0, now - changed)
