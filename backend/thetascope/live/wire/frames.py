"""Binary frames: encoding, the buffer of rows to be sent, and the numbers of frames."""

from array import array
from bisect import bisect_right
from struct import Struct

import numpy as np

from thetascope_schemas.service.session import HEADER

_HEADER = Struct(HEADER)


def encode_frame(sequence: int, epoch: int, first: int, samples: np.ndarray) -> bytes:
    """Return a frame of float32 samples, columns × rows."""
    columns, rows = samples.shape
    return _HEADER.pack(sequence & 0xFFFFFFFF, epoch, first, rows, columns) + samples.tobytes()


def as_float32(rows: np.ndarray) -> np.ndarray:
    """Return rows as little-endian float32; values beyond its range become infinite."""
    if rows.dtype == np.dtype("<f4"):
        return rows
    with np.errstate(over="ignore", invalid="ignore"):
        return rows.astype("<f4")


class FrameBuffer:
    """Rows first … end − 1 as float32: those computed ahead, and a few that were shown recently.

    They are stored row by row, so that the few rows of a frame are adjacent in memory: many sessions do not fit into
    the processor's cache.
    """

    def __init__(self, row: int, columns: int) -> None:
        self.clear(row, columns)

    def clear(self, row: int, columns: int) -> None:
        """Forget all rows; row `row` comes next."""
        self.first = self.end = row
        self._rows = np.empty((0, columns), "<f4")

    @property
    def columns(self) -> int:
        """Number of columns."""
        return self._rows.shape[1]

    def append(self, rows: np.ndarray, keep: int) -> None:
        """Add computed rows, columns × rows; rows before row `keep` are dropped."""
        drop = max(0, min(keep, self.end) - self.first)
        self._rows = np.concatenate([self._rows[drop:], np.ascontiguousarray(as_float32(rows).T)])
        self.first += drop
        self.end = self.first + len(self._rows)

    def take(self, first: int, last: int) -> np.ndarray | None:
        """Return rows first … last − 1, columns × rows; None if some are missing."""
        return None if first < self.first or last > self.end else self.rows(first, last)

    def rows(self, first: int, last: int) -> np.ndarray:
        """Return rows first … last − 1, columns × rows, which must be here."""
        return self._rows[first - self.first : last - self.first].T


class FrameNumbers:
    """The numbers of a session's frames, to find the rows that a viewer has from the last frame it received.

    Frames count from 1. The ends of the last frames of the present epoch are kept; a viewer that names an older one is
    sent all rows again.
    """

    KEPT = 4096

    def __init__(self) -> None:
        self.last = 0
        self._before = 0  # the last number whose end is not kept
        self._ends = array("Q")

    def add(self, end: int) -> int:
        """Return the number of the next frame, after which a viewer has `end` rows."""
        self.last += 1
        self._ends.append(end)
        if len(self._ends) >= 2 * self.KEPT:
            del self._ends[: self.KEPT]
            self._before += self.KEPT
        return self.last

    def new_epoch(self) -> None:
        """Forget all ends: rows sent so far do not continue."""
        self._before, self._ends = self.last, array("Q")

    def rows_after(self, number: int) -> int | None:
        """Return how many rows a viewer has after frame `number`; None if unknown."""
        place = number - self._before - 1
        return self._ends[place] if 0 <= place < len(self._ends) else None

    def number_at(self, rows: int) -> int:
        """Return the last frame after which a viewer has at most `rows` rows; 0 if none is known."""
        place = bisect_right(self._ends, rows)
        return self._before + place if place else 0
