"""Reproducible random numbers with random access: draw j of a stream is a function of (key, j) alone.

So a run may be cut into chunks, rewound or forked without carrying a generator along, and the numbers stay the same.
A stream is a PCG64 sequence; its block b begins 2⁶⁴·b draws further on, so blocks never overlap.
"""

import json
import threading
import zlib
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

BLOCK = 2048
_APART = 1 << 64
_own = threading.local()  # one generator a thread, set to the state that is wanted: making one costs more than drawing


@lru_cache(maxsize=8192)
def _origin(key: tuple[int, ...]) -> dict:
    """The state from which the stream of a key begins."""
    return np.random.PCG64(np.random.SeedSequence(list(key))).state


def _fill(kind: str, key: tuple[int, ...], block: int, out: np.ndarray) -> None:
    if not hasattr(_own, "bits"):
        _own.bits = np.random.PCG64(0)
        _own.generator = np.random.Generator(_own.bits)
    _own.bits.state = _origin(key)
    if block:
        _own.bits.advance(block * _APART)
    draw = _own.generator.standard_normal if kind == "normal" else _own.generator.random
    draw(out=out)


@lru_cache(maxsize=256)
def _block(kind: str, key: tuple[int, ...], block: int) -> np.ndarray:
    values = np.empty(BLOCK)
    _fill(kind, key, block, values)
    values.setflags(write=False)
    return values


def _draw(kind: str, key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    if count <= 0:
        return np.empty(0)
    blocks = range(first // BLOCK, (first + count - 1) // BLOCK + 1)
    if len(blocks) == 1:  # the usual case of a live session: the same block again and again
        joined = _block(kind, key, blocks[0])
    else:
        joined = np.empty(len(blocks) * BLOCK)
        for i, block in enumerate(blocks):
            _fill(kind, key, block, joined[i * BLOCK : (i + 1) * BLOCK])
    start = first - blocks[0] * BLOCK
    return joined[start : start + count]


def key_of(data: Mapping) -> int:
    """A number for the stream of a fault: it follows what the fault is, not where it stands in a list or when it ends."""
    told = {k: v for k, v in data.items() if k != "end"}
    return zlib.crc32(json.dumps(told, sort_keys=True, separators=(",", ":"), default=float).encode())


def normal(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """Draws first … first+count−1 of a standard normal stream. ``key`` is a tuple of non-negative integers."""
    return _draw("normal", key, first, count)


def uniform(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """The same on [0, 1)."""
    return _draw("uniform", key, first, count)
