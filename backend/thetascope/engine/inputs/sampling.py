"""The instants at which a sensor takes samples: at a period, late by a random time, some of them lost."""

from dataclasses import dataclass

import numpy as np

from thetascope.engine.inputs import random_streams


@dataclass(frozen=True)
class Sampling:
    """Sample instants of one sensor in base steps.

    Attributes:
        every: base steps between samples.
        missing: share of samples that are lost.
        late: largest delay of a sample, in base steps, less than ``every``.
        key: key of its streams of random numbers.
    """

    every: int
    missing: float = 0.0
    late: float = 0.0
    key: tuple[int, ...] = ()

    @property
    def regular(self) -> "Sampling":
        """Return the same sensor without lost and late samples."""
        return Sampling(self.every)

    def taken(self, first: int, last: int) -> np.ndarray:
        """Return the base steps in [first, last) at whose beginnings samples are taken, ascending.

        Sample 0 is never late and never lost.
        """
        low, high = max(0, (first - int(self.late) - 1) // self.every), -(-last // self.every)
        j = np.arange(low, max(low, high))
        steps = j * self.every
        if self.late > 0:
            delay = np.rint(self.late * random_streams.uniform((*self.key, 1), low, len(j))).astype(np.int64)
            steps = steps + np.where(j > 0, np.minimum(delay, self.every - 1), 0)
        kept = (steps >= first) & (steps < last)
        if self.missing > 0:
            kept &= (random_streams.uniform((*self.key, 2), low, len(j)) >= self.missing) | (j == 0)
        return steps[kept]

    def fresh(self, index: np.ndarray, every: int) -> np.ndarray:
        """Return 1 for rows (base steps ``index``, ``every`` apart) in which there is a sample that the row before
        lacks, otherwise 0."""
        if not len(index):
            return np.empty(0)
        taken = self.taken(int(index[0]) - every + 1, int(index[-1]) + 1)
        newest = np.searchsorted(taken, index, side="right")
        return (newest > np.searchsorted(taken, index - every, side="right")) * 1.0
