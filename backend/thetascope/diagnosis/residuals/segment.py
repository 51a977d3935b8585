"""A stretch of rows with what is known of θ along them, over which the filter is run again and again.

What goes into the filter is put together once for all these runs: they begin at different decisions, but the rows are the same.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.detection.window_tests import ThetaBounds
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.filter_bank import BankResult, FilterBank, HypothesisCourses
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter, Innovations, bounded
from thetascope.diagnosis.yield_points import once, pause


@dataclass(frozen=True)
class ReplayResult:
    """The filter run again over decisions: the energy of all outputs and its states at each decision, the first included."""

    q: np.ndarray  # decisions + 1, m: from the first on
    states: np.ndarray
    trusted_outputs: np.ndarray

    @property
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the first decision on."""
        return self.q @ self.trusted_outputs


class Segment:
    """Rows ``table`` (rows × names) at times ``t`` that follow decision ``begin``, of which ``stride`` make a decision.

    ``known`` gives what is known of θ (times × p) at times in decisions, ``bounds`` its bounds.
    """

    def __init__(
        self,
        filter_: InnovationFilter,
        bank: FilterBank,
        backward_pass: BackwardPass,
        bounds: ThetaBounds,
        stride: int,
        begin: int,
        table: np.ndarray,
        t: np.ndarray,
        known: Callable[[np.ndarray], np.ndarray],
    ):
        self._filter, self._bank, self._backward_pass, self._bounds = filter_, bank, backward_pass, bounds
        self._stride, self._begin, self._table, self._t = stride, begin, table, t
        self._d = np.arange(begin * stride, begin * stride + len(t)) / stride
        self.known = known(self._d)

    @once
    def _held(self) -> np.ndarray:
        return self._filter.held(np.clip(self.known, self._bounds.low, self._bounds.high), self._table)

    @once
    def _bank_inputs(self) -> np.ndarray:
        return self._bank.row_inputs(self.known, self._table, self._d)

    def _from(self, decision: int) -> int:
        return (decision - self._begin) * self._stride

    def innovations(self, state: np.ndarray, trusted_outputs: np.ndarray) -> Innovations:
        """The filter along all rows, with numbers that can be squared and summed."""
        pause()
        seen = self._filter.run_held(state, self._held, self._t, trusted_outputs)
        return Innovations(bounded(seen.omega), bounded(seen.nu), seen.states)

    def replay(self, state: np.ndarray, since: int, trusted_outputs: np.ndarray, fresh: bool) -> ReplayResult:
        """The filter from a decision to the end; ``fresh``: with V = 0."""
        pause()
        state, first = self._filter.without_sensitivity(state) if fresh else state, self._from(since)
        rows = len(self._t) - first
        if not rows:
            return ReplayResult(np.zeros((1, self._filter.m)), state[None], trusted_outputs)
        seen = self._filter.run_held(state, self._held[first:], self._t[first:], trusted_outputs)
        q = np.zeros((rows // self._stride + 1, self._filter.m))
        np.cumsum((bounded(seen.nu) ** 2).reshape(len(q) - 1, self._stride, -1).sum(axis=1), axis=0, out=q[1:])
        return ReplayResult(
            q, np.concatenate([state[None], seen.states[self._stride - 1 :: self._stride]]), trusted_outputs
        )

    def run_bank(
        self, states: np.ndarray, since: int, courses: HypothesisCourses, trusted_outputs: np.ndarray, stops: np.ndarray
    ) -> BankResult:
        """The filter from a decision on under several suppositions (the first axis of ``states``), at so many decisions after it."""
        pause()
        rows = slice(self._from(since), self._from(since + int(stops[-1])))
        return self._bank.run(
            states, self._bank_inputs[rows], self._t[rows], courses, trusted_outputs, stops * self._stride
        )

    def backward_inputs(self, state: np.ndarray, trusted_outputs: np.ndarray) -> np.ndarray:
        """What the backward pass goes by, from the filter's ``state`` at the beginning."""
        pause()
        return self._backward_pass.backward_inputs(state, self._held, self._t, trusted_outputs)
