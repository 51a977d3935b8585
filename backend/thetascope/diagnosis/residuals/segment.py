"""A segment of rows, with θ₀ along it, over which the filter is run many times.

The filter's inputs are assembled once for all these runs: they begin at different decisions, but the rows are the same.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thetascope.diagnosis.detection.window_tests import ThetaBounds
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.filter_bank import BankResult, FilterBank, HypothesisCourses
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, Innovations, bounded
from thetascope.diagnosis.residuals.scores import LinearisedFilter, ScorePrograms


@dataclass(frozen=True)
class ReplayResult:
    """The filter run over decisions once more.

    Attributes:
        q: (decisions + 1, m), energy of the innovations of each output from the first decision on; q[0] = 0.
        states: (decisions + 1, filter states), the filter at each decision, the first included.
        trusted_outputs: (m,), the outputs that the filter used.
    """

    q: np.ndarray
    states: np.ndarray
    trusted_outputs: np.ndarray

    @property
    def energy(self) -> np.ndarray:
        """(decisions + 1,), the energy of the trusted outputs from the first decision on."""
        return self.q @ self.trusted_outputs


class Segment:
    """Rows that follow a decision.

    Args:
        filter_, bank, backward_pass, score_programs: the filter, and the programs derived from it.
        bounds: bounds of θ.
        stride: rows in one decision.
        begin: the decision before the first row.
        table: (rows, inputs of the filter), see `InnovationFilter.table`.
        t: (rows,), times in s.
        known: θ₀ (times, p) as a function of times in decisions.
    """

    def __init__(
        self,
        filter_: InnovationFilter,
        bank: FilterBank,
        backward_pass: BackwardPass,
        score_programs: ScorePrograms,
        bounds: ThetaBounds,
        stride: int,
        begin: int,
        table: np.ndarray,
        t: np.ndarray,
        known: Callable[[np.ndarray], np.ndarray],
    ):
        self._filter, self._bank, self._backward_pass, self._bounds = filter_, bank, backward_pass, bounds
        self._score_programs = score_programs
        self._stride, self._begin, self._table, self._t = stride, begin, table, t
        self._d = np.arange(begin * stride, begin * stride + len(t)) / stride
        self.known = known(self._d)

    @cached_property
    def _held(self) -> np.ndarray:
        return self._filter.held(np.clip(self.known, self._bounds.low, self._bounds.high), self._table)

    @cached_property
    def _bank_inputs(self) -> np.ndarray:
        return self._bank.row_inputs(self.known, self._table, self._d)

    def _first_row(self, decision: int) -> int:
        return (decision - self._begin) * self._stride

    def innovations(self, state: np.ndarray, trusted_outputs: np.ndarray) -> Innovations:
        """Run the filter over all rows from `state`; values are clipped so that their squares are finite."""
        run = self._filter.run_held(state, self._held, self._t, trusted_outputs)
        return Innovations(bounded(run.omega), bounded(run.nu), run.states)

    def replay(self, state: np.ndarray, since: int, trusted_outputs: np.ndarray, fresh: bool) -> ReplayResult:
        """Run the filter from decision `since` to the end; `fresh`: with V = 0, as if faults began there."""
        state, first = self._filter.without_sensitivity(state) if fresh else state, self._first_row(since)
        rows = len(self._t) - first
        if not rows:
            return ReplayResult(np.zeros((1, self._filter.m)), state[None], trusted_outputs)
        run = self._filter.run_held(state, self._held[first:], self._t[first:], trusted_outputs)
        q = np.zeros((rows // self._stride + 1, self._filter.m))
        np.cumsum((bounded(run.nu) ** 2).reshape(len(q) - 1, self._stride, -1).sum(axis=1), axis=0, out=q[1:])
        states = np.concatenate([state[None], run.states[self._stride - 1 :: self._stride]])
        return ReplayResult(q, states, trusted_outputs)

    def run_bank(
        self,
        states: np.ndarray,
        since: int,
        courses: HypothesisCourses,
        trusted_outputs: np.ndarray,
        stops: np.ndarray,
    ) -> BankResult:
        """Run the filter bank from decision `since` on.

        Args:
            states: (hypotheses, filter states), where each begins.
            since: the decision at which they begin.
            courses: the assumed course of θ of each hypothesis.
            trusted_outputs: (m,), the outputs that the filters use.
            stops: (times,), numbers of decisions after which results are returned, ascending.
        """
        rows = slice(self._first_row(since), self._first_row(since + int(stops[-1])))
        return self._bank.run(
            states, self._bank_inputs[rows], self._t[rows], courses, trusted_outputs, stops * self._stride
        )

    def backward_inputs(self, state: np.ndarray, trusted_outputs: np.ndarray) -> np.ndarray:
        """Return the inputs of the backward pass over all rows, the filter having begun in `state`."""
        return self._backward_pass.backward_inputs(state, self._held, self._t, trusted_outputs)

    def linearised(self, state: np.ndarray, change: np.ndarray, trusted_outputs: np.ndarray) -> LinearisedFilter:
        """Return the filter under a hypothesis.

        Args:
            state: the filter's state before the first row.
            change: (rows, p), the hypothesis: θ less the known θ₀.
            trusted_outputs: (m,), the outputs that the filter uses.
        """
        known = np.clip(self.known + change, self._bounds.low, self._bounds.high)
        held, fresh = self._filter.held(known, self._table), self._filter.without_sensitivity(state)
        inputs = self._backward_pass.backward_inputs(fresh, held, self._t, trusted_outputs)
        return LinearisedFilter(self._score_programs, inputs, self._t, trusted_outputs)

    @property
    def times(self) -> np.ndarray:
        """Return the times (rows,) of all rows in decisions."""
        return self._d
