"""The filter run under several suppositions at once, in the lanes of a vector: engine/suppositions.py along rows."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from backend.diagnosis.evidence import Filter, rowwise
from backend.engine.graph import variables
from backend.engine.kernel import Layout, kernel
from backend.engine.suppositions import COURSE, sums, suppositions

WIDTH = 8  # suppositions in one pass: as many as a vector of the processor holds
LOST = 1e120  # energy of a supposition under which the filter leaves what numbers hold


@dataclass(frozen=True)
class Courses:
    """Suppositions (the first axis) of each channel (the second), as engine/suppositions.py has them; d from ``begin`` on counts, what
    comes before ``until`` is early (both of each supposition)."""

    onset: np.ndarray
    start: np.ndarray
    rate: np.ndarray
    top: np.ndarray
    bend: np.ndarray
    fade: np.ndarray
    size: np.ndarray
    least: np.ndarray
    most: np.ndarray
    begin: np.ndarray
    until: np.ndarray

    def lanes(self, own: np.ndarray) -> np.ndarray:
        """Numbers × suppositions, in the order of the program's parameters."""
        each = [*(getattr(self, name) for name in COURSE), np.broadcast_to(self.least, self.onset.shape),
                np.broadcast_to(self.most, self.onset.shape), np.broadcast_to(own, self.onset.shape)]  # fmt: skip
        channels = np.stack(each, axis=2).reshape(len(self.onset), -1)
        return np.concatenate([channels.T, self.begin[None], self.until[None]])


@dataclass(frozen=True)
class Supposed:
    """What suppositions come to: the first axis; the second, times. J (p × p), s (p), q (m), the diagonal of what of J is early (p),
    the filter's states."""

    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    early: np.ndarray
    states: np.ndarray


class Supposing:
    """The suppositions of one filter."""

    def __init__(self, filter_: Filter):
        self.filter = filter_
        self.program = suppositions(filter_.program, filter_.p, filter_.m)
        used = variables(self.program.graph, list(self.program.update))
        told = [i for i in self.program.inputs if i in used and i not in filter_.names]
        own = self.program.parameters[len(filter_.program.parameters) :]
        self.layout = Layout(held=(*filter_.names, *told), lane_params=own, lanes=WIDTH)

    def prepare(self) -> None:
        """Have the kernel at hand: compiling it takes up to a second."""
        kernel(self.program, self.layout)

    def run(self, states: np.ndarray, base: np.ndarray, table: np.ndarray, t: np.ndarray, d: np.ndarray, courses: Courses,
            heed: np.ndarray, stops: np.ndarray) -> Supposed:  # fmt: skip
        """Along the same rows under several suppositions: ``states`` (suppositions × states), ``base`` (rows × p): what is known.

        ``d``: times in decisions; ``stops``: numbers of rows after which sums and states are given.
        """
        count, rows, p, names = len(states), len(t), self.filter.p, self.filter.names
        given = {"d": d} | {f"base.{j}": base[:, j] for j in range(p)}
        held = np.empty((rows, len(self.layout.held)))
        held[:, : len(names)] = table[:, : len(names)]
        for c, name in enumerate(self.layout.held[len(names) :], start=len(names)):
            held[:, c] = given[name]
        run, params, segments = kernel(self.program, self.layout), self.filter.params(heed), rowwise(t, stops)
        own = courses.lanes(self.filter.base)
        found = np.zeros((len(stops), len(self.program.states), -(-count // WIDTH) * WIDTH))
        for first in range(0, count, WIDTH):
            pick = np.minimum(np.arange(first, first + WIDTH), count - 1)
            state, out = np.zeros((len(self.program.states), WIDTH)), np.empty((len(found), len(self.program.states), WIDTH))
            state[: states.shape[1]] = states[pick].T
            run(segments, state, params, 1, out, held=held, lane_params=np.ascontiguousarray(own[:, pick]))
            found[:, :, first : first + WIDTH] = out
        return self._parted(found[:, :, :count].transpose(2, 0, 1))

    def _parted(self, found: np.ndarray) -> Supposed:
        p, m = self.filter.p, self.filter.m
        n = found.shape[-1] - len(sums(p, m))
        if not np.isfinite(found.sum()):
            found = np.concatenate([found[..., :n], np.nan_to_num(found[..., n:-m]), np.nan_to_num(found[..., -m:], nan=LOST, posinf=LOST)], axis=-1)
        i, j = np.triu_indices(p)
        ends = n + np.cumsum([p, len(i), p, p, m])
        J = np.empty((*found.shape[:2], p, p))
        J[:, :, i, j] = J[:, :, j, i] = found[:, :, ends[0] : ends[1]]
        s, early, q = (found[:, :, a:b] for a, b in pairwise(ends[1:]))
        return Supposed(J, s, q, early, found[:, :, :n])
