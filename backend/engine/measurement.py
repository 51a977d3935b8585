"""From the plant's outputs to what observers are given: noise, faults of the measurement itself, sampling with a hold.

Everything is a function of (t, seed) and of what was measured before; what was measured before is ``Memory``, a plain
value that is copied, so that chunking, rewinding and forking never change a number.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from backend.engine import draws
from backend.engine.grid import Grid
from backend.engine.signals import Signal, constant, gated, pulse, total  # noqa: F401  (constant is part of the shapes below)
from backend.engine.signals import _random_held as random_held

ADDITIVE = ("outliers", "noise-burst")


def noise_key(seed: int, output: int) -> tuple[int, int, int]:
    """The stream of an output's noise."""
    return seed, 3, output


def noise(std: float, sample_time: float, seed: int, output: int) -> Signal:
    """Gaussian, held for ``sample_time`` seconds."""
    key = noise_key(seed, output)
    return random_held(sample_time, lambda first, count: std * draws.normal(key, first, count))


def _additive(data: Mapping, key: tuple[int, ...]) -> Signal:
    hold = data["sample_time"]
    if data["shape"] == "noise-burst":
        inner = random_held(hold, lambda first, count: data["std"] * draws.normal(key, first, count))
    else:

        def spikes(first: int, count: int) -> np.ndarray:
            chance = draws.uniform(key, first, count)
            sign = np.where(draws.uniform((*key, 1), first, count) < 0.5, -1.0, 1.0)
            return np.where(chance < data["probability"], sign * data["size"], 0.0)

        inner = random_held(hold, spikes)
    return gated(inner, data["onset"], data.get("end"))


def _lost(data: Mapping, key: tuple[int, ...]) -> Signal:
    """1 while nothing new comes through (freeze, stuck: always; dropout: by chance), else 0."""
    if data["shape"] == "dropout":
        chance = data["probability"]
        inner = random_held(
            data["sample_time"], lambda first, count: (draws.uniform(key, first, count) < chance).astype(float)
        )
    else:
        inner = constant(1.0)
    return gated(inner, data["onset"], data.get("end"))


@dataclass(frozen=True)
class Memory:
    """What the measurement remembers, per output: the last value passed on, the last sample, past values for delays."""

    passed: np.ndarray
    sampled: np.ndarray
    history: tuple[tuple[np.ndarray, np.ndarray], ...] = ()


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
            parts += [_additive(f, (self.seed, 5, draws.key_of(f))) for f in self._mine(name) if f["shape"] in ADDITIVE]
            made.append(total(parts) if parts else constant(0.0))
        object.__setattr__(self, "noises", tuple(made))

    def _mine(self, output: str) -> list[Mapping]:
        return [f for f in self.faults if f["output"] == output]

    def _lost(self, f: Mapping) -> Signal:
        return _lost(f, (self.seed, 5, draws.key_of(f)))

    @property
    def direct(self) -> bool:
        return self.sample_every is None and all(f["shape"] in ADDITIVE for f in self.faults)

    def breaks(self, a: float, b: float) -> np.ndarray:
        """Where the measurement is discontinuous in (a, b)."""
        parts = [s.breaks(a, b) for s in self.noises]
        parts += [self._lost(f).breaks(a, b) for f in self.faults if f["shape"] not in ADDITIVE]
        return np.concatenate(parts) if parts else np.empty(0)

    def start(self) -> Memory:
        m = len(self.outputs)
        return Memory(np.full(m, np.nan), np.full(m, np.nan), tuple((np.empty(0), np.empty(0)) for _ in range(m)))

    def noise_at(self, anchor: np.ndarray) -> np.ndarray:
        """Additive disturbance of every output: shape (len(anchor), m)."""
        if not self.noises:
            return np.zeros((len(anchor), 0))
        return np.stack([s(anchor, anchor) for s in self.noises], axis=1)

    def measure(self, grid: Grid, first: int, clean: np.ndarray, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Measured outputs of one span: ``clean`` and the answer have shape (steps, stages, m)."""
        y = clean + self.noise_at(grid.anchor)[:, None, :]
        passed, sampled, history = memory.passed.copy(), memory.sampled.copy(), list(memory.history)
        for i, name in enumerate(self.outputs):
            mine = [f for f in self._mine(name) if f["shape"] not in ADDITIVE]
            if mine:
                y[:, :, i], passed[i], history[i] = self._faulty(mine, grid, y[:, :, i], passed[i], history[i])
            elif len(y):
                passed[i] = y[-1, -1, i]
        if self.sample_every is not None:
            y, sampled = self._sampled(grid, first, y, sampled)
        return y, replace(memory, passed=passed, sampled=sampled, history=tuple(history))

    def _faulty(self, mine, grid: Grid, y: np.ndarray, passed: float, history):
        """Delay, then loss (stuck, freeze, dropout), then quantisation: the order in which a signal meets them."""
        for f in mine:
            if f["shape"] == "delay":
                y, history = _delayed(f, grid, y, history)
        for f in mine:
            if f["shape"] in ("stuck", "freeze", "dropout"):
                lost = self._lost(f)(grid.anchor, grid.anchor) > 0
                y = np.where(lost[:, None], f["value"], y) if f["shape"] == "stuck" else _hold(lost, y, passed)
        for f in mine:
            if f["shape"] == "quantisation":
                on = gated(constant(1.0), f["onset"], f.get("end"))(grid.anchor, grid.anchor) > 0
                y = np.where(on[:, None], np.rint(y / f["resolution"]) * f["resolution"], y)
        return y, (y[-1, -1] if len(y) else passed), history

    def _sampled(self, grid: Grid, first: int, y: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Take the value at the start of every sampled base step and hold it."""
        q = self.sample_every
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


def _delayed(f: Mapping, grid: Grid, y: np.ndarray, history):
    """y(t − delay) while the fault is on: the delay line fills from the onset on and shows the first value until then.

    Linear between the ends of steps. Only what was measured since the onset is needed.
    """
    on = gated(constant(1.0), f["onset"], f.get("end"))(grid.anchor, grid.anchor) > 0
    if not on.any():
        return y, history
    times, ends = np.empty(2 * int(on.sum())), np.empty(2 * int(on.sum()))
    times[0::2], times[1::2] = grid.start[on], grid.end[on]
    ends[0::2], ends[1::2] = y[on, 0], y[on, -1]
    all_times, all_values = np.concatenate([history[0], times]), np.concatenate([history[1], ends])
    fractions = np.array([0.0, 0.5, 0.5, 1.0]) if y.shape[1] == 4 else np.zeros(y.shape[1])
    at = grid.start[on, None] + fractions * (grid.end - grid.start)[on, None] - f["delay"]
    late = y.copy()
    late[on] = np.interp(at, all_times, all_values)
    first = max(0, int(np.searchsorted(all_times, grid.end[-1] - f["delay"])) - 2)
    return late, (all_times[first:], all_values[first:])
