"""A plant and a recording made ready for the filter: equations, scales, steps, what gaps may hide, the start."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from thetascope.diagnosis.recording import Recording
from thetascope.diagnosis.records import noise_fit
from thetascope.diagnosis.records.noise_fit import Start, scatter
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.filtering.bundles import Noise, Rows
from thetascope.engine.filtering.linear import solved
from thetascope.engine.filtering.record_filter import RecordFilter, part_of
from thetascope.engine.inputs.readings import HELD, HELD_BEFORE, LINEAR
from thetascope.engine.programs.program_store import plant_program

_EDGE = 1e-3  # of a state's scale: distance from the edge of its domain at which derivatives are taken
_READ = 10  # readings, at least, of an output that shows a state
_GAP = 1.5  # usual intervals: longer ones may hide changes of the inputs
_STEPS = (1.0, 2.0, 4.0, 8.0, -4.0, -8.0, 16.0, -16.0, 32.0, -32.0, 64.0, -64.0, 128.0, -128.0, 256.0, -256.0)
_FINE = -16.0  # steps of the trajectory along which steps are chosen
_STEP_ROWS = 2000  # of that trajectory
_ACCURATE = 0.01  # of the noise of an innovation: the most that halving the steps may change a prediction,
_SMALL = 2e-4  # and of the scale of a state,
_NEARLY_ALL = 0.98  # in this share of the rows: the first estimates may be far from the trajectory
_ROUNDS = 3
_COURSE_ROWS = 1000  # on which courses of the inputs are compared
_BETTER = 10.0  # fall of −2 log L by which another course of the inputs must fit better
_START_ROWS = 400  # rows that determine the initial state


@dataclass(frozen=True)
class RecordModel:
    """A plant as records are diagnosed with it.

    Attributes:
        data: the plant (JSON values).
        program: its equations, with additive faults on states and outputs where it has no such channel.
        filter: with the faults as directions.
        own: the plant's own channels; the others are the additive faults, which enter at `targets`.
        bounds: (channels, 2), of θ, ±∞ for none.
        scales: (n,), sizes of the states along the record.
        measured: (n,), the output whose expression is just this state, −1 for none.
        initial: (n,), the plant's initial state.
    """

    data: Mapping
    program: Program
    filter: RecordFilter
    own: int
    targets: tuple[str, ...]
    bounds: np.ndarray
    scales: np.ndarray
    measured: np.ndarray
    initial: np.ndarray

    def with_directions(self, directions: tuple[str, ...], scale: np.ndarray) -> RecordFilter:
        """Return a filter of the same plant with other directions."""
        e = self.filter.equations
        return RecordFilter(self.program, directions, scale, e.par, e.low, e.high)

    def with_parameters(self, values: Mapping[str, float]) -> "RecordModel":
        """Return the model with other values of some parameters."""
        par = self.filter.equations.par.copy()
        for name, value in values.items():
            par[self.program.parameters.index(f"p.{name}")] = value
        return replace(self, filter=self.filter.with_parameters(par))

    def names(self, part: str) -> list[str]:
        """Return the names of the plant's states, inputs, outputs, parameters or channels."""
        return [item["name"] for item in self.data[part]]


def _limits(items: list, key: str) -> np.ndarray:
    """Return bounds (items, 2), ±∞ for none."""
    pairs = [item.get(key) or (None, None) for item in items]
    return np.array(
        [[-np.inf if a is None else float(a), np.inf if b is None else float(b)] for a, b in pairs]
    ).reshape(len(items), 2)


def model_of(plant: Mapping, recording: Recording) -> RecordModel:
    """Return the model of a plant (JSON values) for a recording.

    Raises ExpressionError or SpecError for equations that are not valid.
    """
    own, channels = len(plant["channels"]), _channels(plant)
    program = plant_program({**plant, "channels": channels}).program
    values = {f"p.{p['name']}": float(p["value"]) for p in plant["parameters"]}
    par = np.array([values[name] for name in program.parameters])
    faults = tuple(f"theta.{c['name']}" for c in channels)
    domain = _limits(plant["states"], "domain")
    measured = np.full(len(plant["states"]), -1)
    names = [s["name"] for s in plant["states"]]
    for k, output in enumerate(plant["outputs"]):
        text = output["expression"].strip()
        read = np.isfinite(recording.y[:, k]).sum() >= _READ
        if read and text in names and measured[names.index(text)] < 0:
            measured[names.index(text)] = k
    initial = np.array([float(s.get("initial", 0.0)) for s in plant["states"]])
    start = first_readings(initial, measured, recording.y)
    free = RecordFilter(program, faults, np.ones(len(faults)), par, domain[:, 0], domain[:, 1])
    data = rows_of(recording, plant)
    scales = _scales(free, data, start, measured, domain)
    sizes = dict(zip(names, 0.01 * scales / float(np.median(data.width)), strict=True))
    sizes |= dict(zip((o["name"] for o in plant["outputs"]), 3.0 * np.sqrt(scatter(recording.y)), strict=True))
    targets = tuple(next(iter(c["enters"])) for c in channels[own:])
    typical = [float(c.get("typical") or 1.0) for c in plant["channels"]] + [sizes[t] or 1.0 for t in targets]
    edge = _EDGE * scales
    filter_ = RecordFilter(program, faults, np.array(typical), par, domain[:, 0] + edge, domain[:, 1] - edge)
    bounds = _limits(channels, "bounds")
    return RecordModel(plant, program, filter_, own, targets, bounds, scales, measured, start)


def _channels(plant: Mapping) -> list[dict]:
    """Return the plant's channels, and additive faults on the states and outputs that have none."""
    channels = [dict(c) for c in plant["channels"]]
    plain = {
        target
        for c in channels
        for target, text in c["enters"].items()
        if len(c["enters"]) == 1 and text.strip() == "1"
    }
    targets = [item["name"] for part in ("states", "outputs") for item in plant[part]]
    taken = {c["name"] for c in channels}
    for target in targets:
        if target not in plain:
            name = f"additive_{target}"
            while name in taken:
                name += "_"
            channels.append({"name": name, "kind": "process", "enters": {target: "1"}})
    return channels


def first_readings(initial: np.ndarray, measured: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the initial state with the first readings of measured states."""
    start = initial.copy()
    for i, k in enumerate(measured):
        seen = y[:20, k][np.isfinite(y[:20, k])] if k >= 0 else y[:0, 0]
        if len(seen):
            start[i] = seen[0]
    return start


def _scales(
    filter_: RecordFilter, data: Rows, start: np.ndarray, measured: np.ndarray, domain: np.ndarray
) -> np.ndarray:
    """Return the size of each state: the spread of its readings, else of a simulation along the recorded inputs."""
    part = part_of(data, 0, min(len(data.t), 4000))
    x, _ = filter_.simulate(part, start)
    scales = np.ones(filter_.n)
    width = domain[:, 1] - domain[:, 0]
    for i, k in enumerate(measured):
        values = data.y[:, k] if k >= 0 else x[:, i]
        values = values[np.isfinite(values)]
        low, high = np.quantile(values, [0.02, 0.98]) if len(values) > 2 else (0.0, 0.0)
        spread = float(high - low)
        if not 0 < spread < 1e150 or (k < 0 and np.isfinite(width[i]) and spread > width[i]):
            spread = 0.1 * (width[i] if np.isfinite(width[i]) else abs(start[i]) or 1.0)
        scales[i] = spread
    return scales


def rows_of(recording: Recording, plant: Mapping, steps: float = 1.0, inputs: str = HELD) -> Rows:
    """Return the rows for the filter, from t = 0 on, with `steps` integration steps for the usual interval.

    Negative numbers: of the method for stiff plants. ``inputs``: what they are between rows, see `input_course`.
    """
    t = recording.t - recording.t[0]
    width = np.diff(t, append=t[-1] + (np.median(np.diff(t)) if len(t) > 1 else 1.0))
    if plant["time"]["kind"] == DISCRETE:
        count = np.maximum(1.0, np.rint(width / float(plant["time"]["period"])))
    else:
        count = np.sign(steps) * np.maximum(1.0, np.ceil(abs(steps) * width / np.median(width) - 1e-9))
    n = len(plant["states"])
    t, width, count, u, y = (np.array(a, dtype=float, order="C") for a in (t, width, count, recording.u, recording.y))
    between = u.copy()
    if inputs != HELD:
        between[:-1] = u[1:] if inputs == HELD_BEFORE else 0.5 * (u[:-1] + u[1:])
    return Rows(t, width, count, u, between, y, np.full(len(t), -1.0), np.zeros((0, n, n)))


def first_noise(model: RecordModel, data: Rows) -> Noise:
    """Return rough noise, from differences of readings."""
    r = np.maximum(scatter(data.y), 1e-9 * np.maximum(np.nanvar(data.y, axis=0), 1e-300))
    period = float(np.median(data.width))
    q = (1e-3 * model.scales) ** 2 / period
    q = np.where(model.measured >= 0, 0.1 * r[np.maximum(model.measured, 0)] / period, q)
    return Noise(q, r, np.ones(len(r)) / period, np.zeros(len(r)))


def enough_steps(model: RecordModel, recording: Recording) -> float | None:
    """Return integration steps for the usual interval that are accurate against the noise; None if none suffice."""
    if model.program.time == DISCRETE:
        return 1.0
    part = recording.part(0, min(len(recording), _STEP_ROWS))
    data = rows_of(part, model.data, _FINE)
    noise = first_noise(model, data)
    path = model.filter.filter(data, noise, model.initial, np.diag(model.scales**2), channels=()).path
    points = np.where(np.isfinite(path.z), path.z, model.initial)
    for i, k in enumerate(model.measured):  # rough noise lets the filter stray where the plant is fast
        if k >= 0:
            points[:, i] = np.where(np.isfinite(data.y[:, k]), data.y[:, k], points[:, i])
    points = np.clip(points, model.filter.equations.low, model.filter.equations.high)
    for steps in _STEPS:
        ends = model.filter.flows(rows_of(part, model.data, steps), points)
        change = np.abs(model.filter.flows(rows_of(part, model.data, 2 * steps), points) - ends)
        shown = np.abs(np.einsum("kij,kj->ki", path.H, change)) / np.nanmedian(path.sd, axis=0)
        accurate = (np.nan_to_num(shown) < _ACCURATE).all(axis=1) & (change < _SMALL * model.scales).all(axis=1)
        if accurate.mean() >= _NEARLY_ALL:
            return steps
    return None


def input_course(model: RecordModel, recording: Recording, steps: float) -> str:
    """Return what the inputs are between healthy rows: held, unless they fit clearly better with another course.

    A controller may act in continuous time, and a logger may write an input just before it changes.
    """
    if model.program.time == DISCRETE or not recording.u.size:
        return HELD
    part, losses = recording.part(0, min(len(recording), _COURSE_ROWS)), {}
    for course in (HELD, HELD_BEFORE, LINEAR):
        data = rows_of(part, model.data, steps, course)
        noise = first_noise(model, data)
        data = with_gaps(model, data, part, noise)
        start = start_of(model, data, noise)
        white = noise_fit.fit(model.filter, data, start, model.scales, model.measured, recording.resolution, white=True)
        losses[course] = white.loss
    best = min(losses, key=losses.__getitem__)
    return best if losses[best] < losses[HELD] - _BETTER else HELD


def with_gaps(model: RecordModel, data: Rows, recording: Recording, noise: Noise) -> Rows:
    """Return the rows with the uncertainty that gaps and held inputs add.

    Over an interval of more than 1.5 usual ones, and where an input was missing and is held, each input may have moved
    by its standard deviation: X = b bᵀ for each, b its effect over the interval; twice that over a gap.
    """
    gap = data.width > _GAP * np.median(data.width)
    gap[-1] = False
    held = recording.held.any(axis=1) if recording.held.size else np.zeros(len(data.t), dtype=bool)
    rows = np.flatnonzero(gap | held)
    names = tuple(i for i in model.program.inputs if not i.startswith("theta."))
    spread = np.nanstd(data.u, axis=0)
    if not len(rows) or not len(names) or not spread.any():
        return data
    effects = _input_effects(model.with_directions(names, np.ones(len(names))), data, noise, model, rows)
    extra = np.zeros((len(rows), model.filter.n, model.filter.n))
    for e, k in enumerate(rows):
        b = effects[e] * spread
        if not gap[k]:
            b = b * recording.held[k]
        b = np.clip(b, -10 * model.scales[:, None], 10 * model.scales[:, None])
        extra[e] = (b @ b.T) * (2.0 if gap[k] else 1.0)
    at = np.full(len(data.t), -1.0)
    at[rows] = np.arange(len(rows))
    return replace(data, extra_at=at, extra=extra)


def _input_effects(filter_: RecordFilter, data: Rows, noise: Noise, model: RecordModel, rows: np.ndarray) -> np.ndarray:
    """Return the effect (rows, n, inputs) of a change of each input over the intervals after some rows."""
    effects = np.zeros((len(rows), model.filter.n, filter_.d))
    for begin, part, result in filter_.blocks(data, noise, model.initial, np.diag(model.scales**2)):
        here = (rows >= begin) & (rows < begin + len(part.t))
        effects[here] = result.path.G[rows[here] - begin]
    return effects


def start_of(model: RecordModel, data: Rows, noise: Noise) -> Start:
    """Return the state before the first row that fits the first rows best, and its covariance (Gauss–Newton)."""
    part = part_of(data, 0, min(len(data.t), _START_ROWS))
    filter_, n = model.filter, model.filter.n
    x, prior = model.initial.copy(), model.scales**2
    P = np.diag(prior)
    small = np.diag(1e-6 * prior)
    unit = np.diag(model.scales)
    for _ in range(_ROUNDS):
        result = filter_.filter(part, noise, x, small, channels=())
        zeros = np.zeros((n, len(part.t)))
        omega = filter_.responses(part, noise, result.path, np.zeros(n), zeros, zeros, unit) if filter_.d else None
        if omega is None or not np.isfinite(omega).all():
            break
        omega = omega.reshape(n, -1)
        information = omega @ omega.T + np.diag(prior / model.scales**2)
        away = (x - model.initial) / model.scales
        step = solved(information, omega @ np.nan_to_num(result.path.nu).ravel() - away)
        x = x + np.clip(step, -3, 3) * model.scales
        P = unit @ solved(information, np.eye(n)) @ unit
    return Start(x, P)
