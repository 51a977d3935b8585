"""Time functions: inputs u, known signals φ, fault sizes θ.

A signal is evaluated as ``signal(t, anchor)``: the value at t of the piece that is active at ``anchor``, both in s. If
the anchor is inside a step, the value at the step's start is the right limit and that at its end the left limit. So a
step never reaches across a discontinuity, whatever the rounding of a switching time.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.engine.inputs import random_streams
from thetascope.engine.programs.program_store import time_program

_FAR = 10**7  # maximum number of switching times in one span
_RESOLVED = 2.0**52  # periods after the start from which on double precision has no switching times


@dataclass(frozen=True)
class Signal:
    """A time function.

    ``value(t, anchor)``: see the module. ``breaks(a, b)``: its discontinuities (of value or slope) in (a, b), in s.
    ``held``: whether it is piecewise constant. ``level``: its value if it is constant at all times, else None.
    """

    value: Callable[[np.ndarray, np.ndarray], np.ndarray]
    breaks: Callable[[float, float], np.ndarray]
    held: bool
    level: float | None = None

    def __call__(self, t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """Return the values at t (s) of the pieces that are active at anchor (s); all arrays have the same shape."""
        return self.value(np.asarray(t, dtype=float), np.asarray(anchor, dtype=float))


def _within(times: np.ndarray, a: float, b: float) -> np.ndarray:
    """Return the times in (a, b)."""
    return times[(times > a) & (times < b)]


def _no_breaks(a: float, b: float) -> np.ndarray:
    return np.empty(0)


def constant(value: float) -> Signal:
    """Return the signal that has the same value at all times."""
    return Signal(lambda t, anchor: np.full(anchor.shape, float(value)), _no_breaks, True, float(value))


def steps(times: list[float], values: list[float]) -> Signal:
    """Return the signal that is values[0] before times[0] and values[i] from times[i−1] on."""
    edges, levels = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    return Signal(
        lambda t, anchor: levels[np.searchsorted(edges, anchor, side="right")], lambda a, b: _within(edges, a, b), True
    )


def _every(start: float, period: float, a: float, b: float) -> np.ndarray:
    """Return all start + k·period in (a, b), k ≥ 0. Raises ValueError if there are more than 10⁷."""
    if b <= start or a - start > _RESOLVED * period:
        return np.empty(0)
    first, last = max(0, int(np.ceil((a - start) / period))), int(np.floor((b - start) / period))
    if last - first > _FAR:
        raise ValueError(f"a signal of period {period:g} s switches more than {_FAR} times")
    return _within(start + period * np.arange(first, last + 1), a, b)


def pulse(low: float, high: float, period: float, width: float, start: float = 0.0) -> Signal:
    """Return the signal that is high on [start + k·period, start + k·period + width), k ≥ 0, and low elsewhere."""

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        phase = np.mod(anchor - start, period)
        return np.where((anchor >= start) & (phase < width), float(high), float(low))

    def breaks(a: float, b: float) -> np.ndarray:
        return np.concatenate([_every(start, period, a, b), _every(start + width, period, a, b)])

    return Signal(value, breaks, True)


def square(amplitude: float, period: float, start: float = 0.0, offset: float = 0.0) -> Signal:
    """Return offset + amplitude on [start + k·period, start + (k + ½)·period), otherwise offset − amplitude."""
    half = 0.5 * period
    first = -np.mod(-start, half)  # the last jump at or before t = 0

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        upper = np.mod(np.floor((anchor - start) / half), 2.0) == 0.0
        return np.where(upper, offset + amplitude, offset - amplitude)

    return Signal(value, lambda a, b: _every(first, half, a, b), True)


def sine(amplitude: float, frequency: float, phase: float = 0.0, offset: float = 0.0) -> Signal:
    """Return offset + amplitude · sin(2π·frequency·t + phase); frequency in Hz, phase in rad."""
    return Signal(lambda t, anchor: offset + amplitude * np.sin(2 * np.pi * frequency * t + phase), _no_breaks, False)


def ramp(start: float, slope: float, initial: float = 0.0, end: float | None = None) -> Signal:
    """Return a ramp: initial until start, then rising by slope per second until end (None: never), then constant."""
    stop = np.inf if end is None else end
    edges = np.array([start] if end is None else [start, end])

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        run = np.where(anchor < start, 0.0, np.where(anchor > stop, stop - start, t - start))
        return initial + slope * run

    return Signal(value, lambda a, b: _within(edges, a, b), False)


def chirp(amplitude: float, f0: float, f1: float, duration: float, offset: float = 0.0, start: float = 0.0) -> Signal:
    """Return a sine whose frequency changes linearly from f0 to f1 (Hz) in ``duration`` seconds from ``start`` on.

    Before ``start`` (s) the frequency is f0, afterwards it stays f1.
    """
    end = start + duration

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        run = t - start
        sweeping = f0 * run + (f1 - f0) / (2 * duration) * run**2
        swept = 0.5 * (f0 + f1) * duration + f1 * (run - duration)
        cycles = np.where(anchor < start, f0 * run, np.where(anchor < end, sweeping, swept))
        return offset + amplitude * np.sin(2 * np.pi * cycles)

    return Signal(value, lambda a, b: _within(np.array([start, end]), a, b), False)


def prbs(low: float, high: float, hold: float, seed: int = 0, order: int | None = None) -> Signal:
    """Return a pseudo-random binary sequence, held for ``hold`` seconds: low or high with equal probability.

    With an order it is a maximum-length sequence, of which ``seed`` is the place at t = 0.
    """
    if order is None:
        return _random_held(
            hold, lambda first, count: np.where(random_streams.uniform((seed, 7), first, count) < 0.5, low, high)
        )
    bits = _maximum_length(order)

    def level(first: int, count: int) -> np.ndarray:
        return np.where(bits[(np.arange(first, first + count) + seed) % len(bits)], high, low)

    return _random_held(hold, level)


_TAPS = {
    2: (1,),
    3: (2,),
    4: (3,),
    5: (3,),
    6: (5,),
    7: (6,),
    8: (7, 6, 1),
    9: (5,),
    10: (7,),
    11: (9,),
    12: (11, 10, 4),
    13: (12, 11, 8),
    14: (13, 12, 2),
    15: (14,),
    16: (15, 13, 4),
}
"""Taps of shift registers of maximum length: bit k + n is the sum modulo 2 of bit k and the bits k + tap."""


@lru_cache(maxsize=4)
def _maximum_length(order: int) -> np.ndarray:
    """Return one period of the maximum-length sequence of an order n as booleans (2^n − 1,); it begins with n ones."""
    bits = [1] * order
    for k in range(2**order - 1 - order):
        bit = bits[k]
        for tap in _TAPS[order]:
            bit ^= bits[k + tap]
        bits.append(bit)
    return np.array(bits, dtype=bool)


def noise(std: float, hold: float, seed: int = 0, offset: float = 0.0) -> Signal:
    """Return Gaussian noise around ``offset``, a new draw every ``hold`` seconds."""
    return _random_held(hold, lambda first, count: offset + std * random_streams.normal((seed, 13), first, count))


def _random_held(hold: float, level: Callable[[int, int], np.ndarray], start: float = 0.0) -> Signal:
    """Return a held signal, 0 before start.

    On [start + j·hold, start + (j+1)·hold) it is level j; ``level(first, count)`` returns levels first … first+count−1.
    """

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        if not anchor.size:
            return np.zeros(anchor.shape)
        index = np.floor((anchor - start) / hold).astype(np.int64)
        first = max(0, int(index.min()))
        count = int(index.max()) - first + 1
        if count <= 0:
            return np.zeros(anchor.shape)
        levels = level(first, count)
        return np.where(index < 0, 0.0, levels[np.clip(index - first, 0, count - 1)])

    return Signal(value, lambda a, b: _every(start, hold, a, b), True)


def table(times: list[float], values: list[float], interpolation: str = "hold") -> Signal:
    """Return the signal with the given values at the given times (s), held or linear in between, constant outside."""
    edges, levels = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if interpolation == "hold":
        return steps(list(edges[1:]), list(levels))

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        if len(edges) == 1:
            return np.full(anchor.shape, levels[0])
        piece = np.clip(np.searchsorted(edges, anchor, side="right") - 1, 0, len(edges) - 2)
        a, b = edges[piece], edges[piece + 1]
        fraction = np.clip((t - a) / (b - a), 0.0, 1.0)
        return levels[piece] + fraction * (levels[piece + 1] - levels[piece])

    return Signal(value, lambda a, b: _within(edges, a, b), False)


def expression(text: str) -> Signal:
    """Return the smooth function of t (s) in the text. Raises ExpressionError."""
    program = time_program(text)

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        return np.broadcast_to(program.evaluate(["value"], {"t": t})[0], t.shape).astype(float)

    return Signal(value, _no_breaks, False)


_KINDS = {
    "constant": constant,
    "steps": steps,
    "pulse": pulse,
    "square": square,
    "sine": sine,
    "ramp": ramp,
    "chirp": chirp,
    "prbs": prbs,
    "noise": noise,
    "table": table,
    "expression": expression,
}


def signal(data: Mapping) -> Signal:
    """Return a signal from its plain data: ``kind``, and the arguments of the function of that name."""
    arguments = dict(data)
    return _KINDS[arguments.pop("kind")](**arguments)


def total(parts: list[Signal]) -> Signal:
    """Return the sum of signals."""
    if len(parts) == 1:
        return parts[0]

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        result = np.zeros(anchor.shape)
        for part in parts:
            result = result + part(t, anchor)
        return result

    def breaks(a: float, b: float) -> np.ndarray:
        return np.concatenate([p.breaks(a, b) for p in parts]) if parts else np.empty(0)

    return Signal(value, breaks, all(p.held for p in parts))


def gated(inner: Signal, onset: float, end: float | None) -> Signal:
    """Return ``inner`` with its time counted from onset; zero before onset and from end on (None: never)."""
    stop = np.inf if end is None else end
    edges = np.array([onset] if end is None else [onset, end])

    def value(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        on = (anchor >= onset) & (anchor < stop)
        return np.where(on, inner(t - onset, anchor - onset) if inner.level is None else inner.level, 0.0)

    def breaks(a: float, b: float) -> np.ndarray:
        if inner.level is not None:
            return _within(edges, a, b)
        low, high = max(a, onset), min(b, stop)
        own = inner.breaks(low - onset, high - onset) + onset if high > low else np.empty(0)
        return np.concatenate([_within(edges, a, b), _within(own, a, b)])

    return Signal(value, breaks, inner.held)
