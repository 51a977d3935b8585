"""Thresholds from simulations of the plant, its input and its noise without any fault.

For every length of window the variance of the tested quantity is taken from the simulated runs, so that noise need not
be white, and from where in them it is largest, so that it need not be stationary. Then the tests are run over the
simulations, and the threshold is the level that they cross at the accepted rate. Crossings at that rate are too rare to
be simulated: above a high level the maxima of separate blocks have an exponential tail (Pickands' theorem with shape 0,
as for all quadratic forms of Gaussian noise), which gives the level of one crossing in many hours (peaks over
threshold; Coles, An Introduction to Statistical Modeling of Extreme Values, 2001, ch. 4).
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincinv

from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowNoise, WindowSums, lengths, scan

FLOOR = 0.01  # of v: noise is at least a tenth of the declared standard deviation
PARTS = (0.9, 0.1)  # shares of the accepted false alarms: GLR, residual
_BLOCK = 8  # decisions whose maximum counts once
_HIGH = (0.9, 0.97, 0.99)  # quantiles above which tails are fitted: the heaviest tail counts
_FEWEST = 10  # exceedances that a tail is fitted to
_PARTS_OF_RUN = 40  # for each of which the noise of windows is averaged


@dataclass(frozen=True)
class Thresholds:
    """Thresholds and the statistics of noise.

    Attributes:
        noise: the statistics of windows.
        bounds: bounds of θ.
        glr, residual: thresholds of the two tests.
        begin: decision from which on tests run.
        settle: decisions that the response to a fault takes to settle.
        seeds, hours: number and total time of the simulated runs.
        rate: accepted false alarms per hour.
    """

    noise: WindowNoise
    bounds: ThetaBounds
    glr: float
    residual: float
    begin: int
    settle: int
    seeds: int
    hours: float
    rate: float


def calibrate(
    runs: list[WindowSums], interval: float, rate: float, settle: int, bounds: ThetaBounds, ready: int = 0
) -> Thresholds:
    """Return thresholds from runs without faults.

    Args:
        runs: the sums of each run.
        interval: time between decisions, s.
        rate: accepted false alarms per hour.
        settle: decisions that the response to a fault takes to settle.
        bounds: bounds of θ.
        ready: decision at which the filter's covariance has settled.
    """
    count = runs[0].last
    begin = _start_of_tests(runs, count)
    # at most half of a run, so that crossings of the longest window can be counted
    noise = _noise(runs, begin, max(ready, begin + 1), lengths(max(1, (count - begin) // 2)))
    ends = np.arange(begin + 1, count + 1)
    tests = [scan(r, ends, begin, np.inf, noise, bounds) for r in runs]
    hours = len(runs) * len(ends) * interval / 3600
    glr, residual = (level(np.array([test[k] for test in tests]), hours, part * rate) for k, part in enumerate(PARTS))
    return Thresholds(noise, bounds, glr, residual, begin, settle, len(runs), hours, rate)


def _start_of_tests(runs: list[WindowSums], count: int) -> int:
    """Return the decision from which on the energy is that of the second half: the initial transient is over."""
    increments = np.array([np.diff(r.q.sum(axis=1)) for r in runs])
    late = np.quantile(increments[:, count // 2 :], 0.99)
    loud = np.concatenate([[0], np.cumsum(np.median(increments, axis=0) > 1.5 * late + 1e-12)])
    least = max(4, count // 50)  # decisions in a row without a loud one
    quiet = np.flatnonzero(loud[least:] == loud[:-least])
    return min(count // 2, least + (int(quiet[0]) if len(quiet) else count))


def _noise(runs: list[WindowSums], begin: int, ready: int, sizes: np.ndarray) -> WindowNoise:
    """Return the statistics of windows of all lengths `sizes` in runs without faults."""
    v, loud, first, energy, scatter = [], [], [], [], []
    count = runs[0].last
    D, s, e = (np.array(each) for each in zip(*((np.einsum("dii->di", r.J), r.s, r.e) for r in runs), strict=True))
    for length in sizes:
        ends = np.arange(begin + length, count + 1, max(1, length // 2)) - runs[0].first
        explained = _energies(D[:, ends] - D[:, ends - length], s[:, ends] - s[:, ends - length])
        q = e[:, ends] - e[:, ends - length]
        energy.append(q.mean())
        scatter.append(max(q.std(), 1e-9 * abs(q.mean()), 1e-12))
        v.append(np.maximum(explained.mean(axis=(0, 1)), FLOOR))
        loud.append(np.maximum(_largest_mean(explained), FLOOR))
        ends = np.arange(begin + length, min(ready + length, count + 1), max(1, length // 8)) - runs[0].first
        early = _energies(D[:, ends] - D[:, ends - length], s[:, ends] - s[:, ends - length])
        first.append(np.maximum(_largest_mean(early), loud[-1]))
    return WindowNoise(sizes, np.array(v), np.array(loud), np.array(first), ready, np.array(energy), np.array(scatter))


def _energies(D: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return s_j²/J_jj, whose mean is v_j."""
    return np.where(D > 0, s**2 / np.where(D > 0, D, 1.0), 0.0)


def _largest_mean(explained: np.ndarray) -> np.ndarray:
    """Return the largest mean over runs in any part of them (p,), corrected for the largest of several means of noise.

    `explained`: (runs, windows, p), each χ² distributed up to a factor.
    """
    runs, windows, _ = explained.shape
    parts = np.array_split(np.arange(windows), min(_PARTS_OF_RUN, windows))
    largest = np.max([explained[:, part].mean(axis=(0, 1)) for part in parts], axis=0)
    free = max(runs, runs * (windows // len(parts)) / 2)  # windows overlap by half
    chance = gammaincinv(free / 2, 1 - 0.5 / len(parts)) * 2 / free  # the median of the largest
    return np.maximum(explained.mean(axis=(0, 1)), largest / chance)


def level(values: np.ndarray, hours: float, rate: float) -> float:
    """Return the level that values (runs, decisions) cross `rate` times per hour; `hours`: the time that they cover."""
    runs, count = values.shape
    block = min(_BLOCK, count)
    peaks = values[:, : count // block * block].reshape(runs, -1, block).max(axis=2).ravel()
    levels = []
    for high in np.quantile(peaks, _HIGH):
        above = peaks[peaks > high] - high
        if not levels or len(above) >= max(_FEWEST, rate * hours):
            mean = max(float(above.mean()), 1e-9) if len(above) else 0.0
            levels.append(high + mean * max(0.0, np.log(max(len(above), 1) / hours / rate)))
    return float(max(levels))
