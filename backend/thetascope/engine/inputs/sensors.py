"""Measurement: noise, measurement faults and sampling with a hold, between the plant's outputs and the observers.

Everything is a function of (t, seed) and of earlier measurements. The latter are held in ``Memory``, an immutable
value, so that splitting, rewinding and forking a run never change a number.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.coloured_noise import coloured_noise
from thetascope.engine.inputs.input_tables import RUNGE_KUTTA
from thetascope.engine.inputs.readings import Readings
from thetascope.engine.inputs.sampling import Sampling
from thetascope.engine.inputs.signals import Signal, constant, gated, total
from thetascope.engine.inputs.signals import _random_held as random_held
from thetascope.engine.inputs.time_grid import Grid

ADDITIVE = ("outliers", "noise-burst")
# Order in which these faults act on a value.
ORDER = {"delay": 0, "stuck": 1, "freeze": 1, "dropout": 1, "quantisation": 2}
# by number of stages: their places within a step
_STAGES = {len(places): np.array(places) for places in ((0.0,), RUNGE_KUTTA, implicit_method.C)}


def noise_key(seed: int, output: int) -> tuple[int, int, int]:
    """Return the key of the stream of an output's noise."""
    return seed, 3, output


def noise(std: float, sample_time: float, seed: int, output: int, correlation: float | None = None) -> Signal:
    """Return Gaussian noise; each value is held for ``sample_time`` seconds.

    ``correlation``: its correlation time in s; None: values are independent.
    """
    key = noise_key(seed, output)
    if correlation is not None:
        return coloured_noise(std, sample_time, correlation, key)
    return random_held(sample_time, lambda first, count: std * random_streams.normal(key, first, count))


def _additive(data: Mapping, key: tuple[int, ...]) -> Signal:
    """Return the disturbance that an additive fault (outliers, noise burst) adds to the output."""
    hold = data["sample_time"]
    if data["shape"] == "noise-burst":
        inner = random_held(hold, lambda first, count: data["std"] * random_streams.normal(key, first, count))
    else:

        def spikes(first: int, count: int) -> np.ndarray:
            """Return the displacements of samples first … first+count−1, mostly 0."""
            chance = random_streams.uniform(key, first, count)
            sign = np.where(random_streams.uniform((*key, 1), first, count) < 0.5, -1.0, 1.0)
            return np.where(chance < data["probability"], sign * data["size"], 0.0)

        inner = random_held(hold, spikes)
    return gated(inner, data["onset"], data.get("end"))


def _acting(data: Mapping, key: tuple[int, ...]) -> Signal:
    """Return the signal that is 1 while a fault acts on the output (dropout: at random), otherwise 0."""
    if data["shape"] == "dropout":
        chance = data["probability"]
        inner = random_held(
            data["sample_time"], lambda first, count: (random_streams.uniform(key, first, count) < chance).astype(float)
        )
    else:
        inner = constant(1.0)
    return gated(inner, data["onset"], data.get("end"))


@dataclass(frozen=True)
class Memory:
    """State of the measurement.

    ``passed``: last value of each output before its faults. ``sampled``: last sample of each output; NaN if none.
    ``faults``: state of each fault by `random_streams.key_of`: the last value that was not lost, or of a delay its
    delay line. ``after``: last value of the output after each fault.
    """

    passed: np.ndarray
    sampled: np.ndarray
    faults: Mapping[int, object] = field(default_factory=dict)
    after: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Measurement:
    """Measurement of an experiment's outputs.

    ``std`` and ``sample_time`` are those of each output's noise. ``faults`` are plain data with ``output`` (name) and
    ``shape``. ``sample_every`` is the number of base steps between samples, None for continuous measurement. ``noises``
    are the additive disturbances of each output: noise, outliers and noise bursts. ``correlation`` and ``samplings``
    are those of the true sensors, where they differ: the correlation time of the noise in s, and sample instants of
    their own; empty: no sensor differs. ``readings`` are those of a record in place of noise; they are added to outputs
    that are zero.
    """

    outputs: tuple[str, ...]
    std: tuple[float, ...]
    sample_time: tuple[float, ...]
    seed: int
    faults: tuple[Mapping, ...] = ()
    sample_every: int | None = None
    correlation: tuple[float | None, ...] = ()
    samplings: tuple[Sampling | None, ...] = ()
    readings: Readings | None = None
    noises: tuple[Signal, ...] = field(init=False)

    def __post_init__(self) -> None:
        if self.readings is not None:
            object.__setattr__(self, "noises", self.readings.held)
            return
        noises = []
        colour = self.correlation or (None,) * len(self.outputs)
        for i, name in enumerate(self.outputs):
            parts = [noise(self.std[i], self.sample_time[i], self.seed, i, colour[i])] if self.std[i] > 0 else []
            parts += [
                _additive(f, (self.seed, 5, random_streams.key_of(f)))
                for f in self._of_output(name)
                if f["shape"] in ADDITIVE
            ]
            noises.append(total(parts) if parts else constant(0.0))
        object.__setattr__(self, "noises", tuple(noises))

    def _of_output(self, output: str) -> list[Mapping]:
        """Return the faults of one output."""
        return [f for f in self.faults if f["output"] == output]

    def _in_turn(self, output: str) -> list[Mapping]:
        """Return the faults of one output that are not additive, in the order in which they act."""
        return sorted((f for f in self._of_output(output) if f["shape"] in ORDER), key=lambda f: ORDER[f["shape"]])

    def _acting(self, f: Mapping) -> Signal:
        return _acting(f, (self.seed, 5, random_streams.key_of(f)))

    @property
    def direct(self) -> bool:
        """Return whether y is the clean output plus noise, so that a kernel can compute it."""
        return not any(self.sampled_by) and all(f["shape"] in ADDITIVE for f in self.faults)

    @property
    def sampled_by(self) -> tuple[Sampling | None, ...]:
        """Return the sample instants of each output; None: continuous measurement."""
        usual = None if self.sample_every is None else Sampling(self.sample_every)
        own = self.samplings or (None,) * len(self.outputs)
        return tuple(usual if sampling is None else self._seeded(sampling, i) for i, sampling in enumerate(own))

    def _seeded(self, sampling: Sampling, output: int) -> Sampling:
        return replace(sampling, key=(self.seed, 9, output))

    @property
    def modelled(self) -> "Measurement":
        """Return the measurement as observers and the detector know it: white noise, samples at regular instants."""
        if not self.correlation and not self.samplings and self.readings is None:
            return self
        return replace(
            self,
            readings=None,
            correlation=(),
            samplings=tuple(None if s is None else s.regular for s in self.samplings),
        )

    def fresh(self, index: np.ndarray, every: int) -> np.ndarray:
        """Return (rows, m): 1 where a row has a value of the output that the row before lacks; rows are the base steps
        ``index``, ``every`` apart."""
        rows = [np.ones(len(index)) if s is None else s.fresh(index, every) for s in self.sampled_by]
        return np.stack(rows, axis=1) if rows else np.ones((len(index), 0))

    def breaks(self, a: float, b: float, signals: Iterable[Signal] = ()) -> np.ndarray:
        """Return the times in (a, b) at which the measurement is discontinuous.

        ``signals`` are the inputs of the plant, whose jumps a delay postpones.
        """
        parts = [s.breaks(a, b) for s in self.noises]
        parts += [self._acting(f).breaks(a, b) for f in self.faults if f["shape"] in ORDER]
        for f in self.faults:
            if f["shape"] == "delay":
                # there is also a kink where the delay line is full
                late = [s.breaks(a - f["delay"], b - f["delay"]) for s in (*self.noises, *signals, self._acting(f))]
                times = np.concatenate(late) + f["delay"]
                parts.append(times[(times > f["onset"]) & (times < (f.get("end") or np.inf))])
        return np.concatenate(parts) if parts else np.empty(0)

    def start(self) -> Memory:
        """Return the state before the first step."""
        m = len(self.outputs)
        return Memory(np.full(m, np.nan), np.full(m, np.nan))

    def noise_at(self, anchor: np.ndarray) -> np.ndarray:
        """Return the additive disturbance of every output at the times ``anchor``: shape (len(anchor), m)."""
        if not self.noises:
            return np.zeros((len(anchor), 0))
        return np.stack([s(anchor, anchor) for s in self.noises], axis=1)

    def measure(self, grid: Grid, first: int, clean: np.ndarray, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return the measured outputs of one span, and the state after it.

        Args:
            grid: the steps of the span.
            first: number of the base step with which it begins.
            clean: outputs of the plant, shape (steps, stages, m), as the result.
            memory: the state before the span.
        """
        y, memory = self.after_faults(grid, clean + self.noise_at(grid.anchor)[:, None, :], memory)
        if any(self.sampled_by):
            y, sampled = _sampled(self.sampled_by, grid, first, y, memory.sampled)
            memory = replace(memory, sampled=sampled)
        return y, memory

    def after_faults(self, grid: Grid, y: np.ndarray, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return noisy outputs of one span (steps × stages × m, overwritten) after the faults, and the state after."""
        passed = y[-1, -1].copy() if len(y) else memory.passed
        kept, after = dict(memory.faults), dict(memory.after)
        for i, name in enumerate(self.outputs):
            # the value after the fault before; a fault that is new has changed nothing until now
            before = memory.passed[i]
            for f in self._in_turn(name):
                key = random_streams.key_of(f)
                y[:, :, i], kept[key] = self._through(f, grid, y[:, :, i], kept.get(key), before)
                before = memory.after.get(key, before)
                after[key] = float(y[-1, -1, i]) if len(y) else before
        return y, replace(memory, passed=passed, faults=kept, after=after)

    def replaced(self, grid: Grid) -> np.ndarray:
        """Return where a fault replaces the reading by a constant or an earlier one, (steps, m)."""
        on = np.zeros((grid.count, len(self.outputs)), dtype=bool)
        for i, name in enumerate(self.outputs):
            for f in self._in_turn(name):
                if f["shape"] != "quantisation":
                    on[:, i] |= self._acting(f)(grid.anchor, grid.anchor) > 0
        return on

    def resolutions(self, least: int = 1) -> list[list[Signal]]:
        """Return the steps of quantisation of each output as signals, 0 while none acts; as many for each output."""
        each = [[f for f in self._in_turn(name) if f["shape"] == "quantisation"] for name in self.outputs]
        most = max([least, *(len(faults) for faults in each)])
        signals = [[gated(constant(f["resolution"]), f["onset"], f.get("end")) for f in faults] for faults in each]
        return [own + [constant(0.0)] * (most - len(own)) for own in signals]

    def _through(self, f: Mapping, grid: Grid, y: np.ndarray, kept: Any, passed: float) -> tuple[np.ndarray, Any]:
        """Return one output (steps × stages) after one fault, and the fault's state.

        ``kept`` is the fault's state before the span, None at first; ``passed`` the last value of the output before it.
        """
        on = self._acting(f)(grid.anchor, grid.anchor) > 0
        match f["shape"]:
            case "delay":
                return _delayed(f["delay"], on, grid, y, kept)
            case "stuck":
                return np.where(on[:, None], f["value"], y), None
            case "quantisation":
                return np.where(on[:, None], np.rint(y / f["resolution"]) * f["resolution"], y), None
        y = _hold(on, y, passed if kept is None else kept)
        return y, float(y[-1, -1]) if len(y) else kept


def _sampled(
    samplings: Sequence[Sampling | None], grid: Grid, first: int, y: np.ndarray, last: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return y (steps × stages × m) with sampled outputs held between samples, and the last sample of each output."""
    y, latest = y.copy(), last.copy()
    steps = np.arange(len(y))
    for i, sampling in enumerate(samplings):
        if sampling is None:
            continue
        at = grid.base[sampling.taken(first, first + len(grid.base) - 1) - first]
        before = y[:1, 0, i] if np.isnan(last[i]) else last[i : i + 1]  # its first value, where sampling begins later
        values = np.concatenate([before, y[at, 0, i]])
        y[:, :, i] = values[np.searchsorted(at, steps, side="right")][:, None]
        latest[i] = values[-1]
    return y, latest


def _hold(lost: np.ndarray, y: np.ndarray, passed: float) -> np.ndarray:
    """Return y with lost values replaced by the last one before the loss (the left limit)."""
    if not lost.any():
        return y
    ends = np.where(lost, -1, np.arange(len(y)))
    last = np.maximum.accumulate(ends)
    # if the first sample is lost and there is no earlier one, its own value is held
    before = passed if np.isfinite(passed) else y[0, 0]
    held = np.where(last >= 0, y[np.maximum(last, 0), -1], before)
    return np.where(lost[:, None], held[:, None], y)


def _delayed(delay: float, on: np.ndarray, grid: Grid, y: np.ndarray, past: Any) -> tuple[np.ndarray, Any]:
    """Return y(t − delay) while the fault is on, and the delay line.

    The delay line fills from the onset on; until it is full, the output is its first value. It holds steps (start, end,
    y at the start, y at the end), linear in between, so that a jump between two steps stays a jump.
    """
    if not on.any():
        return y, past
    current = np.stack([grid.start[on], grid.end[on], y[on, 0], y[on, -1]])
    steps = current if past is None else np.concatenate([past, current], axis=1)
    width = grid.end[on] - grid.start[on]
    at = grid.start[on, None] + _STAGES[y.shape[1]] * width[:, None] - delay
    # shifted slightly towards the middle of the current step: right limits at its start, left limits at its end
    inside = at + 1e-4 * (grid.anchor[on, None] - delay - at)
    start, end, first, last = steps[:, np.maximum(np.searchsorted(steps[0], inside, side="right") - 1, 0)]
    late = y.copy()
    late[on] = first + np.clip((at - start) / (end - start), 0.0, 1.0) * (last - first)
    return late, steps[:, steps[1] >= grid.end[on][-1] - delay - width[-1]]
