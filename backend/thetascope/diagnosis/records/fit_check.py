"""Does the model fit? Tests of the innovations on healthy rows, before any fault is named.

Whiteness alone says little: process noise absorbs an error of the model. So the tests look for bias, colour that the
noise model cannot express, dependence on past inputs, and jumps.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, f

from thetascope.diagnosis.recording import Recording
from thetascope.diagnosis.records import noise_fit
from thetascope.diagnosis.records.model import RecordModel
from thetascope.diagnosis.records.noise_fit import NoiseFit, Start
from thetascope.diagnosis.records.suspects import Suspect, suspected
from thetascope.engine.filtering.bundles import Rows

BIASED = 4.0  # standard errors of the mean innovation
COLOURED = 1e-6  # probability of the autocorrelation
_ROUNDED = 0.5  # share of rounding in the variance of the noise from which whiteness is not tested
_LAGS = 20
_QUIET = 3.0  # times the noise: no unit is doubted if the simulation errs by less
DRIVEN = 1e-5  # probability of the dependence on past input changes
_LARGE = 32.0  # statistic of the onset bank within healthy rows
OUTSIDE = 0.01  # share of the rows with an input beyond its bounds


@dataclass(frozen=True)
class OutputFit:
    """How well one output fits on the healthy rows.

    Attributes:
        predicted: 1 − ‖error‖/‖y − mean‖ of predictions from row to row.
        simulated: the same of the simulation from the first row on.
        noise: standard deviation of the fitted measurement noise, its coloured part included.
        innovation: standard deviation of the innovations.
        bias: mean innovation in standard errors.
        whiteness: probability of the autocorrelation of the innovations (Ljung and Box, Biometrika 65, 1978).
        lag_one: their autocorrelation between neighbouring rows.
        spread: standard deviation of the readings.
    """

    predicted: float
    simulated: float
    noise: float
    innovation: float
    bias: float
    whiteness: float
    lag_one: float
    spread: float


@dataclass(frozen=True)
class Finding:
    """A failed test: its kind, the output, input or channel that it concerns, and its numbers."""

    kind: str
    name: str
    value: float
    row: int | None = None


@dataclass(frozen=True)
class FitCheck:
    """Whether the model fits healthy rows: the fit of each output, failed tests, and suspects, the likeliest first."""

    outputs: tuple[OutputFit, ...]
    findings: tuple[Finding, ...]
    suspects: tuple[Suspect, ...]

    @property
    def fits(self) -> bool:
        """Return whether faults may be named."""
        return not self.findings


def output_fits(model: RecordModel, data: Rows, start: Start, fitted: NoiseFit) -> tuple[OutputFit, ...]:
    """Return how well each output fits."""
    path = fitted.result.path
    _, simulated = model.filter.simulate(data, start.x)
    fits = []
    for k in range(model.filter.m):
        seen = np.isfinite(path.nu[:, k])
        nu, y = path.nu[seen, k], data.y[seen, k]
        if not len(y):
            fits.append(OutputFit(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0))
            continue
        spread = float(np.linalg.norm(y - y.mean())) or 1.0
        error = nu * path.sd[seen, k]
        probability, lag_one = ljung_box(path.nu[:, k])
        fits.append(
            OutputFit(
                1.0 - float(np.linalg.norm(error)) / spread,
                1.0 - float(np.linalg.norm(y - simulated[seen, k])) / spread,
                float(np.sqrt(fitted.noise.r[k] + fitted.coloured * fitted.noise.s2[k])),
                float(np.sqrt(np.mean(error**2))),
                float(nu.mean() * np.sqrt(len(nu)) / (nu.std() or 1.0)),
                probability,
                lag_one,
                float(y.std()),
            )
        )
    return tuple(fits)


def ljung_box(nu: np.ndarray, lags: int = _LAGS) -> tuple[float, float]:
    """Return the probability of a sequence's autocorrelation if it were white, and its value at lag 1; NaN: gaps."""
    seen = np.isfinite(nu)
    z = np.where(seen, nu - np.nanmean(nu), 0.0)
    variance, total = float(np.mean(z[seen] ** 2)), 0.0
    if variance <= 0 or seen.sum() < 3 * lags:
        return 1.0, 0.0
    first = 0.0
    for lag in range(1, lags + 1):
        pairs = int((seen[lag:] & seen[:-lag]).sum())
        if pairs < 10:
            continue
        r = float(np.sum(z[lag:] * z[:-lag])) / pairs / variance
        total += pairs * r * r
        first = r if lag == 1 else first
    return float(chi2.sf(total, lags)), first


def driven_by(nu: np.ndarray, u: np.ndarray, lags: int = _LAGS) -> float:
    """Return the probability that innovations do not depend on the changes of one input 1 … lags + 1 rows before.

    Lag 0 is left out: in a closed loop the input follows the reading of the same row.
    """
    changes = np.diff(u, prepend=u[0])
    columns = np.stack([np.roll(changes, lag) for lag in range(1, lags + 2)], axis=1)[lags + 1 :]
    target = nu[lags + 1 :]
    seen = np.isfinite(target)
    columns, target = columns[seen], target[seen]
    used = columns.std(axis=0) > 1e-12 * max(float(np.abs(u).max()), 1e-300)
    columns = columns[:, used]
    rows, k = columns.shape
    if k == 0 or rows < 5 * k + 20:
        return 1.0
    design = np.column_stack([np.ones(rows), columns])
    solution, *_ = np.linalg.lstsq(design, target, rcond=1e-10)
    rest = float(np.sum((target - design @ solution) ** 2))
    whole = float(np.sum((target - target.mean()) ** 2))
    if rest <= 0 or whole <= 0:
        return 1.0
    return float(f.sf((whole - rest) / k / (rest / (rows - k - 1)), k, rows - k - 1))


def check(
    model: RecordModel,
    recording: Recording,
    data: Rows,
    start: Start,
    fitted: NoiseFit,
    largest: tuple[float, int],
    visible: np.ndarray,
    whole: Rows,
) -> FitCheck:
    """Return whether the model fits healthy rows.

    Args:
        model, recording, data, start, fitted: the plant, the healthy part of the recording, the same as rows, the
            prediction for the first row, and the noise.
        largest: the largest statistic of the onset bank along the rows, and its row.
        visible: (channels,), whether a fault of 1.5 typical sizes would be found.
        whole: all rows, on which units are tried: no fault looks like a wrong unit.
    """
    fits = output_fits(model, data, start, fitted)
    findings = [*_outside(model, recording), *_innovations(model, data, fitted, fits, recording.resolution)]
    if largest[0] > _LARGE:
        findings.append(Finding("not-healthy", "", largest[0], largest[1]))
    if len(visible) and not visible.any():
        findings.append(Finding("blind", "", 0.0))
    read = np.isfinite(data.y).any(axis=0)
    errors = np.array([(1 - fit.simulated) * fit.spread for fit in fits])
    quiet = bool(np.all((errors < _QUIET * np.sqrt(noise_fit.scatter(data.y)))[read]))
    suspects = [] if quiet else suspected(model, whole, start)
    if suspects:
        findings.append(Finding("unit", suspects[0].name, suspects[0].gain))
    if findings:
        findings = [*_still(model, whole), *findings]
    return FitCheck(fits, tuple(findings), tuple(suspects))


def _still(model: RecordModel, data: Rows) -> list[Finding]:
    """Return inputs that never move: with one that is missing, the plant's default is used."""
    names = [*model.names("inputs"), *model.names("signals")]
    return [Finding("still", name, 0.0) for name, u in zip(names, data.u.T, strict=True) if np.ptp(u) == 0]


def _outside(model: RecordModel, recording: Recording) -> list[Finding]:
    """Return inputs that are beyond their bounds."""
    findings = []
    items = [*model.data["inputs"], *model.data["signals"]]
    for i, item in enumerate(items):
        low, high = item.get("bounds") or (None, None)
        low, high = -np.inf if low is None else low, np.inf if high is None else high
        slack = 1e-3 * ((high - low) if np.isfinite(high - low) else 0.0)
        beyond = (recording.u[:, i] < low - slack) | (recording.u[:, i] > high + slack)
        if beyond.mean() > OUTSIDE:
            findings.append(Finding("input-bounds", item["name"], float(beyond.mean()), int(np.argmax(beyond))))
    return findings


def _innovations(
    model: RecordModel, data: Rows, fitted: NoiseFit, fits: Sequence[OutputFit], resolution: np.ndarray
) -> list[Finding]:
    """Return the failed tests of the innovations.

    Where most of the noise is rounding to the resolution, errors depend on each other in any case: whiteness says
    nothing about the model there.
    """
    findings, nu = [], fitted.result.path.nu
    inputs = [*model.names("inputs"), *model.names("signals")]
    for k, (name, fit) in enumerate(zip(model.names("outputs"), fits, strict=True)):
        if abs(fit.bias) > BIASED:
            findings.append(Finding("bias", name, fit.bias))
        rounded = resolution[k] ** 2 / 12 > _ROUNDED * fit.noise**2
        if fit.whiteness < COLOURED and not rounded:
            findings.append(Finding("coloured", name, fit.whiteness))
        limit = np.sqrt(2 * np.log(1000.0 * max(len(nu), 2)))
        far = np.abs(np.nan_to_num(nu[:, k]))
        if far.max(initial=0.0) > limit:
            findings.append(Finding("jump", name, float(far.max()), int(far.argmax())))
        chances = [driven_by(nu[:, k], data.u[:, i]) for i in range(data.u.shape[1])]
        if chances and min(chances) < DRIVEN:
            findings.append(Finding("driven", inputs[int(np.argmin(chances))], min(chances)))
    return findings
