"""Stationary noise with memory, and process noise, with random access: value j is a function of (key, j) alone.

Coloured noise is the autoregressive process n(j) = a·n(j−1) + √(1 − a²)·w(j) of variance one. It is built in blocks of
BLOCK values. The values at the beginnings of blocks form an autoregressive process of their own (a^BLOCK), summed over
as many earlier blocks as matter in double precision. Inside a block a free path from its first value is bent so that it
ends in the first value of the next block: the exact conditional distribution of a Gaussian Markov process (Rue & Held,
Gaussian Markov Random Fields, 2005, §2.3).
"""

from functools import lru_cache

import numpy as np

from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.inputs.signals import _random_held as random_held

BLOCK = 1024
_FORGOTTEN = 40.0  # e^−40 is below the resolution of doubles


def coloured(key: tuple[int, ...], decay: float, first: int, count: int) -> np.ndarray:
    """Return values first … first+count−1 of coloured noise of variance one; ``decay``: −ln a, of one value."""
    blocks = range(first // BLOCK, -(-(first + count) // BLOCK))
    parts = [_block(key, decay, b) for b in blocks]
    together = np.concatenate(parts) if parts else np.empty(0)
    begin = first - first // BLOCK * BLOCK
    return together[begin : begin + count].copy()


@lru_cache(maxsize=256)
def _block(key: tuple[int, ...], decay: float, block: int) -> np.ndarray:
    """Return the values of a block."""
    from scipy.signal import lfilter

    start, end = _beginnings(key, decay, block)
    places = np.arange(BLOCK + 1)
    draws = random_streams.normal((*key, 1), block * BLOCK, BLOCK)
    shocks = np.concatenate([[start], np.sqrt(-np.expm1(-2 * decay)) * draws])
    free = lfilter([1.0], [1.0, -np.exp(-decay)], shocks)
    # Cov(free j, free BLOCK) / Var(free BLOCK), given the first value
    share = np.exp(-decay * (BLOCK - places)) * np.expm1(-2 * decay * places) / np.expm1(-2 * decay * BLOCK)
    values = (free + share * (end - free[-1]))[:BLOCK]
    values.flags.writeable = False
    return values


def _beginnings(key: tuple[int, ...], decay: float, block: int) -> tuple[float, float]:
    """Return the first value of a block and that of the next."""
    rate = decay * BLOCK
    count = int(np.ceil(_FORGOTTEN / rate)) + 1
    draws = random_streams.normal((*key, 2), block - count + 1, count + 1)  # of blocks up to the next one
    weights = np.exp(-rate * np.arange(count)[::-1]) * np.sqrt(-np.expm1(-2 * rate))
    return float(weights @ draws[:-1]), float(weights @ draws[1:])


def coloured_noise(std: float, sample_time: float, correlation: float, key: tuple[int, ...]) -> Signal:
    """Return coloured noise of a standard deviation; each value is held for ``sample_time`` seconds.

    ``correlation``: time in s over which the autocorrelation falls to 1/e.
    """
    decay = sample_time / correlation
    return random_held(sample_time, lambda first, count: std * coloured(key, decay, first, count))


def process_noise(std: float, step: float, key: tuple[int, ...]) -> Signal:
    """Return white noise of intensity std² that is constant over each base step: std/√step · w.

    Its integral over base steps is a Wiener process of standard deviation std·√t at their ends.
    """
    size = std / np.sqrt(step)
    return random_held(step, lambda first, count: size * random_streams.normal(key, first, count))
