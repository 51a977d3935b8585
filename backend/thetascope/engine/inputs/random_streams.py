"""Reproducible random numbers with random access: draw j of a stream is a function of (key, j) alone.

So a run can be split, rewound or forked without the state of a generator, and the numbers are the same on every
processor. The generator is compiled (ir_random.py), because noise for a thousand runs must not cost more than the runs.
"""

import ctypes
import hashlib
import json
import zlib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial

import numpy as np

from thetascope.engine.compiler.jit import load, platform_key
from thetascope.engine.inputs import ir_random

_WORD, _COUNT, _PLACE = ctypes.c_uint64, ctypes.c_int64, ctypes.c_void_p
_ONE_STREAM = ctypes.CFUNCTYPE(None, _WORD, _WORD, _COUNT, _COUNT, _PLACE)
_EIGHT_STREAMS = ctypes.CFUNCTYPE(None, _PLACE, _PLACE, _COUNT, _COUNT, _PLACE, _COUNT)


@lru_cache(maxsize=1)
def _functions() -> dict[str, Callable]:
    """Return the functions of the compiled generator by name.

    Each holds the module: two threads that come first at the same time load one each, of which one is kept here, and
    the machine code of the other must exist until its call has ended.
    """
    engine = load("draws-" + platform_key(), ir_random.emit)
    kinds = {"uniform": _ONE_STREAM, "normal": _ONE_STREAM, "normal_lanes": _EIGHT_STREAMS}
    return {name: partial(_call, engine, kind(engine.get_function_address(name))) for name, kind in kinds.items()}


def _call(module: object, function: Callable[..., None], *args: int) -> None:
    """Call a function of a module, which is referenced meanwhile."""
    function(*args)


@lru_cache(maxsize=8192)
def _words(key: tuple[int, ...]) -> tuple[int, int]:
    """Return the generator's key (128 bits) for a key of any length, as two words."""
    digest = hashlib.blake2b(",".join(str(int(k)) for k in key).encode(), digest_size=16).digest()
    return int.from_bytes(digest[:8], "little"), int.from_bytes(digest[8:], "little")


def _draw(kind: str, key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """Return draws first … first+count−1 of a stream; ``kind`` is normal or uniform."""
    if count <= 0:
        return np.empty(0)
    pair = first // 2  # the generator returns two numbers per pair
    blocks = -(-(first + count - 2 * pair) // ir_random.BLOCK)
    out = np.empty(blocks * ir_random.BLOCK)
    _functions()[kind](*_words(key), pair, blocks, out.ctypes.data)
    return out[first - 2 * pair :][:count]


def key_of(data: Mapping) -> int:
    """Return the key of a fault's stream. It depends on the fault's fields except `end`, not on its place in a list."""
    identity = {k: v for k, v in data.items() if k != "end"}
    return zlib.crc32(json.dumps(identity, sort_keys=True, separators=(",", ":"), default=float).encode())


def normal(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """Return draws first … first+count−1 of a standard normal stream. ``key`` is a tuple of non-negative integers."""
    return _draw("normal", key, first, count)


def uniform(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """Return draws first … first+count−1 of a uniform stream on [0, 1)."""
    return _draw("uniform", key, first, count)


class Streams:
    """Standard normal streams for runs in lanes, one per key. The number of keys must be a multiple of eight."""

    def __init__(self, keys: Sequence[tuple[int, ...]]):
        self._keys = np.array([_words(tuple(k)) for k in keys], dtype=np.uint64).T.copy()

    def normal(self, first: int, count: int) -> np.ndarray:
        """Return draws first … first+count−1 of every stream, the same as ``normal``: shape (count, streams)."""
        pair, streams = first // 2, self._keys.shape[1]
        pairs = -(-(first + count - 2 * pair) // 2)
        out = np.empty((2 * pairs, streams))
        low, high, to = self._keys[0].ctypes.data, self._keys[1].ctypes.data, out.ctypes.data
        for offset in range(0, 8 * streams, 64):
            _functions()["normal_lanes"](low + offset, high + offset, pair, pairs, to + offset, streams)
        return out[first - 2 * pair :][:count]
