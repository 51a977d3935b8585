"""Evidence and decisions along rows, a stretch at a time: the value `Watched` goes in and comes out.

Rows become decisions every ``stride`` rows, counted from t = 0, so what is decided does not depend on how a run is cut.
When something is found the filter is told, from that decision on; rows after it that it had already seen are taken again.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from thetascope.diagnosis.detection.thresholds import Calibrated
from thetascope.diagnosis.detection.window_tests import LONGEST, Sums
from thetascope.diagnosis.isolation.decision_state import Look, Standing
from thetascope.diagnosis.isolation.decision_step import decide
from thetascope.diagnosis.residuals.backward_pass import Backwards
from thetascope.diagnosis.residuals.filter_bank import Supposing
from thetascope.diagnosis.residuals.innovation_filter import LARGEST, Filter, Innovations
from thetascope.diagnosis.residuals.segment import Stretch

_BLOCK = 256  # decisions looked at at once


@dataclass(frozen=True)
class Watched:
    """Where watching stands: decisions made, the filter after them, and what may be needed again.

    ``table`` and ``t``: what went into the filter since decision ``sums.first``, rows of a decision that is not yet
    complete included; ``states``: the filter at each decision from ``sums.first`` on.
    """

    standing: Standing
    sums: Sums
    states: np.ndarray
    table: np.ndarray
    t: np.ndarray
    stride: int


class Watcher:
    """Watches one observer's rows with one filter and one calibration."""

    def __init__(self, filter_: Filter, calibrated: Calibrated, stride: int):
        self.filter, self.calibrated, self.stride = filter_, calibrated, stride
        self.supposing, self.backwards = Supposing(filter_), Backwards(filter_)

    def prepare(self) -> None:
        """Have at hand what naming needs: compiling takes up to a second."""
        self.supposing.prepare()
        self.backwards.prepare()

    def begin(self) -> Watched:
        """Before the first row."""
        p, names = self.filter.p, max(1, len(self.filter.names))
        standing = Standing.beginning(self.calibrated, p, self.filter.m)
        return Watched(
            standing,
            Sums.none(p, self.filter.m),
            self.filter.start()[None, :],
            np.empty((0, names)),
            np.empty(0),
            self.stride,
        )

    def advance(self, watched: Watched, table: np.ndarray, t: np.ndarray) -> Watched:
        """Take in more rows (`Filter.table`) and decide as far as they reach."""
        now = replace(watched, table=np.concatenate([watched.table, table]), t=np.concatenate([watched.t, t]))
        while True:
            done = now.sums.last
            ready = now.sums.first + len(now.t) // self.stride
            if done >= ready:
                return self._trimmed(now)
            now = self._block(now, done, min(ready, done + _BLOCK))

    def _block(self, now: Watched, first: int, last: int) -> Watched:
        """Decisions ``first`` + 1 … ``last``, or up to one after which the filter must be told something."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        standing = now.standing
        seen = self._stretch(now, first, last, standing.known.course).innovations(now.states[-1], standing.heed)
        count, begin = _finite(seen, stride), (first - now.sums.first) * stride
        if count == 0:
            return self._restarted(now)
        seen = Innovations(*(v[: count * stride] for v in (seen.omega, seen.nu, seen.states)))
        y = self.filter.measured(now.table[max(begin - 1, 0) : begin + count * stride])
        y = y if begin else np.concatenate([y[:1] * np.nan, y])
        sums = now.sums.extended(
            seen.omega.reshape(count, stride, m, p), seen.nu.reshape(count, stride, m), standing.heed, y
        )
        now = replace(now, sums=sums, states=np.concatenate([now.states, seen.states[stride - 1 :: stride]]))
        standing = decide(standing, self._look(now))
        if standing.change is None:
            return replace(now, standing=standing)
        at = standing.at
        states = now.states[: at - sums.first + 1].copy()
        if standing.change.states is not None:  # those before as well: what is looked at later may begin there
            states[-len(standing.change.states) :] = standing.change.states
        return replace(now, standing=replace(standing, change=None), sums=sums.until(at), states=states)

    def _restarted(self, now: Watched) -> Watched:
        """Past a decision at which the filter has left what numbers hold (an outlier may do that): begun anew after it."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = now.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.calibrated.begin
        standing = replace(now.standing, at=at, start=at, again=at, detected=None, pending=None)
        return replace(
            now, sums=sums, states=np.concatenate([now.states, self.filter.start()[None, :]]), standing=standing
        )

    def _look(self, now: Watched) -> Look:
        made, first, stride = self.filter, now.sums.first, self.stride

        return Look(
            now.sums,
            self.calibrated,
            partial(self._stretch, now),
            lambda d: now.states[d - first],
            made,
            self.backwards,
            first,
            stride,
        )

    def _stretch(self, now: Watched, first: int, last: int, known: Callable[[np.ndarray], np.ndarray]) -> Stretch:
        """The rows between decisions; what is known of θ is a function of time in decisions."""
        rows = slice((first - now.sums.first) * self.stride, (last - now.sums.first) * self.stride)
        return Stretch(
            self.filter,
            self.supposing,
            self.backwards,
            self.calibrated.within,
            self.stride,
            first,
            now.table[rows],
            now.t[rows],
            known,
        )

    def _trimmed(self, now: Watched) -> Watched:
        sums = now.sums.recent(LONGEST + 1)
        cut = sums.first - now.sums.first
        return replace(
            now, sums=sums, states=now.states[cut:], table=now.table[cut * self.stride :], t=now.t[cut * self.stride :]
        )


def _finite(seen: Innovations, stride: int) -> int:
    """Decisions before the first with numbers that are none."""
    good = (
        ((np.abs(seen.nu) < LARGEST).all(axis=1) & np.isfinite(seen.states).all(axis=1)).reshape(-1, stride).all(axis=1)
    )
    return len(good) if good.all() else int(np.argmin(good))
