"""From the plant's outputs to what observers are given: noise, faults of the measurement itself, sampling with a hold.

Everything is a function of (t, seed) and of what was measured before; what was measured before is ``Memory``, a plain
value that is copied, so that chunking, rewinding and forking never change a number.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.signals import Signal, constant, gated, total
from thetascope.engine.inputs.signals import _random_held as random_held
from thetascope.engine.inputs.time_grid import Grid

ADDITIVE = ("outliers", "noise-burst")
ORDER = {"delay": 0, "stuck": 1, "freeze": 1, "dropout": 1, "quantisation": 2}  # in which a value meets the others
_STAGES = {4: np.array([0.0, 0.5, 0.5, 1.0]), 1: np.zeros(1)}  # where in a step y is wanted


def noise_key(seed: int, output: int) -> tuple[int, int, int]:
    """The stream of an output's noise."""
    return seed, 3, output


def noise(std: float, sample_time: float, seed: int, output: int) -> Signal:
    """Gaussian, held for ``sample_time`` seconds."""
    key = noise_key(seed, output)
    return random_held(sample_time, lambda first, count: std * random_streams.normal(key, first, count))


def _additive(data: Mapping, key: tuple[int, ...]) -> Signal:
    hold = data["sample_time"]
    if data["shape"] == "noise-burst":
        inner = random_held(hold, lambda first, count: data["std"] * random_streams.normal(key, first, count))
    else:

        def spikes(first: int, count: int) -> np.ndarray:
            chance = random_streams.uniform(key, first, count)
            sign = np.where(random_streams.uniform((*key, 1), first, count) < 0.5, -1.0, 1.0)
            return np.where(chance < data["probability"], sign * data["size"], 0.0)

        inner = random_held(hold, spikes)
    return gated(inner, data["onset"], data.get("end"))


def _acting(data: Mapping, key: tuple[int, ...]) -> Signal:
    """1 while a fault acts on what comes through (dropout: by chance), else 0."""
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
    """What the measurement remembers: the last values before faults and the last samples, one an output; and by fault
    (draws.key_of) the last value that it let through or, of a delay, what it is late with, and the last value after it.
    """

    passed: np.ndarray
    sampled: np.ndarray
    faults: Mapping[int, object] = field(default_factory=dict)
    after: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Measurement:
    """The sensor side of an experiment.

    ``faults`` are plain data with ``output`` (name) and ``shape``; ``sample_every``: base steps between samples, or
    None for continuous measurement. ``direct``: nothing but noise is added, so y may be formed inside a kernel.
    """

    outputs: tuple[str, ...]
    std: tuple[float, ...]
    sample_time: tuple[float, ...]
    seed: int
    faults: tuple[Mapping, ...] = ()
    sample_every: int | None = None
    noises: tuple[Signal, ...] = field(init=False)

    def __post_init__(self) -> None:
        made = []
        for i, name in enumerate(self.outputs):
            parts = [noise(self.std[i], self.sample_time[i], self.seed, i)] if self.std[i] > 0 else []
            parts += [
                _additive(f, (self.seed, 5, random_streams.key_of(f)))
                for f in self._mine(name)
                if f["shape"] in ADDITIVE
            ]
            made.append(total(parts) if parts else constant(0.0))
        object.__setattr__(self, "noises", tuple(made))

    def _mine(self, output: str) -> list[Mapping]:
        return [f for f in self.faults if f["output"] == output]

    def _in_turn(self, output: str) -> list[Mapping]:
        return sorted((f for f in self._mine(output) if f["shape"] in ORDER), key=lambda f: ORDER[f["shape"]])

    def _acting(self, f: Mapping) -> Signal:
        return _acting(f, (self.seed, 5, random_streams.key_of(f)))

    @property
    def direct(self) -> bool:
        """Whether y is the clean output plus noise and nothing else."""
        return self.sample_every is None and all(f["shape"] in ADDITIVE for f in self.faults)

    def breaks(self, a: float, b: float, signals: Iterable[Signal] = ()) -> np.ndarray:
        """Where the measurement is discontinuous in (a, b); ``signals`` are those that the plant gets: a delay lets their
        jumps through late.
        """
        parts = [s.breaks(a, b) for s in self.noises]
        parts += [self._acting(f).breaks(a, b) for f in self.faults if f["shape"] in ORDER]
        for f in self.faults:
            if f["shape"] == "delay":
                # and there is a kink where the delay line is full
                late = [s.breaks(a - f["delay"], b - f["delay"]) for s in (*self.noises, *signals, self._acting(f))]
                times = np.concatenate(late) + f["delay"]
                parts.append(times[(times > f["onset"]) & (times < (f.get("end") or np.inf))])
        return np.concatenate(parts) if parts else np.empty(0)

    def start(self) -> Memory:
        """Return what the measurement remembers before the first step: nothing."""
        m = len(self.outputs)
        return Memory(np.full(m, np.nan), np.full(m, np.nan))

    def noise_at(self, anchor: np.ndarray) -> np.ndarray:
        """Additive disturbance of every output: shape (len(anchor), m)."""
        if not self.noises:
            return np.zeros((len(anchor), 0))
        return np.stack([s(anchor, anchor) for s in self.noises], axis=1)

    def measure(self, grid: Grid, first: int, clean: np.ndarray, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Measured outputs of one span: ``clean`` and the answer have shape (steps, stages, m)."""
        y = clean + self.noise_at(grid.anchor)[:, None, :]
        passed = y[-1, -1].copy() if len(y) else memory.passed
        kept, after, sampled = dict(memory.faults), dict(memory.after), memory.sampled
        for i, name in enumerate(self.outputs):
            before = memory.passed[
                i
            ]  # what came out of the fault before in turn: a fault that is new did nothing until now
            for f in self._in_turn(name):
                key = random_streams.key_of(f)
                y[:, :, i], kept[key] = self._through(f, grid, y[:, :, i], kept.get(key), before)
                before = memory.after.get(key, before)
                after[key] = float(y[-1, -1, i]) if len(y) else before
        if self.sample_every is not None:
            y, sampled = _sampled(self.sample_every, grid, first, y, sampled)
        return y, replace(memory, passed=passed, sampled=sampled, faults=kept, after=after)

    def _through(self, f: Mapping, grid: Grid, y: np.ndarray, kept: Any, passed: float) -> tuple[np.ndarray, Any]:
        """One output (steps × stages) through one fault; ``kept`` is what the fault remembers, None at first."""
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


def _sampled(q: int, grid: Grid, first: int, y: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Take the value at the start of every q-th base step and hold it; `y` and the answer: steps × stages × m."""
    count = len(grid.base) - 1
    due = np.arange((-first) % q, count, q)  # base steps, counted within the span, that begin on a sample instant
    at = grid.base[due]
    values = np.vstack([last[None, :], y[at, 0, :]])
    index = np.searchsorted(at, np.arange(len(y)), side="right")
    held = values[index]
    return np.repeat(held[:, None, :], y.shape[1], axis=1), values[-1].copy()


def _hold(lost: np.ndarray, y: np.ndarray, passed: float) -> np.ndarray:
    """Where lost, repeat the last value that came through (the left limit at the moment of loss)."""
    if not lost.any():
        return y
    ends = np.where(lost, -1, np.arange(len(y)))
    last = np.maximum.accumulate(ends)
    # lost from the very first sample on: what is first seen is kept
    before = passed if np.isfinite(passed) else y[0, 0]
    held = np.where(last >= 0, y[np.maximum(last, 0), -1], before)
    return np.where(lost[:, None], held[:, None], y)


def _delayed(delay: float, on: np.ndarray, grid: Grid, y: np.ndarray, past: Any) -> tuple[np.ndarray, Any]:
    """y(t − delay) while the fault is on: the delay line fills from the onset on and shows the first value until then.

    The past is kept as steps (start, end, y at the start, y at the end), linear in between, so that a jump between two
    steps stays one.
    """
    if not on.any():
        return y, past
    now = np.stack([grid.start[on], grid.end[on], y[on, 0], y[on, -1]])
    steps = now if past is None else np.concatenate([past, now], axis=1)
    width = grid.end[on] - grid.start[on]
    at = grid.start[on, None] + _STAGES[y.shape[1]] * width[:, None] - delay
    # a little towards the middle of the present step: right limits at its start, left limits at its end
    inside = at + 1e-4 * (grid.anchor[on, None] - delay - at)
    start, end, first, last = steps[:, np.maximum(np.searchsorted(steps[0], inside, side="right") - 1, 0)]
    late = y.copy()
    late[on] = first + np.clip((at - start) / (end - start), 0.0, 1.0) * (last - first)
    return late, steps[:, steps[1] >= grid.end[on][-1] - delay - width[-1]]
