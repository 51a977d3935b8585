"""The filter under several hypotheses side by side in the lanes of a vector: engine/estimation/hypothesis_bank.py along
rows."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, rowwise
from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Layout, kernel
from thetascope.engine.estimation.hypothesis_bank import hypothesis_program, sums

WIDTH = 8  # hypotheses in one pass: the lanes of a vector register
LOST = 1e120  # energy of a hypothesis under which the filter diverges


@dataclass(frozen=True)
class HypothesisCourses:
    """The courses of θ under several hypotheses.

    Attributes:
        parameters: (hypotheses, channels, COURSE), see COURSE of engine/estimation/hypothesis_bank.py.
        least, most: (channels,), bounds of θ.
        begin: (hypotheses,), decision from which on evidence is summed.
        until: (hypotheses,), decision up to which evidence is early.
    """

    parameters: np.ndarray
    least: np.ndarray
    most: np.ndarray
    begin: np.ndarray
    until: np.ndarray

    def lanes(self, own: np.ndarray) -> np.ndarray:
        """Return the program's parameters (numbers, lanes); the last hypothesis is repeated to fill the last vector.
        `own`: (p,), θ of the plant."""
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
    """The sums of evidence under each hypothesis (first axis) at each stop (second axis).

    Attributes:
        J: (hypotheses, stops, p, p); s: (hypotheses, stops, p), of the trusted outputs.
        q: (hypotheses, stops, m), energy of each output.
        early: (hypotheses, stops, p), the early part of J's diagonal.
        states: (hypotheses, stops, filter states).
    """

    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    early: np.ndarray
    states: np.ndarray


class FilterBank:
    """The bank of one filter."""

    def __init__(self, filter_: InnovationFilter):
        self.filter = filter_
        self.program = hypothesis_program(filter_.program, filter_.p, filter_.m)
        used = variables(self.program.graph, list(self.program.update))
        shared = [i for i in self.program.inputs if i in used and i not in filter_.names]
        lane_params = self.program.parameters[len(filter_.program.parameters) :]
        self.layout = Layout(held=(*filter_.names, *shared), lane_params=lane_params, lanes=WIDTH)
        p, place = filter_.p, {name: k for k, name in enumerate(self.program.states)}
        self._entries = [
            place[f"sum.J.{min(i, j)}.{max(i, j)}"] for i in range(p) for j in range(p)
        ]  # of the symmetric J
        first = place["sum.s.0"]
        self._ends = (first, first + p, first + 2 * p, first + 2 * p + filter_.m)

    def prepare(self) -> None:
        """Compile the kernel in advance: this takes up to a second."""
        kernel(self.program, self.layout)

    def row_inputs(self, base: np.ndarray, table: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Return the inputs that all hypotheses share at each row; `base`: (rows, p), θ₀; `d`: (rows,), times in
        decisions."""
        names, given = len(self.filter.names), {"d": d} | {f"base.{j}": base[:, j] for j in range(self.filter.p)}
        inputs = np.empty((len(d), len(self.layout.held)))
        inputs[:, :names] = table[:, :names]
        for c, name in enumerate(self.layout.held[names:], start=names):
            inputs[:, c] = given[name]
        return inputs

    def run(
        self,
        states: np.ndarray,
        inputs: np.ndarray,
        t: np.ndarray,
        courses: HypothesisCourses,
        trusted_outputs: np.ndarray,
        stops: np.ndarray,
    ) -> BankResult:
        """Run all hypotheses along the same rows.

        Args:
            states: (hypotheses, filter states), where each begins.
            inputs: (rows, inputs), see `row_inputs`.
            t: (rows,), times in s.
            courses: the courses of θ.
            trusted_outputs: (m,), 1 or 0.
            stops: (stops,), numbers of rows after which results are returned.
        """
        run, params, segments = (
            kernel(self.program, self.layout),
            self.filter.params(trusted_outputs),
            rowwise(t, stops),
        )
        lanes, width = courses.lanes(self.filter.base), len(self.program.states)
        results = np.empty((lanes.shape[1], len(stops), width))
        for first in range(0, len(states), WIDTH):
            batch = states[first : first + WIDTH]
            state, out = np.zeros((width, WIDTH)), np.empty((len(stops), width, WIDTH))
            state[: states.shape[1], : len(batch)] = batch.T
            state[: states.shape[1], len(batch) :] = batch[-1:].T  # fills the vector
            lane_params = np.ascontiguousarray(lanes[:, first : first + WIDTH])
            run(segments, state, params, 1, out, held=inputs, lane_params=lane_params)
            results[first : first + WIDTH] = out.transpose(2, 0, 1)
        return self._split(results[: len(states)])

    def _split(self, results: np.ndarray) -> BankResult:
        """Return the program's states (hypotheses, stops, states) by name; those that are not finite become LOST, or
        finite."""
        p, m = self.filter.p, self.filter.m
        n = results.shape[-1] - len(sums(p, m))
        if not np.isfinite(results.sum()):
            middle = np.nan_to_num(results[..., n:-m])
            energy = np.nan_to_num(results[..., -m:], nan=LOST, posinf=LOST)
            results = np.concatenate([results[..., :n], middle, energy], axis=-1)
        J = results[:, :, self._entries].reshape(*results.shape[:2], p, p)
        s, early, q = (results[:, :, a:b] for a, b in pairwise(self._ends))
        return BankResult(J, s, q, early, results[:, :, :n])
