"""A recording: measured inputs and outputs of a real plant, sampled as they come."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Recording:
    """Rows of a record in the order of time, in the plant's units.

    Attributes:
        t: (rows,), strictly increasing times in s; neither equally spaced nor from zero.
        u: (rows, inputs), the plant's inputs, then its known signals; row k holds until t[k + 1].
        y: (rows, outputs), readings; NaN where a cell is missing.
        held: (rows, inputs), whether an input was missing in this row and its earlier value was held.
        resolution: (outputs,), the step between neighbouring readings of a quantised output, 0 where none is seen.
        line: (rows,), the line or row number in the file, for messages.
    """

    t: np.ndarray
    u: np.ndarray
    y: np.ndarray
    held: np.ndarray
    resolution: np.ndarray
    line: np.ndarray

    def __len__(self) -> int:
        return len(self.t)

    def part(self, begin: int, end: int) -> "Recording":
        """Return rows begin … end − 1."""
        rows = slice(begin, end)
        return Recording(self.t[rows], self.u[rows], self.y[rows], self.held[rows], self.resolution, self.line[rows])
