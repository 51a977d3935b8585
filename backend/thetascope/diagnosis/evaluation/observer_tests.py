"""Tests on an observer's own estimates, for the comparison of observers.

Each estimate is divided by its standard deviation (engine/estimation/covariance.py), so that it has variance one
without a fault,

    z = θ̂_c / σ_c,

and one of three tests is applied to it at every decision. Its threshold comes from runs of the same plant, observer and
noise without faults, as in thresholds.py, but with an allowance for their small number. An alarm is raised when the
statistic exceeds the threshold, and is over when the statistic has been below half of it, or z within its noise, for a
while.

- ``threshold``: |z|.
- ``cusum``: the larger of two sums max(0, g ± z − DRIFT) (Page, Biometrika 41, 1954); the onset is where it was last
  zero.
- ``glr``: the largest squared mean of z over windows, divided by the variance that it has without a fault.

Unlike the detector (decision_step.py) these tests do not know how one fault disturbs the estimate of another while the
observer settles: where they name the wrong channel, that is the observer's isolation error.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import gammaincinv, ndtri

from thetascope.diagnosis.detection.window_tests import lengths

DRIFT = 0.5  # of σ: half of the smallest change of the mean that the cusum detects
_FLOOR = 1e-3  # of v
_FORGOTTEN = 0.2  # correlation
_EXCURSIONS = 12  # that the tail is fitted to at least, where there are as many
_UNSURE = 0.05  # probability that the allowance for few runs is too small
_PARTS = 4  # of a run, for each of which a variance is taken
_BACK = 3.0  # standard deviations within which an estimate is back at zero


@dataclass(frozen=True)
class CalibratedTest:
    """A test with its threshold.

    Attributes:
        test: threshold, cusum or glr.
        threshold: of its statistic.
        begin: decision from which on it is applied.
        lengths: (lengths,), of its windows, in decisions.
        v: (lengths,), variance of means of z over them without a fault.
        runs, hours: number and total time of the runs it was calibrated with.
    """

    test: str
    threshold: float
    begin: int
    lengths: np.ndarray
    v: np.ndarray
    runs: int = 0
    hours: float = 0.0

    def to_json(self) -> dict:
        """Return the test as JSON data."""
        return vars(self) | {"lengths": self.lengths.tolist(), "v": self.v.tolist()}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> "CalibratedTest":
        """Return the test of JSON data."""
        fields: dict[str, Any] = data | {"lengths": np.array(data["lengths"]), "v": np.array(data["v"])}
        return cls(**fields)


@dataclass(frozen=True)
class EstimateAlarm:
    """An alarm of one channel; `at`, `onset` and `cleared` are decisions."""

    channel: int
    at: int
    onset: int
    statistic: float
    cleared: int | None


def prepare(z: np.ndarray, test: str, interval: float, rate: float, begin: int) -> CalibratedTest:
    """Return a test with its threshold.

    Args:
        z: (runs, decisions, channels), normalised estimates of runs without faults.
        test: threshold, cusum or glr.
        interval: time between decisions, s.
        rate: accepted false alarms per hour of the whole observer.
        begin: decision from which on it is applied.
    """
    count = z.shape[1]
    sizes = lengths(max(1, (count - begin) // 2))
    v = np.array([max(_variance(_means(z[:, begin:], int(n))), _FLOOR) for n in sizes])
    bare = CalibratedTest(test, np.inf, begin, sizes, v)
    stretch = max(1, memory(z[:, begin:]))
    louder = _louder(len(z) * max(1.0, (count - begin) / _PARTS / stretch))
    statistics = np.stack([statistic(run * louder, bare)[0].max(axis=1, initial=0.0) for run in z])[:, begin:]
    hours = statistics.size * interval / 3600
    threshold = _level(statistics, stretch, hours, rate)
    least = -float(
        ndtri(min(0.5, rate * stretch * interval / 3600 / (2 * z.shape[2])))
    )  # of a Gaussian z of variance one
    if test == "threshold":
        threshold = max(threshold, least * louder * _variance(z[:, begin:]) ** 0.5)
    elif test == "glr":
        threshold = max(threshold, (least * louder) ** 2)
    return CalibratedTest(test, threshold, begin, sizes, v, len(z), hours)


def _variance(means: np.ndarray) -> float:
    """Return the mean square (runs, times, channels) in the part of the time in which it is largest: estimates are
    still settling."""
    parts = np.array_split(np.nan_to_num(means), min(_PARTS, means.shape[1]), axis=1)
    return max(float(np.mean(p**2)) for p in parts)


def _louder(numbers: float) -> float:
    """Return the factor by which the standard deviation of independent numbers may be underestimated (95 %); `numbers`:
    their count."""
    return float((numbers / 2 / gammaincinv(numbers / 2, _UNSURE)) ** 0.5)


def memory(z: np.ndarray) -> int:
    """Return the decisions after which the autocorrelation of z (runs, decisions, channels) falls below a fifth."""
    z = np.nan_to_num(z - np.nanmean(z, axis=1, keepdims=True))
    count = z.shape[1]
    spectrum = np.abs(np.fft.rfft(z, 2 * count, axis=1)) ** 2
    correlation = np.fft.irfft(spectrum, axis=1)[:, :count].mean(axis=0)
    correlation = (correlation / np.maximum(correlation[:1], 1e-300)).max(axis=1)
    return int(np.argmax(correlation < _FORGOTTEN)) if (correlation < _FORGOTTEN).any() else count


def _level(values: np.ndarray, stretch: int, hours: float, rate: float) -> float:
    """Return the level that a statistic (runs, decisions) exceeds `rate` times per hour.

    As `thresholds.level`, but estimates are slow, so that few excursions are seen. Each counts once, and their mean
    excess over a high level is taken at its upper 95 % bound (a sum of exponential numbers is χ² distributed).
    """
    runs, count = values.shape
    stretch = min(max(stretch, 1), count)
    peaks = values[:, : count // stretch * stretch].reshape(runs, -1, stretch).max(axis=2).ravel()
    high = float(np.quantile(peaks, 1.0 - min(0.5, max(0.1, _EXCURSIONS / len(peaks)))))
    above = peaks[peaks > high] - high
    if not len(above):
        return high
    mean = float(above.sum() / gammaincinv(len(above), _UNSURE))
    return high + mean * max(0.0, float(np.log(len(above) / hours / rate)))


def statistic(z: np.ndarray, calibrated: CalibratedTest) -> tuple[np.ndarray, np.ndarray]:
    """Return the statistic and the onset that belongs to it, (decisions, channels) each; the statistic is zero before
    `begin`."""
    z = np.nan_to_num(z, nan=0.0, posinf=0.0, neginf=0.0)
    g, onset = {"threshold": _threshold, "cusum": _cusum, "glr": _glr}[calibrated.test](z, calibrated)
    g[: calibrated.begin] = 0.0
    return g, onset


def _threshold(z: np.ndarray, calibrated: CalibratedTest) -> tuple[np.ndarray, np.ndarray]:
    return np.abs(z), np.broadcast_to(np.arange(len(z))[:, None], z.shape).copy()


def _cusum(z: np.ndarray, calibrated: CalibratedTest) -> tuple[np.ndarray, np.ndarray]:
    g, onset = np.zeros_like(z), np.zeros(z.shape, dtype=int)
    sums, since = np.zeros((2, z.shape[1])), np.full((2, z.shape[1]), calibrated.begin)
    columns = np.arange(z.shape[1])
    for k in range(calibrated.begin, len(z)):
        sums = np.maximum(sums + np.stack([z[k], -z[k]]) - DRIFT, 0.0)
        since = np.where(sums == 0.0, k + 1, since)
        side = sums.argmax(axis=0)
        g[k], onset[k] = sums[side, columns], since[side, columns]
    return g, onset


def _glr(z: np.ndarray, calibrated: CalibratedTest) -> tuple[np.ndarray, np.ndarray]:
    g, onset = np.zeros_like(z), np.zeros(z.shape, dtype=int)
    total = np.concatenate([np.zeros((1, z.shape[1])), np.cumsum(z, axis=0)])
    for n, v in zip(calibrated.lengths, calibrated.v, strict=True):
        ends = np.arange(calibrated.begin + n, len(z) + 1)
        if not len(ends):
            break
        value = ((total[ends] - total[ends - n]) / n) ** 2 / v
        better = value > g[ends - 1]
        g[ends - 1] = np.where(better, value, g[ends - 1])
        onset[ends - 1] = np.where(better, (ends - n)[:, None], onset[ends - 1])
    return g, onset


def _means(z: np.ndarray, n: int) -> np.ndarray:
    """Return means of z over `n` decisions, half overlapping: (runs, means, channels)."""
    ends = np.arange(n, z.shape[1] + 1, max(1, n // 2))
    total = np.concatenate([np.zeros((len(z), 1, z.shape[2])), np.cumsum(np.nan_to_num(z), axis=1)], axis=1)
    return (total[:, ends] - total[:, ends - n]) / n


def alarms(z: np.ndarray, calibrated: CalibratedTest) -> list[EstimateAlarm]:
    """Return all alarms of a run, in order of time; z: (decisions, channels)."""
    g, onset = statistic(z, calibrated)
    raised = []
    for channel in range(z.shape[1]):
        k = calibrated.begin
        while True:
            over = np.flatnonzero(g[k:, channel] > calibrated.threshold)
            if not len(over):
                break
            at = k + int(over[0])
            quiet = (g[at:, channel] < 0.5 * calibrated.threshold) | (np.abs(z[at:, channel]) < _BACK)
            end = _lasting(quiet, max(2, (at - int(onset[at, channel])) // 2))
            cleared = None if end is None else at + end
            raised.append(EstimateAlarm(channel, at, int(onset[at, channel]), float(g[at, channel]), cleared))
            if cleared is None:
                break
            below = np.flatnonzero(g[cleared:, channel] < calibrated.threshold)  # a cusum falls slowly
            k = cleared + (int(below[0]) if len(below) else len(z))
    return sorted(raised, key=lambda a: (a.at, a.channel))


def _lasting(true: np.ndarray, length: int) -> int | None:
    """Return the first position at which `length` values in succession have been true, or None."""
    run = np.cumsum(true) - np.maximum.accumulate(np.where(true, 0, np.cumsum(true)))
    done = np.flatnonzero(run >= length)
    return int(done[0]) if len(done) else None
