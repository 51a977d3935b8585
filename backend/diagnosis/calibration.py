"""Thresholds from simulation: the plant, its input and its noise without any fault, many times over.

For every length of window the variance of what is tested is taken from the simulated runs, so that noise need not be
white; then the tests themselves are run over them, and the threshold is the level that they cross as often as is asked
for. Rare crossings are beyond what can be simulated in a moment: above a high level the largest values of separate
stretches fall off exponentially (Pickands' theorem with shape 0, as for all quadratic forms of Gaussian noise), and the
level for one crossing in many hours follows (peaks over threshold; Coles, An Introduction to Statistical Modeling of
Extreme Values, 2001, ch. 4).
"""

from dataclasses import dataclass

import numpy as np

from backend.diagnosis.windows import Noise, Range, Sums, lengths, scan

FLOOR = 0.01  # of v: noise is not believed to be smaller than a tenth of what was declared
PARTS = (0.9, 0.1)  # of the false alarms that are put up with: for the GLR, for the residual
_STRETCH = 8  # decisions whose largest value counts once
_HIGH = 0.9  # share of stretches below the level from which the tail is taken


@dataclass(frozen=True)
class Calibrated:
    """What decisions need to know: the noise of windows, the thresholds, and when to begin.

    ``begin``: decision from which on is judged; ``settle``: decisions that a fault's effect takes to take its form.
    """

    noise: Noise
    within: Range
    glr: float
    residual: float
    begin: int
    settle: int
    seeds: int
    hours: float
    rate: float


def calibrate(runs: list[Sums], interval: float, rate: float, settle: int, within: Range) -> Calibrated:
    """From runs without faults: sums of each over decisions of ``interval`` seconds. ``rate``: false alarms per hour."""
    count = runs[0].last
    begin = _settled(runs, count)
    # half the room is left to count crossings of the longest window
    noise = _noise(runs, begin, lengths(max(1, (count - begin) // 2)))
    ends = np.arange(begin + 1, count + 1)
    found = [scan(r, ends, begin, np.inf, noise, within) for r in runs]
    hours = len(runs) * len(ends) * interval / 3600
    levels = [level(np.array([f[k] for f in found]), hours, part * rate) for k, part in enumerate(PARTS)]
    return Calibrated(noise, within, *levels, begin, settle, len(runs), hours, rate)


def _settled(runs: list[Sums], count: int) -> int:
    """The decision from which on a run looks as runs do later: what the first guess of the state does is over."""
    increments = np.array([np.diff(r.q.sum(axis=1)) for r in runs])
    late = np.quantile(increments[:, count // 2 :], 0.99)
    loud = np.concatenate([[0], np.cumsum(np.median(increments, axis=0) > 1.5 * late + 1e-12)])
    calm = max(4, count // 50)  # decisions that must pass without a loud one
    quiet = np.flatnonzero(loud[calm:] == loud[:-calm])
    return min(count // 2, calm + (int(quiet[0]) if len(quiet) else count))


def _noise(runs: list[Sums], begin: int, sizes: np.ndarray) -> Noise:
    v, energy, scatter = [], [], []
    count = runs[0].last
    for length in sizes:
        ends = np.arange(begin + length, count + 1, max(1, length // 2))
        parts = [r.over(ends - length, ends) for r in runs]
        v.append(np.maximum(np.concatenate([_energies(J, s) for J, s, _ in parts]).mean(axis=0), FLOOR))
        q = np.concatenate([q for _, _, q in parts])
        energy.append(q.mean())
        scatter.append(max(q.std(), 1e-9 * abs(q.mean()), 1e-12))
    return Noise(sizes, np.array(v), np.array(energy), np.array(scatter))


def _energies(J: np.ndarray, s: np.ndarray) -> np.ndarray:
    """s_j²/J_jj, whose mean is v."""
    D = np.einsum("...ii->...i", J)
    return np.where(D > 0, s**2 / np.where(D > 0, D, 1.0), 0.0)


def level(values: np.ndarray, hours: float, rate: float) -> float:
    """The level that values (runs × decisions) cross ``rate`` times an hour."""
    runs, count = values.shape
    stretch = min(_STRETCH, count)
    peaks = values[:, : count // stretch * stretch].reshape(runs, -1, stretch).max(axis=2).ravel()
    high = np.quantile(peaks, _HIGH)
    above = peaks[peaks > high] - high
    if not len(above):
        return float(high)
    mean = max(float(above.mean()), 1e-9)
    return float(high + mean * max(0.0, np.log(len(above) / hours / rate)))
