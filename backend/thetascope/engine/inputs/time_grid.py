"""The time grid: equal base steps, cut where something is discontinuous, dealt out as segments for the kernels."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thetascope.engine.compiler.jit import NEVER, Segments

_SNAP = 1e-6  # a break within this fraction of a step of a grid point is taken to be on it


@dataclass(frozen=True)
class Grid:
    """Segments over base steps [first, last) of h seconds, and the time of every (sub)step, found when it is asked for.

    start, end: times of each (sub)step's ends; anchor: its middle; segment_anchor: inside each segment's first step.
    base: index in the step arrays at which each base step begins, plus the total. ``whole``: no base step is broken.
    """

    segments: Segments
    first: int
    last: int
    h: float
    substeps: int
    whole: bool

    @cached_property
    def count(self) -> int:
        """How many (sub)steps there are."""
        return (self.last - self.first) * self.substeps if self.whole else int(self.segments.steps.sum())

    @cached_property
    def _times(self) -> tuple[np.ndarray, np.ndarray]:
        """Start and width of every (sub)step."""
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
        """Start of every step in s, shape (count,)."""
        return self._times[0]

    @cached_property
    def end(self) -> np.ndarray:
        """End of every step in s, shape (count,)."""
        return self._times[0] + self._times[1]

    @cached_property
    def anchor(self) -> np.ndarray:
        """Middle of every step in s: it tells on which side of a break the step lies. Shape (count,)."""
        return self._times[0] + 0.5 * self._times[1]

    @cached_property
    def segment_anchor(self) -> np.ndarray:
        """Middle of the first step of every segment in s, shape (segments,)."""
        return self.segments.t + (self.segments.index + 0.5) * self.segments.h

    @cached_property
    def base(self) -> np.ndarray:
        """The first step of every base step, and the number of steps: shape (base steps + 1,)."""
        if self.whole:
            return np.arange(self.last - self.first + 1) * self.substeps
        # the first step of each base step: the one whose middle is the first beyond the base step's beginning
        return np.searchsorted(self.anchor, np.arange(self.first, self.last + 1) * self.h)


def sort_out(breaks: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Of the given times: the grid points that are meant (whole numbers of steps), and the positions between them, sorted."""
    position = np.asarray(breaks, dtype=float) / h
    nearest = np.rint(position)
    on_grid = np.abs(position - nearest) < _SNAP
    return nearest[on_grid].astype(np.int64), distinct(position[~on_grid])


def distinct(values: np.ndarray) -> np.ndarray:
    """Sorted, each once: np.unique without its overhead, which short spans feel."""
    values = np.sort(values)
    if len(values) < 2:
        return values
    keep = np.empty(len(values), dtype=bool)
    keep[0] = True
    np.not_equal(values[1:], values[:-1], out=keep[1:])
    return values[keep]


def cut(first: int, last: int, h: float, breaks: np.ndarray, every: int, substeps: int) -> Grid:
    """The grid over base steps [first, last) of h seconds.

    ``breaks``: times of discontinuities (any order, repeats allowed). Every ``every``-th base step is recorded; each is
    taken in ``substeps`` steps.
    """
    marks, off = sort_out(breaks, h)
    broken = distinct(np.floor(off).astype(np.int64)) if len(off) else np.empty(0, dtype=np.int64)
    broken = broken[(broken >= first) & (broken < last)]
    bounds = np.concatenate([np.array([first, last]), marks, broken, broken + 1])
    bounds = distinct(bounds[(bounds >= first) & (bounds <= last)])
    starts = bounds[:-1]
    lengths = bounds[1:] - starts
    to_record = every - starts % every
    steps = lengths * substeps
    due = np.where(to_record <= lengths, to_record * substeps, NEVER)
    columns = [steps, due, np.zeros(len(starts)), starts * substeps, np.full(len(starts), h / substeps)]
    if len(broken):
        columns = _split(starts, columns, h, broken, off, substeps)
    kinds = (np.int64, np.int64, float, float, float)
    segments = Segments(*(np.ascontiguousarray(c, dtype=d) for c, d in zip(columns, kinds, strict=True)))
    return Grid(segments, first, last, h, substeps, not len(broken))


def _split(starts: np.ndarray, columns: list, h: float, broken: np.ndarray, off: np.ndarray, substeps: int) -> list:
    """Replace each broken base step by pieces that end on the breaks inside it; only the last piece records."""
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
