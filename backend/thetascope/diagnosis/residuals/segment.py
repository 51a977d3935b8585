"""A stretch of rows with what is known of θ along them, over which the filter is run again and again.

What goes into the filter is put together once for all these runs: they begin at different decisions, but the rows are the same.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.detection.window_tests import Range
from thetascope.diagnosis.residuals.backward_pass import Backwards
from thetascope.diagnosis.residuals.filter_bank import Courses, Supposed, Supposing
from thetascope.diagnosis.residuals.innovation_filter import Filter, Innovations, bounded
from thetascope.diagnosis.yield_points import once, pause


@dataclass(frozen=True)
class Replay:
    """The filter run again over decisions: the energy of all outputs and its states at each decision, the first included."""

    q: np.ndarray  # decisions + 1, m: from the first on
    states: np.ndarray
    heed: np.ndarray

    @property
    def energy(self) -> np.ndarray:
        """Of the outputs heeded, from the first decision on."""
        return self.q @ self.heed


class Stretch:
    """Rows ``table`` (rows × names) at times ``t`` that follow decision ``begin``, of which ``stride`` make a decision.

    ``known`` gives what is known of θ (times × p) at times in decisions, ``within`` its bounds.
    """

    def __init__(
        self,
        filter_: Filter,
        supposing: Supposing,
        backwards: Backwards,
        within: Range,
        stride: int,
        begin: int,
        table: np.ndarray,
        t: np.ndarray,
        known: Callable[[np.ndarray], np.ndarray],
    ):
        self._filter, self._supposing, self._backwards, self._within = filter_, supposing, backwards, within
        self._stride, self._begin, self._table, self._t = stride, begin, table, t
        self._d = np.arange(begin * stride, begin * stride + len(t)) / stride
        self.known = known(self._d)

    @once
    def _held(self) -> np.ndarray:
        return self._filter.held(np.clip(self.known, self._within.low, self._within.high), self._table)

    @once
    def _told(self) -> np.ndarray:
        return self._supposing.told(self.known, self._table, self._d)

    def _from(self, decision: int) -> int:
        return (decision - self._begin) * self._stride

    def innovations(self, state: np.ndarray, heed: np.ndarray) -> Innovations:
        """The filter along all rows, with numbers that can be squared and summed."""
        pause()
        seen = self._filter.along(state, self._held, self._t, heed)
        return Innovations(bounded(seen.omega), bounded(seen.nu), seen.states)

    def replay(self, state: np.ndarray, since: int, heed: np.ndarray, fresh: bool) -> Replay:
        """The filter from a decision to the end; ``fresh``: with V = 0."""
        pause()
        state, first = self._filter.unanswered(state) if fresh else state, self._from(since)
        rows = len(self._t) - first
        if not rows:
            return Replay(np.zeros((1, self._filter.m)), state[None], heed)
        seen = self._filter.along(state, self._held[first:], self._t[first:], heed)
        q = np.zeros((rows // self._stride + 1, self._filter.m))
        np.cumsum((bounded(seen.nu) ** 2).reshape(len(q) - 1, self._stride, -1).sum(axis=1), axis=0, out=q[1:])
        return Replay(q, np.concatenate([state[None], seen.states[self._stride - 1 :: self._stride]]), heed)

    def suppose(
        self, states: np.ndarray, since: int, courses: Courses, heed: np.ndarray, stops: np.ndarray
    ) -> Supposed:
        """The filter from a decision on under several suppositions (the first axis of ``states``), at so many decisions after it."""
        pause()
        rows = slice(self._from(since), self._from(since + int(stops[-1])))
        return self._supposing.run(states, self._told[rows], self._t[rows], courses, heed, stops * self._stride)

    def handed(self, state: np.ndarray, heed: np.ndarray) -> np.ndarray:
        """What the backward pass goes by, from the filter's ``state`` at the beginning."""
        pause()
        return self._backwards.handed(state, self._held, self._t, heed)
