"""Evidence and decisions along rows, a stretch at a time: the value `MonitorState` goes in and comes out.

Rows become decisions every ``stride`` rows, counted from t = 0, so what is decided does not depend on how a run is cut.
When something is found the filter is told, from that decision on; rows after it that it had already seen are taken again.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import LONGEST, WindowSums
from thetascope.diagnosis.isolation.decision_state import DecisionState, Evidence
from thetascope.diagnosis.isolation.decision_step import advance_decisions
from thetascope.diagnosis.residuals.backward_pass import BackwardPass
from thetascope.diagnosis.residuals.filter_bank import FilterBank
from thetascope.diagnosis.residuals.innovation_filter import LARGEST, InnovationFilter, Innovations
from thetascope.diagnosis.residuals.segment import Segment

_BLOCK = 256  # decisions looked at at once


@dataclass(frozen=True)
class MonitorState:
    """Where watching stands: decisions made, the filter after them, and what may be needed again.

    ``table`` and ``t``: what went into the filter since decision ``sums.first``, rows of a decision that is not yet
    complete included; ``states``: the filter at each decision from ``sums.first`` on.
    """

    decisions: DecisionState
    sums: WindowSums
    states: np.ndarray
    table: np.ndarray
    t: np.ndarray
    stride: int


class Monitor:
    """Watches one observer's rows with one filter and one calibration."""

    def __init__(self, filter_: InnovationFilter, thresholds: Thresholds, stride: int):
        self.filter, self.thresholds, self.stride = filter_, thresholds, stride
        self.bank, self.backward_pass = FilterBank(filter_), BackwardPass(filter_)

    def prepare(self) -> None:
        """Have at hand what naming needs: compiling takes up to a second."""
        self.bank.prepare()
        self.backward_pass.prepare()

    def begin(self) -> MonitorState:
        """Before the first row."""
        p, names = self.filter.p, max(1, len(self.filter.names))
        decisions = DecisionState.initial(self.thresholds, p, self.filter.m)
        return MonitorState(
            decisions,
            WindowSums.empty(p, self.filter.m),
            self.filter.start()[None, :],
            np.empty((0, names)),
            np.empty(0),
            self.stride,
        )

    def advance(self, state: MonitorState, table: np.ndarray, t: np.ndarray) -> MonitorState:
        """Take in more rows (`Filter.table`) and decide as far as they reach."""
        state = replace(state, table=np.concatenate([state.table, table]), t=np.concatenate([state.t, t]))
        while True:
            done = state.sums.last
            ready = state.sums.first + len(state.t) // self.stride
            if done >= ready:
                return self._trimmed(state)
            state = self._block(state, done, min(ready, done + _BLOCK))

    def _block(self, state: MonitorState, first: int, last: int) -> MonitorState:
        """Decisions ``first`` + 1 … ``last``, or up to one after which the filter must be told something."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        decisions = state.decisions
        innovations = self._segment(state, first, last, decisions.known.course).innovations(
            state.states[-1], decisions.trusted_outputs
        )
        count, begin = _finite(innovations, stride), (first - state.sums.first) * stride
        if count == 0:
            return self._restarted(state)
        innovations = Innovations(
            *(v[: count * stride] for v in (innovations.omega, innovations.nu, innovations.states))
        )
        y = self.filter.measured(state.table[max(begin - 1, 0) : begin + count * stride])
        y = y if begin else np.concatenate([y[:1] * np.nan, y])
        sums = state.sums.extended(
            innovations.omega.reshape(count, stride, m, p),
            innovations.nu.reshape(count, stride, m),
            decisions.trusted_outputs,
            y,
        )
        state = replace(
            state, sums=sums, states=np.concatenate([state.states, innovations.states[stride - 1 :: stride]])
        )
        decisions = advance_decisions(decisions, self._evidence(state))
        if decisions.restart is None:
            return replace(state, decisions=decisions)
        at = decisions.at
        states = state.states[: at - sums.first + 1].copy()
        if decisions.restart.states is not None:  # those before as well: what is looked at later may begin there
            states[-len(decisions.restart.states) :] = decisions.restart.states
        return replace(state, decisions=replace(decisions, restart=None), sums=sums.until(at), states=states)

    def _restarted(self, state: MonitorState) -> MonitorState:
        """Past a decision at which the filter has left what numbers hold (an outlier may do that): begun anew after it."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = state.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.thresholds.begin
        decisions = replace(state.decisions, at=at, start=at, next_attempt=at, detected=None, tentative=None)
        return replace(
            state, sums=sums, states=np.concatenate([state.states, self.filter.start()[None, :]]), decisions=decisions
        )

    def _evidence(self, state: MonitorState) -> Evidence:
        first = state.sums.first
        return Evidence(
            state.sums,
            self.thresholds,
            partial(self._segment, state),
            lambda d: state.states[d - first],
            self.filter,
            self.backward_pass,
            first,
            self.stride,
        )

    def _segment(
        self, state: MonitorState, first: int, last: int, known: Callable[[np.ndarray], np.ndarray]
    ) -> Segment:
        """The rows between decisions; what is known of θ is a function of time in decisions."""
        rows = slice((first - state.sums.first) * self.stride, (last - state.sums.first) * self.stride)
        return Segment(
            self.filter,
            self.bank,
            self.backward_pass,
            self.thresholds.bounds,
            self.stride,
            first,
            state.table[rows],
            state.t[rows],
            known,
        )

    def _trimmed(self, state: MonitorState) -> MonitorState:
        sums = state.sums.recent(LONGEST + 1)
        cut = sums.first - state.sums.first
        return replace(
            state,
            sums=sums,
            states=state.states[cut:],
            table=state.table[cut * self.stride :],
            t=state.t[cut * self.stride :],
        )


def _finite(innovations: Innovations, stride: int) -> int:
    """Decisions before the first with numbers that are none."""
    good = (
        ((np.abs(innovations.nu) < LARGEST).all(axis=1) & np.isfinite(innovations.states).all(axis=1))
        .reshape(-1, stride)
        .all(axis=1)
    )
    return len(good) if good.all() else int(np.argmin(good))
