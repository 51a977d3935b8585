"""Run filter, tests and isolation over rows, block by block; the state is the value `MonitorState`.

`stride` rows, counted from t = 0, make a decision, so the result does not depend on how rows are grouped when they
arrive. When a decision changes θ₀ or the trusted outputs, the filter is restarted there, and later rows that it had
already processed are processed again.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import LONGEST, WindowSums
from thetascope.diagnosis.isolation.decision_state import DecisionState, Evidence
from thetascope.diagnosis.isolation.decision_step import advance_decisions
from thetascope.diagnosis.isolation.known_faults import BEFORE
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.filter_bank import FilterBank
from thetascope.diagnosis.residuals.innovation_filter import LARGEST, InnovationFilter, Innovations
from thetascope.diagnosis.residuals.scores import ScorePrograms
from thetascope.diagnosis.residuals.segment import Segment
from thetascope.diagnosis.yield_points import Steps

_BLOCK = 256  # decisions that are processed together


@dataclass(frozen=True)
class MonitorState:
    """The decisions so far, the filter after them, and the data that may be needed again.

    Attributes:
        decisions: detection and isolation after the last decision.
        sums: sums of evidence at the latest decisions.
        states: (decisions, filter states), the filter at each decision from `sums.first` on.
        table, t: (rows, filter inputs) and (rows,), the rows since decision `sums.first`, including those of an
            incomplete decision.
        stride: rows in one decision.
    """

    decisions: DecisionState
    sums: WindowSums
    states: np.ndarray
    table: np.ndarray
    t: np.ndarray
    stride: int


class Monitor:
    """Monitors rows with one filter and one set of thresholds."""

    def __init__(self, filter_: InnovationFilter, thresholds: Thresholds, stride: int):
        self.filter, self.thresholds, self.stride = filter_, thresholds, stride
        self.bank, self.backward_pass = FilterBank(filter_), BackwardPass(filter_)
        self.score_programs = ScorePrograms(self.backward_pass)

    def prepare(self) -> None:
        """Compile the kernels of isolation in advance: this takes up to a second."""
        self.bank.prepare()
        self.backward_pass.prepare()
        self.score_programs.prepare()

    def begin(self) -> MonitorState:
        """Return the state before the first row."""
        p, m, names = self.filter.p, self.filter.m, max(1, len(self.filter.names))
        decisions = DecisionState.initial(self.thresholds, p, m)
        first = self.filter.start()[None, :]
        return MonitorState(decisions, WindowSums.empty(p, m), first, np.empty((0, names)), np.empty(0), self.stride)

    def advance(self, state: MonitorState, table: np.ndarray, t: np.ndarray) -> Steps[MonitorState]:
        """Return the state after more rows, with all decisions that they complete.

        Args:
            state: the state so far.
            table: (rows, filter inputs), see `InnovationFilter.table`.
            t: (rows,), times in s.
        """
        state = replace(state, table=np.concatenate([state.table, table]), t=np.concatenate([state.t, t]))
        while True:
            first = state.sums.last
            complete = state.sums.first + len(state.t) // self.stride
            if first >= complete:
                return self._without_old_data(state)
            yield
            state = yield from self._advance_block(state, first, min(complete, first + _BLOCK))

    def _advance_block(self, state: MonitorState, first: int, last: int) -> Steps[MonitorState]:
        """Return the state after decisions `first` + 1 … `last`, or after the first of these that restarts the
        filter."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        decisions = state.decisions
        segment = self._segment(state, first, last, decisions.known.course)
        run = segment.innovations(state.states[-1], decisions.trusted_outputs)
        count, begin = _finite_decisions(run, stride), (first - state.sums.first) * stride
        if count == 0:
            return self._after_divergence(state)
        rows = count * stride
        y = self.filter.measured(state.table[max(begin - 1, 0) : begin + rows])
        y = y if begin else np.concatenate([y[:1] * np.nan, y])
        omega, nu = run.omega[:rows].reshape(count, stride, m, p), run.nu[:rows].reshape(count, stride, m)
        repeatable = self.filter.repeatable(state.table[begin : begin + rows])
        sums = state.sums.extended(omega, nu, decisions.trusted_outputs, y, repeatable)
        states = np.concatenate([state.states, run.states[stride - 1 : rows : stride]])
        state = replace(state, sums=sums, states=states)
        decisions = yield from advance_decisions(decisions, self._evidence(state))
        if decisions.restart is None:
            return replace(state, decisions=decisions)
        states = states[: decisions.at - sums.first + 1].copy()
        if decisions.restart.states is not None:  # earlier states too: a later replay may begin there
            states[-len(decisions.restart.states) :] = decisions.restart.states
        decisions = replace(decisions, restart=None)
        return replace(state, decisions=decisions, sums=sums.until(decisions.at), states=states)

    def _after_divergence(self, state: MonitorState) -> MonitorState:
        """Return the state one decision later with the filter started again, because it diverged there (after an
        outlier)."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = state.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.thresholds.begin
        decisions = replace(state.decisions, at=at, start=at, next_attempt=at, detected=None, tentative=None)
        states = np.concatenate([state.states, self.filter.start()[None, :]])
        return replace(state, sums=sums, states=states, decisions=decisions)

    def _evidence(self, state: MonitorState) -> Evidence:
        first = state.sums.first
        return Evidence(
            sums=state.sums,
            thresholds=self.thresholds,
            segment=partial(self._segment, state),
            filter_state=lambda decision: state.states[decision - first],
            filter=self.filter,
            backward_pass=self.backward_pass,
            oldest=first,
            rows_per_decision=self.stride,
        )

    def _segment(
        self, state: MonitorState, first: int, last: int, known: Callable[[np.ndarray], np.ndarray]
    ) -> Segment:
        """Return the rows between two decisions; `known`: θ₀ (times, p) as a function of times in decisions."""
        rows = slice((first - state.sums.first) * self.stride, (last - state.sums.first) * self.stride)
        return Segment(
            self.filter,
            self.bank,
            self.backward_pass,
            self.score_programs,
            self.thresholds.bounds,
            self.stride,
            first,
            state.table[rows],
            state.t[rows],
            known,
        )

    def _without_old_data(self, state: MonitorState) -> MonitorState:
        """Return the state without data older than the longest window and what has to be known before it."""
        sums = state.sums.recent(LONGEST + BEFORE + 1)
        cut = sums.first - state.sums.first
        rows = cut * self.stride
        return replace(state, sums=sums, states=state.states[cut:], table=state.table[rows:], t=state.t[rows:])


def _finite_decisions(run: Innovations, stride: int) -> int:
    """Return the number of decisions before the first with innovations or states that are not finite or far too
    large."""
    good_rows = (np.abs(run.nu) < LARGEST).all(axis=1) & np.isfinite(run.states).all(axis=1)
    good = np.asarray(np.asarray(good_rows).reshape(-1, stride).all(axis=1))
    return len(good) if good.all() else int(np.argmin(good))
