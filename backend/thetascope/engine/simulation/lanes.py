"""Held inputs that differ from run to run, as tables for kernels in lanes (segments × names × lanes).

Noise is drawn for all lanes of a block together. Other signals are looked up in levels that are computed once for all
runs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thetascope.engine.inputs.random_streams import Streams
from thetascope.engine.inputs.sensors import noise_key
from thetascope.engine.inputs.signals import Signal

MOST_LEVELS = 20_000_000  # most numbers stored for one signal over all runs

Column = Callable[[int], np.ndarray]  # block → segments × lanes


@dataclass(frozen=True)
class Blocks:
    """Runs distributed over blocks of ``width`` lanes; the last run fills the unused lanes of the last block."""

    runs: int
    width: int

    @property
    def count(self) -> int:
        """Return the number of blocks."""
        return -(-self.runs // self.width)

    @cached_property
    def padded(self) -> np.ndarray:
        """Return the run in each lane of each block, block after block."""
        return np.minimum(np.arange(self.count * self.width), self.runs - 1)

    def slice(self, block: int) -> slice:
        """Return the places of a block's lanes."""
        return slice(block * self.width, (block + 1) * self.width)


class Noise:
    """Noise of one output without other terms: std · draw j on [j·hold, (j+1)·hold), with one random stream per run."""

    def __init__(self, blocks: Blocks, output: int, std: Sequence[float], seeds: Sequence[int], hold: float):
        self.hold = hold
        each = [blocks.padded[blocks.slice(b)] for b in range(blocks.count)]
        self.std = [np.array([std[r] for r in runs]) for runs in each]
        self.streams = [Streams([noise_key(seeds[r], output) for r in runs]) for runs in each]

    def over(self, at: np.ndarray) -> Column:
        """Return the noise at these times, block by block."""
        index = np.floor(at / self.hold).astype(np.int64)  # the same rounding as in signals.random_held
        low, count = int(index.min()), int(index.max() - index.min()) + 1
        picked = None if count == len(index) and (np.diff(index) == 1).all() else index - low

        def column(block: int) -> np.ndarray:
            values = self.streams[block].normal(low, count)
            values *= self.std[block]
            return values if picked is None else values[picked]

        return column


class Levels:
    """A held signal in all runs: ``levels[i]`` (one number per lane) between edges i−1 and i."""

    def __init__(self, blocks: Blocks, edges: np.ndarray, levels: np.ndarray):
        self.edges = edges
        self.levels = [np.ascontiguousarray(levels[:, blocks.padded[blocks.slice(b)]]) for b in range(blocks.count)]

    @classmethod
    def of(cls, blocks: Blocks, signals: Sequence[Signal], end: float) -> "Levels | None":
        """Return the levels of the signals up to ``end``; None if there are too many to store."""
        edges = np.unique(np.concatenate([s.breaks(0.0, end) for s in signals]))
        if (len(edges) + 1) * len(signals) > MOST_LEVELS:
            return None
        bounds = np.concatenate([[0.0], edges, [end]])
        inside = 0.5 * (bounds[:-1] + bounds[1:])
        return cls(blocks, edges, np.stack([s(inside, inside) for s in signals], axis=1))

    def over(self, at: np.ndarray) -> Column:
        """Return the levels at these times, block by block."""
        index = np.searchsorted(self.edges, at)
        if index[0] == index[-1]:
            return lambda block: self.levels[block][index[0]]
        return lambda block: self.levels[block][index]


class Separate:
    """A held signal without a known structure: it is evaluated run by run."""

    def __init__(self, blocks: Blocks, signals: Sequence[Signal]):
        self.blocks, self.signals = blocks, signals

    def over(self, at: np.ndarray) -> Column:
        """Return the signals of each run at these times, block by block."""

        def column(block: int) -> np.ndarray:
            runs = self.blocks.padded[self.blocks.slice(block)]
            return np.stack([self.signals[r](at, at) for r in runs], axis=1)

        return column


def table(columns: list[Column], segments: int, block: int, width: int) -> np.ndarray | None:
    """Return the table of one block."""
    if not columns:
        return None
    if len(columns) == 1:
        return np.ascontiguousarray(np.broadcast_to(columns[0](block), (segments, width)))
    values = np.empty((segments, len(columns), width))
    for j, column in enumerate(columns):
        values[:, j, :] = column(block)
    return values
