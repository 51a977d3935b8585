"""Diagnose a record: does the model fit the healthy stretch, and which faults does the rest show?"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.recording import Recording
from thetascope.diagnosis.records import fit_check, healthy, noise_fit, thresholds
from thetascope.diagnosis.records.findings import RecordFault, final_faults
from thetascope.diagnosis.records.fit_check import Finding, FitCheck
from thetascope.diagnosis.records.follow import Decision, Follower
from thetascope.diagnosis.records.model import (
    RecordModel,
    enough_steps,
    first_noise,
    input_course,
    model_of,
    rows_of,
    start_of,
    with_gaps,
)
from thetascope.diagnosis.records.noise_fit import NoiseFit, Start
from thetascope.diagnosis.records.parameter_fit import (
    ParameterFit,
    SuspectedParameter,
    fit_parameters,
    fit_suspects,
    suspected_parameters,
)
from thetascope.engine.filtering.bundles import Rows
from thetascope.engine.filtering.record_filter import part_of
from thetascope.engine.inputs.readings import HELD

SEEN = 1.5  # typical sizes: faults of this size must be visible in the healthy stretch
_USUAL = 30.0  # threshold with which visible faults are judged before that of the record is known
_TRIAL_ROWS = 4096
_MANY, _MANY_GIVEN = 4, 8  # faults in one record
_LOUD = 2.5  # variance of the innovations after the healthy stretch, with the faults in them,
_SLUGGISH = 0.5  # and their autocorrelation between neighbouring rows
AUTO, NEVER = "auto", "never"


@dataclass(frozen=True)
class RecordSettings:
    """How a record is diagnosed.

    Attributes:
        healthy: (begin, end) in s after the first row, known to be healthy; None: found.
        false_alarms: accepted ones per hour.
        fit: AUTO: parameters are fitted where the model does not fit without; NEVER; or names of parameters to fit.
    """

    healthy: tuple[float, float] | None = None
    false_alarms: float = 0.01
    fit: str | tuple[str, ...] = AUTO


@dataclass(frozen=True)
class RecordAnswer:
    """The diagnosis of a record.

    Attributes:
        model: the plant, with fitted parameters if they were fitted.
        begin: s after the first row of the record from which on times count: where the healthy stretch begins.
        rows: all rows from there on.
        healthy: (begin, end), rows of the healthy stretch; `given`: as the user declared it.
        check: does the model fit? `before`: the same with the parameters as they were, if they were fitted.
        noise: with which the rest was judged.
        parameters: the fit of parameters, if there was one; `suspects`: what each alone would explain.
        threshold: of the statistic, 0 if it was not needed; `rate`: accepted false alarms per hour;
            `promised`: the rate that can be promised with noise estimated from this healthy stretch, 0 likewise.
        faults: findings, in the order of their onsets; `decisions`: how they came about.
        smallest: (channels,), the smallest step that would have been found in the healthy stretch; ∞ for none.
        statistic: (rows,), the largest one of each row, under the faults known by then; empty if it does not fit.
        course: of the inputs between rows: HELD, HELD_BEFORE or LINEAR.
    """

    model: RecordModel
    begin: float
    rows: Rows
    healthy: tuple[int, int]
    given: bool
    check: FitCheck
    noise: NoiseFit | None
    before: FitCheck | None = None
    parameters: ParameterFit | None = None
    suspects: tuple[SuspectedParameter, ...] = ()
    threshold: float = 0.0
    rate: float = 0.0
    promised: float = 0.0
    faults: tuple[RecordFault, ...] = ()
    decisions: tuple[Decision, ...] = ()
    smallest: np.ndarray = field(default_factory=lambda: np.zeros(0))
    statistic: np.ndarray = field(default_factory=lambda: np.zeros(0))
    course: str = HELD

    def covered(self, onset: float) -> bool:
        """Return whether the healthy stretch covers inputs, and changes of inputs, as large as those at an onset."""
        data, (begin, end) = self.rows, self.healthy
        if not data.u.size:
            return True
        known = data.u[: end - begin]
        at = int(np.searchsorted(data.t, onset))
        here = slice(max(at - 3, 0), at + 4)
        slack = 0.05 * (known.max(axis=0) - known.min(axis=0)) + 1e-9 * np.abs(known).max(axis=0)
        inside = (data.u[here] >= known.min(axis=0) - slack) & (data.u[here] <= known.max(axis=0) + slack)
        change = np.abs(np.diff(data.u[here], axis=0)).max(axis=0, initial=0.0)
        usual = np.abs(np.diff(known, axis=0)).max(axis=0, initial=0.0)
        return bool(inside.all() and (change <= usual + slack).all())

    @property
    def fits(self) -> bool:
        """Return whether the model fits, so that faults are named."""
        return self.check.fits


class NotIntegrable(Exception):
    """No number of integration steps is accurate along the record."""


@dataclass(frozen=True)
class _Prepared:
    """A model with its rows and what is known of the healthy stretch."""

    model: RecordModel
    data: Rows
    start: Start
    part: Rows
    recording: Recording
    fitted: NoiseFit
    smallest: np.ndarray
    check: FitCheck


def _prepared(model: RecordModel, recording: Recording, steps: float, course: str) -> tuple[Rows, Start]:
    """Return the rows and the prediction for the first of them, for some course of the inputs between rows."""
    data = rows_of(recording, model.data, steps, course)
    noise = first_noise(model, data)
    data = with_gaps(model, data, recording, noise)
    return data, start_of(model, data, noise)


def diagnose(
    plant: Mapping, recording: Recording, settings: RecordSettings, progress: Callable[[int], None] = lambda row: None
) -> RecordAnswer:
    """Return the diagnosis of a record of a plant (JSON values). Raises NotIntegrable, ExpressionError, SpecError."""
    model = model_of(plant, recording)
    steps = enough_steps(model, recording)
    if steps is None:
        raise NotIntegrable
    data, start = _prepared(model, recording, steps, HELD)
    begin, end = _stretch(model, data, start, recording, settings)
    course = input_course(model, recording.part(begin, end), steps)
    if course != HELD:
        data, start = _prepared(model, recording, steps, course)
        begin, end = _stretch(model, data, start, recording, settings)
    offset = float(data.t[begin])
    if begin:
        recording, data = recording.part(begin, len(recording)), part_of(data, begin, len(data.t))
        start = start_of(model, data, first_noise(model, data))
    state = _checked(model, data, start, recording, end - begin)
    before, parameters, suspects = None, None, ()
    if settings.fit != NEVER:
        parameters, suspects = _parameters(state, settings)
        if parameters is not None:
            if settings.healthy is None:  # a better model may show earlier that a fault has begun
                end = healthy.found_stretch(parameters.model, data, parameters.start, recording.resolution)
            better = _checked(parameters.model, data, parameters.start, recording, end - begin)
            before, state = state.check, better
    answer = RecordAnswer(
        model=state.model,
        begin=offset,
        rows=data,
        healthy=(begin, end),
        given=settings.healthy is not None,
        check=state.check,
        noise=state.fitted,
        before=before,
        parameters=parameters,
        suspects=tuple(suspects),
        smallest=state.smallest,
        rate=settings.false_alarms,
        course=course,
    )
    return _followed(state, settings, answer, progress) if state.check.fits else answer


def _parameters(state: _Prepared, settings: RecordSettings) -> tuple[ParameterFit | None, Sequence[SuspectedParameter]]:
    """Return the fit of the parameters that were asked for or are suspected, and the suspects.

    A wrong unit, an input beyond its bounds or a fault within the healthy stretch is no matter of parameters.
    """
    resolution = state.recording.resolution
    if settings.fit != AUTO:
        names = list(settings.fit)
        return fit_parameters(state.model, state.part, state.start, resolution, names, state.fitted), ()
    if {f.kind for f in state.check.findings} & {"unit", "input-bounds", "blind"}:
        return None, ()
    suspects = suspected_parameters(state.model, state.part, state.start, resolution, state.fitted)
    fitted = fit_suspects(state.model, state.part, state.start, resolution, state.fitted, suspects)
    return fitted, suspects


def _stretch(
    model: RecordModel, data: Rows, start: Start, recording: Recording, settings: RecordSettings
) -> tuple[int, int]:
    """Return the rows of the healthy stretch."""
    if settings.healthy is None:
        return 0, healthy.found_stretch(model, data, start, recording.resolution)
    begin, end = (int(np.searchsorted(data.t, t)) for t in settings.healthy)
    return begin, max(end, min(begin + healthy.FEWEST, len(data.t)))


def _checked(model: RecordModel, data: Rows, start: Start, recording: Recording, rows: int) -> _Prepared:
    """Return the model with the noise of the healthy stretch, and whether it fits."""
    part = part_of(data, 0, rows)
    fitted = noise_fit.fit(model.filter, part, start, model.scales, model.measured, recording.resolution)
    smallest = _smallest(model, part, fitted)
    largest = healthy.bank_maximum(model, part, fitted)
    visible = (smallest <= SEEN * model.filter.scale)[: model.own]
    check = fit_check.check(
        model, recording.part(0, rows), part, start, fitted, (largest.statistic, largest.row), visible, data
    )
    return _Prepared(model, data, start, part, recording, fitted, smallest, check)


def _smallest(model: RecordModel, part: Rows, fitted: NoiseFit) -> np.ndarray:
    """Return the smallest step of each channel (channels,) that would be found if it began with the stretch."""
    filter_, rows = model.filter, len(part.t)
    if filter_.d == 0:
        return np.zeros(0)
    ones = np.ones((filter_.d, rows))
    channels = np.arange(filter_.d)
    omega = filter_.responses(part, fitted.noise, fitted.result.path, channels, ones, ones)
    energy = np.sum(omega**2, axis=(1, 2))
    with np.errstate(divide="ignore"):
        return np.where(energy > 1e-12, np.sqrt(_USUAL / np.maximum(energy, 1e-300)), np.inf) * filter_.scale


def _followed(
    state: _Prepared, settings: RecordSettings, answer: RecordAnswer, progress: Callable[[int], None]
) -> RecordAnswer:
    """Return the answer with the faults of the whole record."""
    model, data = state.model, state.data
    noise = noise_fit.with_upper_process_noise(model.filter, state.part, state.start, state.fitted)
    z, P = state.start.extended(noise.noise, noise.coloured)
    part = part_of(data, 0, min(len(data.t), _TRIAL_ROWS))
    path = model.filter.filter(part, noise.noise, z, P).path
    used, tick = np.ones(2 * model.filter.d), float(np.median(data.width))
    crossing = thresholds.crossings(model.filter, part, noise.noise, path, used, tick)
    threshold = thresholds.threshold(crossing, settings.false_alarms)
    follower = Follower(model.filter, noise.noise, data, z, P, model.bounds, used, threshold, model.own, 0, progress)
    follower.run()
    faults = final_faults(follower)
    later = _later(follower, len(state.part.t), len(faults), settings.healthy is not None)
    smallest = state.smallest * np.sqrt(threshold / _USUAL)
    fewest = int(np.isfinite(state.part.y).sum(axis=0).min())
    promised = max(thresholds.promised_rate(crossing, threshold, fewest), settings.false_alarms)
    answer = replace(answer, noise=noise, threshold=threshold, promised=promised, smallest=smallest)
    if later is not None:
        return replace(answer, check=replace(state.check, findings=(*state.check.findings, later)))
    return replace(answer, faults=faults, decisions=tuple(follower.decisions), statistic=follower.statistic)


def _later(follower: Follower, rows: int, faults: int, given: bool) -> Finding | None:
    """Return why the model does not fit after the healthy stretch even with the faults in it, or None.

    A rig seldom has more than a few faults in one record: many of them are a model that does not fit.
    """
    if faults > (_MANY_GIVEN if given else _MANY):
        return Finding("many", "", float(faults))
    data = follower.data
    if len(data.t) - rows < 50:
        return None
    for k, (energy, lag_one) in enumerate(_rest(follower, rows)):
        if energy > _LOUD or lag_one > _SLUGGISH:
            return Finding("later", list(follower.filter.plant.outputs)[k].removeprefix("y."), energy)
    return None


def _rest(follower: Follower, rows: int) -> list[tuple[float, float]]:
    """Return variance and autocorrelation of each output's innovations after the first rows, with the faults known."""
    nu = follower.settle(follower.story)[rows:]
    return [(float(np.nanmean(c**2)) if np.isfinite(c).any() else 0.0, fit_check.ljung_box(c)[1]) for c in nu.T]
