"""Reproducible random numbers with random access: draw j of a stream is a function of (key, j) alone.

So a run may be cut into chunks, rewound or forked without carrying a generator along, and the numbers stay the same.
"""

from functools import lru_cache

import numpy as np

BLOCK = 4096


@lru_cache(maxsize=512)
def _block(kind: str, key: tuple[int, ...], index: int) -> np.ndarray:
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence([*key, index])))
    values = generator.standard_normal(BLOCK) if kind == "normal" else generator.random(BLOCK)
    values.setflags(write=False)
    return values


def _draw(kind: str, key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    if count <= 0:
        return np.empty(0)
    blocks = range(first // BLOCK, (first + count - 1) // BLOCK + 1)
    joined = np.concatenate([_block(kind, key, b) for b in blocks]) if len(blocks) > 1 else _block(kind, key, blocks[0])
    start = first - blocks[0] * BLOCK
    return joined[start : start + count]


def normal(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """Draws first … first+count−1 of a standard normal stream. ``key`` is a tuple of non-negative integers."""
    return _draw("normal", key, first, count)


def uniform(key: tuple[int, ...], first: int, count: int) -> np.ndarray:
    """The same on [0, 1)."""
    return _draw("uniform", key, first, count)
