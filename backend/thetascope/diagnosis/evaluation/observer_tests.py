"""Tests on an observer's own estimates: what it would find by itself, for the comparison of observers.

Each estimate is divided by its standard deviation (engine/estimation/covariance.py), so that it has variance one without a fault,

    z = θ̂_c / σ_c,

and one of three tests looks at it, decision by decision. Its threshold comes from runs of the same plant, observer and noise
without faults, as in thresholds.py, but with an allowance for their small number. An alarm is raised when the statistic
passes the threshold and is over when it is below half of that, or z within its noise, for a while.

- ``threshold``: |z|.
- ``cusum``: the larger of two sums max(0, g ± z − DRIFT) (Page, Biometrika 41, 1954); the onset is where it was last zero.
- ``glr``: the largest squared mean of z over windows, divided by the variance that it has without a fault.

Unlike the detector (decision_step.py) these tests know nothing of what one fault does to the estimate of another while the
observer settles: where they name the wrong channel, that is the observer's isolation error.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import gammaincinv, ndtri

from thetascope.diagnosis.detection.window_tests import lengths

DRIFT = 0.5  # of σ: changes of the mean smaller than twice this are not looked for
_FLOOR = 1e-3  # of v
_FORGOTTEN = 0.2  # correlation
_EXCURSIONS = 12  # that the tail is taken from, at least, where there are as many
_UNSURE = 0.05
_PARTS = 4
_BACK = 3.0  # standard deviations within which an estimate is back


@dataclass(frozen=True)
class CalibratedTest:
    """A test and its threshold; ``begin``: the decision from which on it judges; ``v``: variance of means (lengths)."""

    test: str
    threshold: float
    begin: int
    lengths: np.ndarray
    v: np.ndarray
    runs: int = 0  # that it was calibrated with, and their hours
    hours: float = 0.0

    def to_json(self) -> dict:
        return vars(self) | {"lengths": self.lengths.tolist(), "v": self.v.tolist()}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> "CalibratedTest":
        fields: dict[str, Any] = data | {"lengths": np.array(data["lengths"]), "v": np.array(data["v"])}
        return cls(**fields)


@dataclass(frozen=True)
class EstimateAlarm:
    """An alarm of one channel; times are decisions."""

    channel: int
    at: int
    onset: int
    statistic: float
    cleared: int | None


def prepare(z: np.ndarray, test: str, interval: float, rate: float, begin: int) -> CalibratedTest:
    """From runs without faults: z (runs × decisions × channels). ``rate``: false alarms per hour of the whole observer."""
    count = z.shape[1]
    sizes = lengths(max(1, (count - begin) // 2))
    v = np.array([max(_variance(_means(z[:, begin:], int(n))), _FLOOR) for n in sizes])
    bare = CalibratedTest(test, np.inf, begin, sizes, v)
    stretch = max(1, memory(z[:, begin:]))
    louder = _louder(len(z) * max(1.0, (count - begin) / _PARTS / stretch))
    found = np.stack([statistic(run * louder, bare)[0].max(axis=1, initial=0.0) for run in z])[:, begin:]
    hours = found.size * interval / 3600
    threshold = _level(found, stretch, hours, rate)
    least = -float(
        ndtri(min(0.5, rate * stretch * interval / 3600 / (2 * z.shape[2])))
    )  # of a Gaussian z of variance one
    if test == "threshold":
        threshold = max(threshold, least * louder * _variance(z[:, begin:]) ** 0.5)
    elif test == "glr":
        threshold = max(threshold, (least * louder) ** 2)
    return CalibratedTest(test, threshold, begin, sizes, v, len(z), hours)


def _variance(means: np.ndarray) -> float:
    """Mean square of runs × times × channels, in the part of the time in which it is largest: estimates go on settling."""
    parts = np.array_split(np.nan_to_num(means), min(_PARTS, means.shape[1]), axis=1)
    return max(float(np.mean(p**2)) for p in parts)


def _louder(numbers: float) -> float:
    """By how much the standard deviation of so many independent numbers may be too small (95 %)."""
    return float((numbers / 2 / gammaincinv(numbers / 2, _UNSURE)) ** 0.5)


def memory(z: np.ndarray) -> int:
    """Decisions after which an estimate has forgotten what it was: where its autocorrelation falls below a fifth."""
    z = np.nan_to_num(z - np.nanmean(z, axis=1, keepdims=True))
    count = z.shape[1]
    spectrum = np.abs(np.fft.rfft(z, 2 * count, axis=1)) ** 2
    correlation = np.fft.irfft(spectrum, axis=1)[:, :count].mean(axis=0)
    correlation = (correlation / np.maximum(correlation[:1], 1e-300)).max(axis=1)
    return int(np.argmax(correlation < _FORGOTTEN)) if (correlation < _FORGOTTEN).any() else count


def _level(found: np.ndarray, stretch: int, hours: float, rate: float) -> float:
    """The level that a statistic (runs × decisions) passes ``rate`` times an hour: as calibration.level, but estimates are
    slow, so that few of their excursions are seen. Each counts once, and the mean by which they go beyond a high level is
    taken as large as it may be (95 %, from the χ² distribution of a sum of exponential numbers)."""
    runs, count = found.shape
    stretch = min(max(stretch, 1), count)
    peaks = found[:, : count // stretch * stretch].reshape(runs, -1, stretch).max(axis=2).ravel()
    high = float(np.quantile(peaks, 1.0 - min(0.5, max(0.1, _EXCURSIONS / len(peaks)))))
    above = peaks[peaks > high] - high
    if not len(above):
        return high
    mean = float(above.sum() / gammaincinv(len(above), _UNSURE))
    return high + mean * max(0.0, float(np.log(len(above) / hours / rate)))


def statistic(z: np.ndarray, calibrated: CalibratedTest) -> tuple[np.ndarray, np.ndarray]:
    """The statistic (decisions × channels) and the onset that goes with it (decisions × channels); zero before begin."""
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
    """Means of n decisions, half overlapping: runs × means × channels."""
    ends = np.arange(n, z.shape[1] + 1, max(1, n // 2))
    total = np.concatenate([np.zeros((len(z), 1, z.shape[2])), np.cumsum(np.nan_to_num(z), axis=1)], axis=1)
    return (total[:, ends] - total[:, ends - n]) / n


def alarms(z: np.ndarray, calibrated: CalibratedTest) -> list[EstimateAlarm]:
    """All alarms along a run: z (decisions × channels)."""
    g, onset = statistic(z, calibrated)
    found = []
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
            found.append(EstimateAlarm(channel, at, int(onset[at, channel]), float(g[at, channel]), cleared))
            if cleared is None:
                break
            still = np.flatnonzero(g[cleared:, channel] < calibrated.threshold)  # a sum takes its time to come down
            k = cleared + (int(still[0]) if len(still) else len(z))
    return sorted(found, key=lambda a: (a.at, a.channel))


def _lasting(true: np.ndarray, length: int) -> int | None:
    """The first position at which ``length`` in a row have been true."""
    run = np.cumsum(true) - np.maximum.accumulate(np.where(true, 0, np.cumsum(true)))
    done = np.flatnonzero(run >= length)
    return int(done[0]) if len(done) else None
