"""The time grid: equal base steps, cut where something is discontinuous, dealt out as segments for the kernels."""

from dataclasses import dataclass

import numpy as np

from backend.engine.kernel import NEVER, Segments

_SNAP = 1e-6  # a break within this fraction of a step of a grid point is taken to be on it


@dataclass(frozen=True)
class Grid:
    """Segments over base steps [first, last), with the time of every step for evaluating signals.

    start, end: times of each (sub)step's ends; anchor: its middle; segment_anchor: inside each segment's first step.
    base: index in the step arrays at which each base step begins, plus the total.
    """

    segments: Segments
    start: np.ndarray
    end: np.ndarray
    anchor: np.ndarray
    segment_anchor: np.ndarray
    base: np.ndarray


def sort_out(breaks: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Of the given times: the grid points that are meant (whole numbers of steps), and the positions between them, sorted."""
    position = np.asarray(breaks, dtype=float) / h
    nearest = np.rint(position)
    on_grid = np.abs(position - nearest) < _SNAP
    return nearest[on_grid].astype(np.int64), np.unique(position[~on_grid])


def cut(first: int, last: int, h: float, breaks: np.ndarray, every: int, substeps: int) -> Grid:
    """The grid over base steps [first, last) of h seconds.

    ``breaks``: times of discontinuities (any order, repeats allowed). Every ``every``-th base step is recorded; each is
    taken in ``substeps`` steps.
    """
    marks, off = sort_out(breaks, h)
    broken = np.unique(np.floor(off).astype(np.int64))
    broken = broken[(broken >= first) & (broken < last)]
    bounds = np.unique(np.concatenate([np.array([first, last]), marks, broken, broken + 1]))
    bounds = bounds[(bounds >= first) & (bounds <= last)]
    starts, lengths = bounds[:-1], np.diff(bounds)
    to_record = every - starts % every
    steps = lengths * substeps
    due = np.where(to_record <= lengths, to_record * substeps, NEVER)
    columns = [steps, due, np.zeros(len(starts)), starts * substeps, np.full(len(starts), h / substeps)]
    if len(broken):
        columns = _split(starts, columns, h, broken, off, substeps)
    kinds = (np.int64, np.int64, float, float, float)
    segments = Segments(*(np.ascontiguousarray(c, dtype=d) for c, d in zip(columns, kinds, strict=True)))
    return _with_times(segments, first, last, h)


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


def _with_times(segments: Segments, first: int, last: int, h: float) -> Grid:
    total = int(segments.steps.sum())
    owner = np.repeat(np.arange(len(segments.steps)), segments.steps)
    offset = np.concatenate([[0], np.cumsum(segments.steps)])
    inside = np.arange(total) - offset[owner]
    width = segments.h[owner]
    start = segments.t[owner] + (segments.index[owner] + inside) * width
    anchor = start + 0.5 * width
    # the first step of each base step: the one whose middle is the first beyond the base step's beginning
    base = np.searchsorted(anchor, np.arange(first, last + 1) * h)
    opening = segments.t + (segments.index + 0.5) * segments.h
    return Grid(segments, start, start + width, anchor, opening, base)
