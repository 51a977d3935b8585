"""Process and measurement noise by maximum likelihood, on rows that are known to be healthy.

−2 log L is that of the filter (engine/filtering). It is minimised on a frozen linearisation, which makes an evaluation
about eight times cheaper, and the plant is linearised again along the result, at most `_ROUNDS` times. Logarithms of
the intensities are the free numbers, with a weak pull to their starting values, because noise that no output shows has
no likelihood of its own. The variance of a reading is at least that of rounding to its resolution, resolution²/12.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from thetascope.engine.filtering.bundles import Noise, Rows
from thetascope.engine.filtering.record_filter import FilterResult, RecordFilter

_ROUNDS = 3
_WIDE = 12.0  # standard deviation of the pull on logarithms
_GAIN = 4.0  # by which coloured noise must lower −2 log L for every output that has it
_MEDIAN = 0.455  # of the square of a standard normal number
_RAISED = 2.7  # above the minimum of −2 log L: the upper end of a 90 % interval of one number


@dataclass(frozen=True)
class Start:
    """The prediction for the first row: x and its covariance (n, n)."""

    x: np.ndarray
    P: np.ndarray

    def extended(self, noise: Noise, coloured: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return z and P with the coloured part of the readings, if there is one."""
        if not coloured:
            return self.x, self.P
        n, m = len(self.x), len(noise.r)
        P = np.zeros((n + m, n + m))
        P[:n, :n] = self.P
        P[np.arange(n, n + m), np.arange(n, n + m)] = noise.s2
        return np.concatenate([self.x, np.zeros(m)]), P


@dataclass(frozen=True)
class NoiseFit:
    """Fitted noise.

    Attributes:
        noise: the noise.
        coloured: whether it has a coloured part.
        loss: −2 log L of the rows.
        at: the free numbers.
        result: the filtered rows.
    """

    noise: Noise
    coloured: bool
    loss: float
    at: np.ndarray
    result: FilterResult


def run(filter_: RecordFilter, data: Rows, fit_noise: Noise, start: Start, coloured: bool, **options) -> FilterResult:
    """Filter rows from a start."""
    return filter_.filter(data, fit_noise, *start.extended(fit_noise, coloured), **options)


def scatter(y: np.ndarray) -> np.ndarray:
    """Return the variance of the noise of each column from differences of neighbouring readings."""
    variances = []
    for column in y.T:
        steps = np.diff(column[np.isfinite(column)]) ** 2
        if not len(steps):
            variances.append(1.0)
            continue
        median = float(np.median(steps)) / (2 * _MEDIAN) if len(steps) else 0.0
        variances.append(median or (float(np.mean(steps)) / 2 if len(steps) else 0.0))
    return np.array(variances)


@dataclass(frozen=True)
class _Scaling:
    """Starting values of all intensities, and how the free numbers change them."""

    q: np.ndarray
    r: np.ndarray
    floor: np.ndarray
    period: float
    shown: np.ndarray  # outputs with a coloured part

    def noise(self, v: np.ndarray) -> Noise:
        """Return the noise of the numbers: log q, log(r − floor), and for coloured outputs logit a and log s²."""
        n, m = len(self.q), len(self.r)
        q, r = self.q * np.exp(v[:n]), self.floor + self.r * np.exp(v[n : n + m])
        rate, s2 = np.ones(m) / self.period, np.zeros(m)
        count = int(self.shown.sum())
        if count:
            a = np.clip(1.0 / (1.0 + np.exp(-v[n + m : n + m + count])), 1e-4, 0.9999)
            rate[self.shown] = -np.log(a) / self.period
            s2[self.shown] = self.r[self.shown] * np.exp(v[n + m + count :])
        return Noise(q, r, rate, s2)


def fit(
    filter_: RecordFilter,
    data: Rows,
    start: Start,
    scales: np.ndarray,
    measured: np.ndarray,
    resolution: np.ndarray,
    white: bool = False,
    before: NoiseFit | None = None,
) -> NoiseFit:
    """Return the noise of healthy rows: white, or with a coloured part for outputs whose readings ask for it.

    Args:
        filter_, data, start: the filter, the rows, the prediction for the first of them.
        scales: (n,), sizes of the states.
        measured: (n,), the output that shows a state, −1 for none.
        resolution: (m,), steps between readings, 0 for none.
        white: do not try a coloured part.
        before: the noise of some of the rows, from which the fit starts; its coloured part is kept or left out.
    """
    period = float(np.median(data.width))
    differences = scatter(data.y)
    variance = np.array(
        [np.nanvar(np.diff(c[np.isfinite(c)])) / 2 if np.isfinite(c).sum() > 2 else 0 for c in data.y.T]
    )
    floor = np.maximum(resolution**2 / 12, 1e-6 * variance)
    floor = np.where(floor > 0, floor, 1e-12 * np.maximum(np.nanvar(data.y, axis=0), 1e-300))
    r = np.maximum(np.where(differences > floor, differences, variance), 1.5 * floor)
    q = (1e-4 * scales) ** 2 / period
    q = np.where(measured >= 0, 0.03 * r[np.maximum(measured, 0)] / period, q)
    scaling = _Scaling(q, r, floor, period, np.zeros(len(r), dtype=bool))
    shown = np.ones(len(r), dtype=bool)
    if before is not None:
        return _minimum(filter_, data, start, replace(scaling, shown=shown & before.coloured), before.at, rounds=1)
    plain = _minimum(filter_, data, start, scaling, np.zeros(len(q) + len(r)))
    if white:
        return plain
    v, count = plain.at, len(r)
    warm = np.concatenate([v, np.ones(count), v[len(q) :] - 0.7])
    warm[len(q) : len(q) + count] -= 0.7
    coloured = _minimum(filter_, data, start, replace(scaling, shown=shown), warm)
    return coloured if coloured.loss < plain.loss - _GAIN * count else plain


def _minimum(
    filter_: RecordFilter, data: Rows, start: Start, scaling: _Scaling, v: np.ndarray, rounds: int = _ROUNDS
) -> NoiseFit:
    """Return the most likely noise, from starting numbers."""
    n, m = len(scaling.q), len(scaling.r)
    coloured = bool(scaling.shown.any())
    bounds = [(-12.0, 14.0)] * n + [(-12.0, 12.0)] * m + [(-6.0, 6.0)] * (len(v) - n - m) * coloured
    if coloured:
        count = int(scaling.shown.sum())
        bounds = bounds[: n + m] + [(-6.0, 6.0)] * count + [(-14.0, 12.0)] * count
    v = np.clip(v, [b[0] for b in bounds], [b[1] for b in bounds])
    path = filter_.new_path(len(data.t), coloured)
    for round_ in range(rounds):
        run(filter_, data, scaling.noise(v), start, coloured, path=path, channels=())

        def objective(w: np.ndarray) -> float:
            loss = run(filter_, data, scaling.noise(w), start, coloured, path=path, frozen=True).loss
            return loss / 2 + 0.5 * float(np.sum((w / _WIDE) ** 2)) if np.isfinite(loss) else 1e12

        options = {"maxiter": 60 if round_ else 25, "maxfun": 20_000, "ftol": 1e-6, "eps": 1e-4}
        found = minimize(objective, v, method="L-BFGS-B", bounds=bounds, options=options)
        change, v = np.abs(found.x - v).max(), found.x
        if change < 0.05:
            break
    noise = scaling.noise(v)
    result = run(filter_, data, noise, start, coloured, path=path)
    return NoiseFit(noise, coloured, result.loss, v, result)


def with_upper_process_noise(filter_: RecordFilter, data: Rows, start: Start, best: NoiseFit) -> NoiseFit:
    """Return the noise with every process noise at the upper end of its profile likelihood.

    Process noise from a short stretch is estimated too low more often than not, and that makes false alarms.
    """
    path = best.result.path
    q = best.noise.q.copy()

    def loss(candidate: np.ndarray) -> float:
        noise = replace(best.noise, q=candidate)
        return run(filter_, data, noise, start, best.coloured, path=path, frozen=True).loss

    base = loss(q)
    for j in range(len(q)):
        low, high = 0.0, 14.0
        for _ in range(14):
            middle = (low + high) / 2
            candidate = best.noise.q.copy()
            candidate[j] *= np.exp(middle)
            low, high = (middle, high) if loss(candidate) - base < _RAISED else (low, middle)
        q[j] = best.noise.q[j] * np.exp(low)
    noise = replace(best.noise, q=q)
    result = run(filter_, data, noise, start, best.coloured)
    return NoiseFit(noise, best.coloured, result.loss, best.at, result)
