"""Evidence and decisions along rows, a stretch at a time: the value `Watched` goes in and comes out.

Rows become decisions every ``stride`` rows, counted from t = 0, so what is decided does not depend on how a run is cut.
When something is found the filter is told, from that decision on; rows after it that it had already seen are taken again.
"""

from dataclasses import dataclass, replace

import numpy as np

from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.decisions import decide
from backend.diagnosis.evidence import Filter, Innovations
from backend.diagnosis.standing import Answer, Change, Look, Standing
from backend.diagnosis.windows import LONGEST, Sums

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

    def begin(self) -> Watched:
        """Before the first row."""
        p, names = self.filter.p, max(1, len(self.filter.names))
        standing = Standing.beginning(self.calibrated, p)
        return Watched(standing, Sums.none(p, self.filter.m), self.filter.start()[None, :], np.empty((0, names)), np.empty(0),
                       self.stride)  # fmt: skip

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
        seen = self._over(now, first, last, now.states[-1], now.standing.known)
        count = _finite(seen.nu, seen.states, stride)
        if count == 0:
            return self._restarted(now)
        seen = Innovations(*(v[: count * stride] for v in (seen.omega, seen.nu, seen.states)))
        sums = now.sums.extended(seen.omega.reshape(count, stride, m, p), seen.nu.reshape(count, stride, m))
        states = np.concatenate([now.states, seen.states[stride - 1 :: stride]])
        now = replace(now, sums=sums, states=states)
        known = now.standing.known
        look = Look(sums, self.calibrated, lambda onset, at: self._answer(now, onset, at, known), sums.first, stride * m)
        standing = decide(now.standing, look)
        if standing.change is None:
            return replace(now, standing=standing)
        at = standing.at
        states = states[: at - sums.first + 1].copy()
        states[-1] = self._told(states[-1], standing.change)
        return replace(now, standing=replace(standing, change=None), sums=sums.until(at), states=states)

    def _restarted(self, now: Watched) -> Watched:
        """Past a decision at which the filter has left what numbers hold (an outlier may do that): begun anew after it."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = now.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.calibrated.begin
        standing = replace(now.standing, at=at, start=at, again=at, detected=None)
        return replace(now, sums=sums, states=np.concatenate([now.states, self.filter.start()[None, :]]), standing=standing)

    def _over(self, now: Watched, first: int, last: int, state: np.ndarray, known: np.ndarray):
        rows = slice((first - now.sums.first) * self.stride, (last - now.sums.first) * self.stride)
        return self.filter.run(state, known, now.table[rows], now.t[rows])

    def _answer(self, now: Watched, onset: int, at: int, known: np.ndarray) -> Answer:
        """The filter run again from an onset with V = 0.

        Where watching begins V is left as it is, begun with zero at t = 0: a fault may have been there from the start.
        """
        state = now.states[onset - now.sums.first]
        if onset != self.calibrated.begin:
            state = self.filter.unanswered(state)
        seen = self._over(now, onset, at, state, known)
        omega, nu = seen.omega.reshape(-1, self.filter.p), seen.nu.ravel()
        return Answer(omega.T @ omega, omega.T @ nu, float(nu @ nu), self.filter.answers(seen.states[-1]))

    def _told(self, state: np.ndarray, change: Change) -> np.ndarray:
        V = self.filter.answers(state) if change.V is None else change.V
        return self.filter.knowing(state, V, change.size)

    def _trimmed(self, now: Watched) -> Watched:
        sums = now.sums.recent(LONGEST + 1)
        cut = sums.first - now.sums.first
        return replace(now, sums=sums, states=now.states[cut:], table=now.table[cut * self.stride :],
                       t=now.t[cut * self.stride :])  # fmt: skip


def _finite(nu: np.ndarray, states: np.ndarray, stride: int) -> int:
    """Decisions before the first with a number that is none."""
    good = (np.isfinite(nu).all(axis=1) & np.isfinite(states).all(axis=1)).reshape(-1, stride).all(axis=1)
    return len(good) if good.all() else int(np.argmin(good))
