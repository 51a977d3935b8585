"""The filter run under several suppositions at once, in the lanes of a vector: engine/estimation/hypothesis_bank.py along rows."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, rowwise
from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.estimation.hypothesis_bank import sums, suppositions

WIDTH = 8  # suppositions in one pass: as many as a vector of the processor holds
LOST = 1e120  # energy of a supposition under which the filter leaves what numbers hold


@dataclass(frozen=True)
class HypothesisCourses:
    """Suppositions (the first axis of ``parameters``) of each channel (the second) in the numbers COURSE of engine/estimation/hypothesis_bank.py, and the
    bounds of each channel; d from ``begin`` on counts, what comes before ``until`` is early (both of each supposition)."""

    parameters: np.ndarray
    least: np.ndarray
    most: np.ndarray
    begin: np.ndarray
    until: np.ndarray

    def lanes(self, own: np.ndarray) -> np.ndarray:
        """Numbers × suppositions, in the order of the program's parameters; of the last some more than there are, to fill the vectors."""
        count, p, numbers = self.parameters.shape
        lanes = np.empty((p * (numbers + 3) + 2, -(-count // WIDTH) * WIDTH))
        channels = lanes[:-2].reshape(p, numbers + 3, -1)
        channels[:, :numbers, :count] = self.parameters.transpose(1, 2, 0)
        channels[:, numbers], channels[:, numbers + 1], channels[:, numbers + 2] = (
            self.least[:, None],
            self.most[:, None],
            own[:, None],
        )
        lanes[-2, :count], lanes[-1, :count] = self.begin, self.until
        lanes[:, count:] = lanes[:, count - 1 : count]
        return lanes


@dataclass(frozen=True)
class BankResult:
    """What suppositions come to: the first axis; the second, times. J (p × p), s (p), q (m), the diagonal of what of J is early (p),
    the filter's states."""

    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    early: np.ndarray
    states: np.ndarray


class FilterBank:
    """The suppositions of one filter."""

    def __init__(self, filter_: InnovationFilter):
        self.filter = filter_
        self.program = suppositions(filter_.program, filter_.p, filter_.m)
        used = variables(self.program.graph, list(self.program.update))
        told = [i for i in self.program.inputs if i in used and i not in filter_.names]
        own = self.program.parameters[len(filter_.program.parameters) :]
        self.layout = Layout(held=(*filter_.names, *told), lane_params=own, lanes=WIDTH)
        p, place = filter_.p, {name: k for k, name in enumerate(self.program.states)}
        self._entries = [
            place[f"sum.J.{min(i, j)}.{max(i, j)}"] for i in range(p) for j in range(p)
        ]  # of the symmetric J
        first = place["sum.s.0"]
        self._ends = (first, first + p, first + 2 * p, first + 2 * p + filter_.m)

    def prepare(self) -> None:
        """Have the kernel at hand: compiling it takes up to a second."""
        kernel(self.program, self.layout)

    def row_inputs(self, base: np.ndarray, table: np.ndarray, d: np.ndarray) -> np.ndarray:
        """What all suppositions are given at each row: ``base`` (rows × p) is known of θ, ``d`` is the time in decisions."""
        names, given = len(self.filter.names), {"d": d} | {f"base.{j}": base[:, j] for j in range(self.filter.p)}
        told = np.empty((len(d), len(self.layout.held)))
        told[:, :names] = table[:, :names]
        for c, name in enumerate(self.layout.held[names:], start=names):
            told[:, c] = given[name]
        return told

    def run(
        self,
        states: np.ndarray,
        told: np.ndarray,
        t: np.ndarray,
        courses: HypothesisCourses,
        trusted_outputs: np.ndarray,
        stops: np.ndarray,
    ) -> BankResult:
        """Along the same rows under several suppositions: ``states`` (suppositions × states); sums and states are given after so many
        rows as ``stops`` are."""
        count = len(states)
        run, params, segments = (
            kernel(self.program, self.layout),
            self.filter.params(trusted_outputs),
            rowwise(t, stops),
        )
        own = courses.lanes(self.filter.base)
        found = np.empty((own.shape[1], len(stops), len(self.program.states)))
        for first in range(0, count, WIDTH):
            mine = states[first : first + WIDTH]
            state, out = (
                np.zeros((len(self.program.states), WIDTH)),
                np.empty((len(stops), len(self.program.states), WIDTH)),
            )
            state[: states.shape[1], : len(mine)] = mine.T
            state[: states.shape[1], len(mine) :] = mine[-1:].T
            run(
                segments,
                state,
                params,
                1,
                out,
                held=told,
                lane_params=np.ascontiguousarray(own[:, first : first + WIDTH]),
            )
            found[first : first + WIDTH] = out.transpose(2, 0, 1)
        return self._parted(found[:count])

    def _parted(self, found: np.ndarray) -> BankResult:
        p, m = self.filter.p, self.filter.m
        n = found.shape[-1] - len(sums(p, m))
        if not np.isfinite(found.sum()):
            found = np.concatenate(
                [
                    found[..., :n],
                    np.nan_to_num(found[..., n:-m]),
                    np.nan_to_num(found[..., -m:], nan=LOST, posinf=LOST),
                ],
                axis=-1,
            )
        J = found[:, :, self._entries].reshape(*found.shape[:2], p, p)
        s, early, q = (found[:, :, a:b] for a, b in pairwise(self._ends))
        return BankResult(J, s, q, early, found[:, :, :n])
