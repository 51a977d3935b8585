"""Binary frames: samples as the wire has them, the rows that are computed ahead of them, and the numbers of frames."""

from array import array
from bisect import bisect_right
from struct import Struct

import numpy as np

from thetascope_schemas.service.session import HEADER

_HEADER = Struct(HEADER)


def encode_frame(sequence: int, epoch: int, first: int, samples: np.ndarray) -> bytes:
    """A frame of float32 samples, columns × rows."""
    columns, rows = samples.shape
    return _HEADER.pack(sequence & 0xFFFFFFFF, epoch, first, rows, columns) + samples.tobytes()


def as_float32(rows: np.ndarray) -> np.ndarray:
    """Rows as little-endian float32; beyond its range they are infinite."""
    if rows.dtype == np.dtype("<f4"):
        return rows
    with np.errstate(over="ignore", invalid="ignore"):
        return rows.astype("<f4")


class FrameBuffer:
    """Rows first … end − 1 as float32: those computed ahead, and a few that were shown just now.

    Kept row after row, so that a frame's few rows lie side by side in memory: many sessions do not fit into the cache.
    """

    def __init__(self, row: int, columns: int) -> None:
        self.clear(row, columns)

    def clear(self, row: int, columns: int) -> None:
        """Nothing is known; row `row` comes next."""
        self.first = self.end = row
        self._rows = np.empty((0, columns), "<f4")

    @property
    def columns(self) -> int:
        return self._rows.shape[1]

    def append(self, rows: np.ndarray, keep: int) -> None:
        """Add computed rows; what is before row `keep` is forgotten."""
        drop = max(0, min(keep, self.end) - self.first)
        self._rows = np.concatenate([self._rows[drop:], np.ascontiguousarray(as_float32(rows).T)])
        self.first += drop
        self.end = self.first + len(self._rows)

    def take(self, first: int, last: int) -> np.ndarray | None:
        """Columns × rows first … last − 1, or None where they are not all here."""
        if first < self.first or last > self.end:
            return None
        return self._rows[first - self.first : last - self.first].T


class FrameNumbers:
    """The numbers of a session's frames: which rows a viewer has that names the last one it got.

    Frames count from 1. Kept are the ends of the last frames of the present epoch; whoever names an older one is sent the
    whole past again.
    """

    KEPT = 4096

    def __init__(self) -> None:
        self.last = 0
        self._before = 0  # the last number that is no longer known
        self._ends = array("Q")

    def add(self, end: int) -> int:
        """The number of a frame that brings the rows to `end`."""
        self.last += 1
        self._ends.append(end)
        if len(self._ends) >= 2 * self.KEPT:
            del self._ends[: self.KEPT]
            self._before += self.KEPT
        return self.last

    def new_epoch(self) -> None:
        """What was sent so far does not continue."""
        self._before, self._ends = self.last, array("Q")

    def rows_after(self, number: int) -> int | None:
        """How many rows whoever got frame `number` has; None: unknown."""
        place = number - self._before - 1
        return self._ends[place] if 0 <= place < len(self._ends) else None

    def number_at(self, rows: int) -> int:
        """The last frame that brings no more than `rows` rows; 0: none that is known."""
        place = bisect_right(self._ends, rows)
        return self._before + place if place else 0
