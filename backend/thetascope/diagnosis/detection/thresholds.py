"""Thresholds from simulation: the plant, its input and its noise without any fault, many times over.

For every length of window the variance of what is tested is taken from the simulated runs, so that noise need not be
white, and from where in them it is largest, so that it need not be the same everywhere; then the tests themselves are
run over them, and the threshold is the level that they cross as often as is asked for. Rare crossings are beyond what can be simulated in a moment: above a high level the largest values of separate
stretches fall off exponentially (Pickands' theorem with shape 0, as for all quadratic forms of Gaussian noise), and the
level for one crossing in many hours follows (peaks over threshold; Coles, An Introduction to Statistical Modeling of
Extreme Values, 2001, ch. 4).
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincinv

from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowNoise, WindowSums, lengths, scan

FLOOR = 0.01  # of v: noise is not believed to be smaller than a tenth of what was declared
PARTS = (0.9, 0.1)  # of the false alarms that are put up with: for the GLR, for the residual
_STRETCH = 8  # decisions whose largest value counts once
_HIGH = (0.9, 0.97, 0.99)  # shares of stretches below the levels from which tails are taken: the heaviest tail counts
_FEWEST = 10  # stretches that a tail is taken from
_SEGMENTS = 40  # of a run, for each of which the noise of windows is looked at


@dataclass(frozen=True)
class Thresholds:
    """What decisions need to know: the noise of windows, the thresholds, and when to begin.

    ``begin``: decision from which on is judged; ``settle``: decisions that a fault's effect takes to take its form.
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
    """From runs without faults: sums of each over decisions of ``interval`` seconds. ``rate``: false alarms per hour. ``ready``: the
    decision from which on the filter is as sure of its state as later."""
    count = runs[0].last
    begin = _start_of_tests(runs, count)
    # half the room is left to count crossings of the longest window
    noise = _noise(runs, begin, max(ready, begin + 1), lengths(max(1, (count - begin) // 2)))
    ends = np.arange(begin + 1, count + 1)
    found = [scan(r, ends, begin, np.inf, noise, bounds) for r in runs]
    hours = len(runs) * len(ends) * interval / 3600
    levels = [level(np.array([f[k] for f in found]), hours, part * rate) for k, part in enumerate(PARTS)]
    return Thresholds(noise, bounds, *levels, begin, settle, len(runs), hours, rate)


def _start_of_tests(runs: list[WindowSums], count: int) -> int:
    """The decision from which on a run looks as runs do later: what the first guess of the state does is over."""
    increments = np.array([np.diff(r.q.sum(axis=1)) for r in runs])
    late = np.quantile(increments[:, count // 2 :], 0.99)
    loud = np.concatenate([[0], np.cumsum(np.median(increments, axis=0) > 1.5 * late + 1e-12)])
    calm = max(4, count // 50)  # decisions that must pass without a loud one
    quiet = np.flatnonzero(loud[calm:] == loud[:-calm])
    return min(count // 2, calm + (int(quiet[0]) if len(quiet) else count))


def _noise(runs: list[WindowSums], begin: int, ready: int, sizes: np.ndarray) -> WindowNoise:
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
    """s_j²/J_jj, whose mean is v."""
    return np.where(D > 0, s**2 / np.where(D > 0, D, 1.0), 0.0)


def _largest_mean(explained: np.ndarray) -> np.ndarray:
    """The largest mean over runs in any part of them, of numbers that are χ² but for a factor (runs × windows × p), less what chance
    makes of the largest of so many means."""
    runs, windows, _ = explained.shape
    parts = np.array_split(np.arange(windows), min(_SEGMENTS, windows))
    largest = np.max([explained[:, part].mean(axis=(0, 1)) for part in parts], axis=0)
    free = max(runs, runs * (windows // len(parts)) / 2)  # windows overlap by half
    chance = gammaincinv(free / 2, 1 - 0.5 / len(parts)) * 2 / free  # the median of the largest
    return np.maximum(explained.mean(axis=(0, 1)), largest / chance)


def level(values: np.ndarray, hours: float, rate: float) -> float:
    """The level that values (runs × decisions) cross ``rate`` times an hour."""
    runs, count = values.shape
    stretch = min(_STRETCH, count)
    peaks = values[:, : count // stretch * stretch].reshape(runs, -1, stretch).max(axis=2).ravel()
    levels = []
    for high in np.quantile(peaks, _HIGH):
        above = peaks[peaks > high] - high
        if not levels or len(above) >= max(_FEWEST, rate * hours):
            mean = max(float(above.mean()), 1e-9) if len(above) else 0.0
            levels.append(high + mean * max(0.0, np.log(max(len(above), 1) / hours / rate)))
    return float(max(levels))
