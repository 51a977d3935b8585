"""Time grid: equal base steps, split at discontinuities, and arranged in segments for the kernels."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from thetascope.engine.compiler.jit import NEVER, Segments
from thetascope.engine.errors import SpecError
from thetascope.messages import Message

_MULTIPLE = 1e-6  # relative tolerance for one interval to be a multiple of another
_SNAP = 1e-6  # a break closer than this fraction of a step to a grid point counts as being on it


@dataclass(frozen=True)
class Grid:
    """Segments over base steps [first, last) of h seconds, and the times of all steps, computed on first use.

    A base step consists of ``substeps`` steps, or of more if it is split at discontinuities. ``whole``: none is split.
    Within a segment every ``spacing``-th step after the first recorded one is recorded; ``records`` rows in all.
    """

    segments: Segments
    first: int
    last: int
    h: float
    substeps: int
    whole: bool
    spacing: int
    records: int

    @cached_property
    def count(self) -> int:
        """Return the number of steps."""
        return (self.last - self.first) * self.substeps if self.whole else int(self.segments.steps.sum())

    @cached_property
    def _times(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the start and the width of every step in s."""
        if self.whole:
            width = self.h / self.substeps
            return np.arange(self.first * self.substeps, self.last * self.substeps) * width, np.full(self.count, width)
        segments = self.segments
        owner = np.repeat(np.arange(len(segments.steps)), segments.steps)
        offset = np.concatenate([[0], np.cumsum(segments.steps)])
        inside = np.arange(self.count) - offset[owner]
        width = segments.h[owner]
        return segments.t[owner] + (segments.index[owner] + inside) * width, width

    @cached_property
    def start(self) -> np.ndarray:
        """Return the start of every step in s, shape (count,)."""
        return self._times[0]

    @cached_property
    def end(self) -> np.ndarray:
        """Return the end of every step in s, shape (count,)."""
        return self._times[0] + self._times[1]

    @cached_property
    def anchor(self) -> np.ndarray:
        """Return the middle of every step in s, shape (count,). It decides on which side of a break the step is."""
        return self._times[0] + 0.5 * self._times[1]

    @cached_property
    def segment_anchor(self) -> np.ndarray:
        """Return the middle of the first step of every segment in s, shape (segments,)."""
        return self.segments.t + (self.segments.index + 0.5) * self.segments.h

    @cached_property
    def base(self) -> np.ndarray:
        """Return the index of the first step of every base step, then the number of steps: shape (base steps + 1,)."""
        if self.whole:
            return np.arange(self.last - self.first + 1) * self.substeps
        # the first step of a base step is the first whose middle is after the beginning of the base step
        return np.searchsorted(self.anchor, np.arange(self.first, self.last + 1) * self.h)

    def part(self, first: int, last: int, every: int) -> "Grid":
        """Return the grid of the steps [first, last); every ``every``-th step of a segment is recorded.

        Its numbers of base steps are those of the whole grid.
        """
        s = self.segments
        begins = np.concatenate([[0], np.cumsum(s.steps)[:-1]])
        low, high = np.maximum(first - begins, 0), np.minimum(last - begins, s.steps)
        kept = low < high
        passed = np.maximum(0, -(-(low - s.first + 1) // every)) * every  # recorded ones among the steps left out
        due = np.where(s.first == NEVER, NEVER, s.first + passed - low)
        columns = (high - low, due, s.t, s.index + low, s.h)
        segments = Segments(*(np.ascontiguousarray(c[kept]) for c in columns))
        part = Grid(segments, self.first, self.last, self.h, 1, False, every, 0)
        return replace(part, records=part.recorded(every))

    def recorded(self, every: int) -> int:
        """Return the number of rows that are recorded, where every ``every``-th step of a segment is."""
        s = self.segments
        return int(np.maximum(0, (s.steps - s.first) // every + 1).sum())


def sort_out(breaks: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the given times that are on grid points, as numbers of steps, and the other ones, in steps and sorted."""
    position = np.asarray(breaks, dtype=float) / h
    nearest = np.rint(position)
    on_grid = np.abs(position - nearest) < _SNAP
    return nearest[on_grid].astype(np.int64), distinct(position[~on_grid])


def distinct(values: np.ndarray) -> np.ndarray:
    """Return the distinct values, sorted: np.unique without its overhead, which is noticeable for short spans."""
    values = np.sort(values)
    if len(values) < 2:
        return values
    keep = np.empty(len(values), dtype=bool)
    keep[0] = True
    np.not_equal(values[1:], values[:-1], out=keep[1:])
    return values[keep]


def cut(
    first: int,
    last: int,
    h: float,
    breaks: np.ndarray,
    every: int,
    substeps: int,
    stops: np.ndarray | None = None,
) -> Grid:
    """Return the grid over base steps [first, last) of h seconds.

    Args:
        first, last: numbers of base steps.
        h: length of a base step in s.
        breaks: times of discontinuities in s, in any order, repeats allowed.
        every: every ``every``-th base step is recorded.
        substeps: steps within a base step.
        stops: base steps to record in place of every ``every``-th.
    """
    marks, off = sort_out(breaks, h)
    broken = distinct(np.floor(off).astype(np.int64)) if len(off) else np.empty(0, dtype=np.int64)
    broken = broken[(broken >= first) & (broken < last)]
    ends = np.empty(0, dtype=np.int64) if stops is None else stops
    bounds = np.concatenate([np.array([first, last]), marks, broken, broken + 1, ends])
    bounds = distinct(bounds[(bounds >= first) & (bounds <= last)])
    starts = bounds[:-1]
    lengths = bounds[1:] - starts
    to_record = every - starts % every
    steps = lengths * substeps
    due = np.where(to_record <= lengths, to_record * substeps, NEVER)
    spacing, records = every * substeps, last // every - first // every
    if stops is not None:
        due = np.where(np.isin(bounds[1:], stops), steps, NEVER)
        spacing, records = int(NEVER), int(np.count_nonzero((stops > first) & (stops <= last)))
    columns = [steps, due, np.zeros(len(starts)), starts * substeps, np.full(len(starts), h / substeps)]
    if len(broken):
        columns = _split(starts, columns, h, broken, off, substeps)
    kinds = (np.int64, np.int64, float, float, float)
    segments = Segments(*(np.ascontiguousarray(c, dtype=d) for c, d in zip(columns, kinds, strict=True)))
    return Grid(segments, first, last, h, substeps, not len(broken), spacing, records)


def _split(starts: np.ndarray, columns: list, h: float, broken: np.ndarray, off: np.ndarray, substeps: int) -> list:
    """Return the columns with each broken base step split at its breaks; only the last piece is recorded."""
    rows: list[tuple] = []
    lookup = set(broken.tolist())
    for i, k in enumerate(starts.tolist()):
        if k not in lookup:
            rows.append(tuple(c[i] for c in columns))
            continue
        edges = np.concatenate([[k], off[(off > k) & (off < k + 1)], [k + 1]]) * h
        for j in range(len(edges) - 1):
            records = j == len(edges) - 2 and columns[1][i] != NEVER
            width = (edges[j + 1] - edges[j]) / substeps
            rows.append((substeps, substeps if records else NEVER, edges[j], 0, width))
    return [np.array(c) for c in zip(*rows, strict=True)]


def multiple(interval: float, step: float, field: str) -> int:
    """Return the number of steps in an interval. Raises SpecError unless it is a whole number of them, at least one."""
    count = round(interval / step)
    if count < 1 or abs(interval / step - count) > _MULTIPLE * max(1, count):
        near = max(1, count) * step
        raise SpecError(field, interval, Message("experiment.time.no-multiple", time=interval, step=step, near=near))
    return count
