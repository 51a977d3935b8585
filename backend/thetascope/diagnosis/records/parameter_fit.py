"""Parameters and initial state of a plant by maximum likelihood on healthy rows, alternating with the noise.

The filter's innovations respond to a parameter as to a constant fault: their derivatives come from the compiled
tangents of the flow (engine/filtering). With the noise held, −2 log L is minimised by damped Gauss–Newton steps; then
the noise is fitted anew. A parameter that the rows do not determine is held at its value.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.records import noise_fit
from thetascope.diagnosis.records.model import RecordModel
from thetascope.diagnosis.records.noise_fit import NoiseFit, Start
from thetascope.engine.filtering.bundles import Noise, Rows
from thetascope.engine.filtering.linear import solved
from thetascope.engine.filtering.record_filter import RecordFilter

_ROUNDS = 3  # of parameters and noise
_STEPS = 8  # of Gauss–Newton in each
_RELATIVE = 0.1  # of a parameter: its unit
_VAGUE = 0.3  # standard deviation relative to the value above which a parameter cannot be identified
_FACTOR = 3.0  # by which a parameter may change at most
_GAIN = 12.0  # by which a parameter must lower −2 log L to be suspected
_HINT = 5.0  # the same to first order, with the process noise of the misfit
_TRIED = 3  # parameters that are fitted one at a time, at most
_MOST = 4  # parameters that are fitted without being asked for


@dataclass(frozen=True)
class FittedParameter:
    """A parameter before and after the fit, with its standard deviation; ``held``: it cannot be identified."""

    name: str
    before: float
    value: float
    std: float
    held: bool


@dataclass(frozen=True)
class ParameterFit:
    """A fitted plant.

    Attributes:
        model: with the new parameters.
        start: the prediction for the first row.
        noise: fitted with it.
        parameters: before and after.
        before: −2 log L with the parameters as they were.
    """

    model: RecordModel
    start: Start
    noise: NoiseFit
    parameters: tuple[FittedParameter, ...]
    before: float


@dataclass(frozen=True)
class _Point:
    """Values of the free parameters and of the initial state, with −2 log L, and the information about both."""

    values: np.ndarray
    x: np.ndarray
    loss: float
    information: np.ndarray
    gradient: np.ndarray


class _Problem:
    """−2 log L of rows as a function of some parameters and the initial state, for given noise."""

    def __init__(self, model: RecordModel, data: Rows, start: Start, names: Sequence[str]):
        self.model, self.data, self.start, self.names = model, data, start, tuple(names)
        program = model.program
        self.places = [program.parameters.index(f"p.{n}") for n in names]
        self.first = model.filter.equations.par[self.places]
        limits = {p["name"]: p.get("bounds") or (None, None) for p in model.data["parameters"]}
        self.units = np.array([_unit(v, limits[n]) for v, n in zip(self.first, names, strict=True)])
        low = [-np.inf if lowest is None else float(lowest) for lowest, _ in (limits[n] for n in names)]
        high = [np.inf if highest is None else float(highest) for _, highest in (limits[n] for n in names)]
        more = np.maximum((_FACTOR - 1) * np.abs(self.first), (self.first == 0) * 10 * self.units)
        less = np.maximum((1 - 1 / _FACTOR) * np.abs(self.first), (self.first == 0) * 10 * self.units)
        below, above = np.where(self.first < 0, more, less), np.where(self.first < 0, less, more)
        self.low, self.high = np.maximum(low, self.first - below), np.minimum(high, self.first + above)
        self.directions = tuple(f"p.{n}" for n in names)
        self.scales = model.scales

    def filter(self, values: np.ndarray) -> RecordFilter:
        """Return the filter with the parameters' values, and the parameters as directions."""
        par = self.model.filter.equations.par.copy()
        par[self.places] = values
        return self.model.with_directions(self.directions, self.units).with_parameters(par)

    def loss(self, fit: Noise, coloured: bool, values: np.ndarray, x: np.ndarray) -> float:
        """Return −2 log L with the weak pull of the initial state."""
        start = Start(x, self.start.P)
        loss = noise_fit.run(self.filter(values), self.data, fit, start, coloured, channels=()).loss
        return loss + float(np.sum(((x - self.start.x) / self.scales) ** 2)) if np.isfinite(loss) else np.inf

    def point(self, noise: Noise, coloured: bool, values: np.ndarray, x: np.ndarray) -> _Point:
        """Return information and gradient at a point: parameters in their units, then the state in its scales."""
        filter_, n, d = self.filter(values), len(x), len(values)
        result = noise_fit.run(filter_, self.data, noise, Start(x, self.start.P), coloured)
        rows, na = len(self.data.t), result.path.z.shape[1]
        ones, zeros = np.ones((d, rows)), np.zeros((n, rows))
        start = np.zeros((d + n, na))
        start[d:, :n] = np.diag(self.scales)
        channel = np.concatenate([np.arange(d), np.zeros(n)])
        course = np.concatenate([ones, zeros])
        omega = filter_.responses(self.data, noise, result.path, channel, course, course, start).reshape(d + n, -1)
        pull = np.concatenate([np.zeros(d), np.ones(n)])
        away = np.concatenate([np.zeros(d), (x - self.start.x) / self.scales])
        information = omega @ omega.T + np.diag(pull)
        gradient = omega @ np.nan_to_num(result.path.nu).ravel() - away
        return _Point(values, x, self.loss(noise, coloured, values, x), information, gradient)

    def minimum(self, noise: Noise, coloured: bool, values: np.ndarray, x: np.ndarray) -> _Point:
        """Return the best point (damped Gauss–Newton)."""
        point, damping, d = self.point(noise, coloured, values, x), 1e-4, len(values)
        for _ in range(_STEPS):
            diagonal = np.diag(point.information)
            better = None
            for _ in range(6):
                step = solved(point.information + np.diag(damping * diagonal + 1e-9), point.gradient)
                moved = np.clip(point.values + step[:d] * self.units, self.low, self.high)
                state = point.x + np.clip(step[d:], -3, 3) * self.scales
                if self.loss(noise, coloured, moved, state) < point.loss - 1e-3:
                    better = self.point(noise, coloured, moved, state)
                    break
                damping = max(10 * damping, 1e-2)
            if better is None:
                break
            fall, point, damping = point.loss - better.loss, better, max(damping / 10, 1e-9)
            if fall < 0.05:
                break
        return point


def _unit(value: float, limits: Sequence[float | None]) -> float:
    """Return the natural unit of a parameter."""
    low, high = limits
    width = float(high) - float(low) if low is not None and high is not None else 1.0
    return _RELATIVE * (abs(value) or width)


@dataclass(frozen=True)
class SuspectedParameter:
    """A parameter that would lower −2 log L by `gain` if it were `factor` times as large."""

    name: str
    factor: float
    gain: float


def suspected_parameters(
    model: RecordModel, data: Rows, start: Start, resolution: np.ndarray, fitted: NoiseFit
) -> list[SuspectedParameter]:
    """Return single parameters whose change would let the model fit clearly better, the largest gain first."""
    names = model.names("parameters")
    if not names:
        return []
    problem = _Problem(model, data, start, names)
    point = problem.point(fitted.noise, fitted.coloured, problem.first, start.x)
    d = len(names)
    J, s = point.information, point.gradient
    to_state = solved(J[d:, d:], np.column_stack([J[d:, :d], s[d:]]))
    own = np.diag(J)[:d] - np.einsum("ij,ji->i", J[:d, d:], to_state[:, :d])
    pull = s[:d] - J[:d, d:] @ to_state[:, d]
    with np.errstate(divide="ignore", invalid="ignore"):
        gains = np.where(own > 1e-9 * np.maximum(np.diag(J)[:d], 1e-300), pull**2 / own, 0.0)
    suspects = []
    for j in np.argsort(-gains)[:_TRIED]:
        if gains[j] > _HINT:
            end = _alternate(model, data, start, resolution, [names[j]], fitted)
            gain = fitted.loss - end[2].loss
            if gain > _GAIN:
                suspects.append(
                    SuspectedParameter(names[j], _ratio(float(end[3].values[0]), float(problem.first[j])), gain)
                )
    return sorted(suspects, key=lambda suspect: -suspect.gain)


def _ratio(value: float, before: float) -> float:
    return value / before if before else float("nan")


def fit_suspects(
    model: RecordModel,
    data: Rows,
    start: Start,
    resolution: np.ndarray,
    fitted: NoiseFit,
    suspects: Sequence[SuspectedParameter],
) -> ParameterFit | None:
    """Return the plant with suspected parameters fitted, the likeliest first, as long as one more helps clearly."""
    names: list[str] = []
    best = None
    present = list(suspects)
    while present and len(names) < _MOST:
        names.append(present[0].name)
        trial = fit_parameters(model, data, start, resolution, names, fitted)
        if best is not None and best.noise.loss - trial.noise.loss < _GAIN:
            break
        best = trial
        rest = suspected_parameters(trial.model, data, trial.start, resolution, trial.noise)
        present = [s for s in rest if s.name not in names]
    return best


def fit_parameters(
    model: RecordModel,
    data: Rows,
    start: Start,
    resolution: np.ndarray,
    names: Sequence[str],
    first: NoiseFit | None = None,
) -> ParameterFit:
    """Return the plant with the most likely values of some parameters on healthy rows.

    Args:
        model, data, start: the plant, the rows and the prediction for the first of them.
        resolution: (m,), steps between readings.
        names: the parameters; those that cannot be identified are held.
        first: noise that was fitted to the plant as it is, if it is known.
    """
    first = first or noise_fit.fit(model.filter, data, start, model.scales, model.measured, resolution)
    free, held = list(names), {}
    while free:
        fitted, begin, noise, point, problem = _alternate(model, data, start, resolution, free, first)
        std = _deviations(point, problem)
        vague = std / np.maximum(np.abs(problem.first), 10 * problem.units)
        worst = int(vague.argmax())
        if vague[worst] <= _VAGUE:
            values = dict(zip(free, zip(point.values, std, strict=True), strict=True))
            return ParameterFit(fitted, begin, noise, _table(model, names, values, held), first.loss)
        held[free[worst]] = float(std[worst])
        del free[worst]
    return ParameterFit(model, start, first, _table(model, names, {}, held), first.loss)


def _alternate(
    model: RecordModel, data: Rows, start: Start, resolution: np.ndarray, names: Sequence[str], noise: NoiseFit
) -> tuple[RecordModel, Start, NoiseFit, _Point, _Problem]:
    """Return the better result of fitting parameters and noise in turn from two starts.

    One start is the plant as it is. The other is its best fit without process noise, because process noise of a plant
    that does not fit hides what its parameters do.
    """
    problem = _Problem(model, data, start, names)
    quiet = replace(noise.noise, q=1e-4 * noise.noise.q, r=np.maximum(noise.noise.r, 10 * noise_fit.scatter(data.y)))
    other = problem.minimum(quiet, noise.coloured, problem.first, start.x)
    ends = [_from(problem, noise, resolution, v, x) for v, x in ((problem.first, start.x), (other.values, other.x))]
    return min(ends, key=lambda end: end[2].loss)


def _from(
    problem: "_Problem", noise: NoiseFit, resolution: np.ndarray, values: np.ndarray, x: np.ndarray
) -> tuple[RecordModel, Start, NoiseFit, _Point, "_Problem"]:
    """Return the result of fitting parameters and noise in turn from a point."""
    model, start, names = problem.model, problem.start, problem.names
    fitted, point = model, None
    if values is not problem.first:
        fitted = model.with_parameters(dict(zip(names, values, strict=True)))
        noise = _noise(problem, fitted, x, resolution, noise)
    for _ in range(_ROUNDS):
        before = np.inf if point is None else point.loss
        point = problem.minimum(noise.noise, noise.coloured, values, x)
        values, x = point.values, point.x
        fitted = model.with_parameters(dict(zip(names, values, strict=True)))
        noise = _noise(problem, fitted, x, resolution, noise)
        if abs(before - noise.loss) < 1.0:
            break
    assert point is not None
    return fitted, replace(start, x=x), noise, point, problem


def _noise(problem: _Problem, model: RecordModel, x: np.ndarray, resolution: np.ndarray, before: NoiseFit) -> NoiseFit:
    """Return the noise for other parameters; a coloured part is tried only if there was one before."""
    start = replace(problem.start, x=x)
    white = not before.coloured
    return noise_fit.fit(model.filter, problem.data, start, model.scales, model.measured, resolution, white)


def _deviations(point: _Point, problem: _Problem) -> np.ndarray:
    """Return the standard deviations of the parameters."""
    diagonal = np.diag(point.information) + 1e-12
    root = np.sqrt(np.outer(diagonal, diagonal))
    scaled = point.information / root + 1e-10 * np.eye(len(diagonal))
    covariance = solved(scaled, np.eye(len(diagonal))) / root
    return np.sqrt(np.maximum(np.diag(covariance)[: len(problem.units)], 0.0)) * problem.units


def _table(model: RecordModel, names: Sequence[str], values: dict, held: dict) -> tuple[FittedParameter, ...]:
    before = {p["name"]: float(p["value"]) for p in model.data["parameters"]}
    return tuple(
        FittedParameter(n, before[n], float(values[n][0]), float(values[n][1]), False)
        if n in values
        else FittedParameter(n, before[n], before[n], held.get(n, float("nan")), True)
        for n in names
    )
