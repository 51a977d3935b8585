"""Faults inside the model: the true θ(t) of each channel as a signal. τ is the time since the onset in s."""

from collections.abc import Mapping, Sequence

import numpy as np

from thetascope.engine.inputs import random_streams, signals
from thetascope.engine.inputs.signals import Signal


def step(size: float) -> Signal:
    """Return the signal that is ``size`` from the onset on, in the channel's unit."""
    return signals.constant(size)


def ramp(size: float, duration: float) -> Signal:
    """Return the signal that rises linearly to ``size`` over ``duration`` seconds and then stays constant."""
    return signals.ramp(0.0, size / duration, 0.0, duration)


def drift(rate: float) -> Signal:
    """Return ``rate``·τ, with the rate per second."""
    return signals.ramp(0.0, rate)


def exponential(size: float, time_constant: float) -> Signal:
    """Return size · (1 − exp(−τ/time_constant)), an incipient fault; ``time_constant`` in s."""
    return Signal(lambda t, anchor: -size * np.expm1(-t / time_constant), lambda a, b: np.empty(0), False)


def sine(size: float, frequency: float, phase: float = 0.0) -> Signal:
    """Return size · sin(2π · frequency · τ + phase); frequency in Hz, phase in rad."""
    return signals.sine(size, frequency, phase)


def pulse_train(size: float, period: float, width: float) -> Signal:
    """Return an intermittent fault: ``size`` in the first ``width`` seconds of every period (s), otherwise 0."""
    return signals.pulse(0.0, size, period, width)


def random_walk(intensity: float, sample_time: float, key: tuple[int, ...]) -> Signal:
    """Return a random walk with standard deviation intensity·√τ and one increment every ``sample_time`` seconds.

    ``key`` is that of its stream of random numbers.
    """
    scale = intensity * np.sqrt(sample_time)

    def level(first: int, count: int) -> np.ndarray:
        """Return the levels first … first+count−1."""
        # always summed from the first increment, so that a level does not depend on where a chunk begins
        return np.cumsum(scale * random_streams.normal(key, 0, first + count))[first:]

    return signals._random_held(sample_time, level)


_SHAPES = {
    "step": step,
    "ramp": ramp,
    "drift": drift,
    "exponential": exponential,
    "sine": sine,
    "pulse-train": pulse_train,
    "table": signals.table,
}


RANDOM = "random-walk"
"""The shape that depends on the seed."""


def fault(data: Mapping, key: tuple[int, ...]) -> Signal:
    """Return θ(t) of one fault from its plain data; ``key`` is that of the random shapes' stream."""
    arguments = {k: v for k, v in data.items() if k not in ("channel", "shape", "onset", "end")}
    shape = data["shape"]
    inner = random_walk(**arguments, key=key) if shape == RANDOM else _SHAPES[shape](**arguments)
    return signals.gated(inner, data["onset"], data.get("end"))


def theta(channel: str, faults: Sequence[Mapping], seed: int) -> Signal:
    """Return the true θ(t) of a channel, the sum of its faults; ``faults`` may contain those of other channels."""
    mine = [fault(f, (seed, 11, random_streams.key_of(f))) for f in faults if f.get("channel") == channel]
    return signals.total(mine) if mine else signals.constant(0.0)
