"""Evidence and decisions along rows, a stretch at a time: the value `Watched` goes in and comes out.

Rows become decisions every ``stride`` rows, counted from t = 0, so what is decided does not depend on how a run is cut.
When something is found the filter is told, from that decision on; rows after it that it had already seen are taken again.
"""

from dataclasses import dataclass, replace

import numpy as np

from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.decisions import decide
from backend.diagnosis.evidence import Filter, Innovations
from backend.diagnosis.standing import Look, Replay, Standing
from backend.diagnosis.windows import LONGEST, Sums

_BLOCK = 256  # decisions looked at at once
_LARGEST = 1e60  # standard deviations: an innovation as large is a filter that is lost


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
        standing = Standing.beginning(self.calibrated, p, self.filter.m)
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
        standing = now.standing
        seen = self._over(now, first, last, now.states[-1], standing.known.course, None, standing.heed)
        count, begin = _finite(seen, stride), (first - now.sums.first) * stride
        if count == 0:
            return self._restarted(now)
        seen = Innovations(*(v[: count * stride] for v in (seen.omega, seen.nu, seen.states)))
        y = self.filter.measured(now.table[max(begin - 1, 0) : begin + count * stride])
        y = y if begin else np.concatenate([y[:1] * np.nan, y])
        sums = now.sums.extended(seen.omega.reshape(count, stride, m, p), seen.nu.reshape(count, stride, m), standing.heed, y)
        now = replace(now, sums=sums, states=np.concatenate([now.states, seen.states[stride - 1 :: stride]]))
        standing = decide(standing, self._look(now))
        if standing.change is None:
            return replace(now, standing=standing)
        at = standing.at
        states = now.states[: at - sums.first + 1].copy()
        if standing.change.state is not None:  # V goes on as it was: it answers what has been there for long
            states[-1] = self.filter.with_answers(standing.change.state, self.filter.answers(states[-1]))
        return replace(now, standing=replace(standing, change=None), sums=sums.until(at), states=states)

    def _restarted(self, now: Watched) -> Watched:
        """Past a decision at which the filter has left what numbers hold (an outlier may do that): begun anew after it."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = now.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.calibrated.begin
        standing = replace(now.standing, at=at, start=at, again=at, detected=None, pending=None)
        return replace(now, sums=sums, states=np.concatenate([now.states, self.filter.start()[None, :]]), standing=standing)

    def _look(self, now: Watched) -> Look:
        def replay(state: np.ndarray, begin: int, at: int, known, profile, heed: np.ndarray, fresh: bool) -> Replay:
            state = self.filter.unanswered(state) if fresh else state
            if begin == at:
                p, m = self.filter.p, self.filter.m
                return Replay(np.zeros((p, p)), np.zeros(p), np.zeros((1, m)), state[None], heed, np.zeros(p))
            seen = self._over(now, begin, at, state, known, profile, heed)
            omega, nu = (seen.omega * heed[:, None]).reshape(-1, self.filter.p), (seen.nu * heed).ravel()
            q = np.cumsum((seen.nu**2).reshape(at - begin, self.stride, -1).sum(axis=1), axis=0)
            q = np.concatenate([np.zeros((1, self.filter.m)), q])
            states = np.concatenate([state[None], seen.states[self.stride - 1 :: self.stride]])
            early = omega[: 2 * self.calibrated.settle * self.stride * self.filter.m]
            return Replay(omega.T @ omega, omega.T @ nu, q, states, heed, (early**2).sum(axis=0))

        first = now.sums.first
        return Look(now.sums, self.calibrated, replay, lambda d: now.states[d - first], self.filter.moved, first, self.stride, self.filter.patience)

    def _over(self, now: Watched, first: int, last: int, state: np.ndarray, known, profile, heed: np.ndarray) -> Innovations:
        """The filter along the rows of decisions; θ₀ and the profile are functions of time in decisions."""
        rows = slice((first - now.sums.first) * self.stride, (last - now.sums.first) * self.stride)
        d = np.arange(first * self.stride, last * self.stride) / self.stride
        within = self.calibrated.within
        course = np.clip(known(d), within.low, within.high)
        seen = self.filter.run(state, course, now.table[rows], now.t[rows], None if profile is None else profile(d), heed)
        return replace(seen, omega=_bounded(seen.omega), nu=_bounded(seen.nu))

    def _trimmed(self, now: Watched) -> Watched:
        sums = now.sums.recent(LONGEST + 1)
        cut = sums.first - now.sums.first
        return replace(now, sums=sums, states=now.states[cut:], table=now.table[cut * self.stride :],
                       t=now.t[cut * self.stride :])  # fmt: skip


def _bounded(values: np.ndarray) -> np.ndarray:
    """With numbers that can be squared and summed."""
    if np.abs(values).max(initial=0.0) < _LARGEST:
        return values
    return np.clip(np.nan_to_num(values, nan=_LARGEST), -_LARGEST, _LARGEST)


def _finite(seen: Innovations, stride: int) -> int:
    """Decisions before the first with numbers that are none."""
    good = ((np.abs(seen.nu) < _LARGEST).all(axis=1) & np.isfinite(seen.states).all(axis=1)).reshape(-1, stride).all(axis=1)
    return len(good) if good.all() else int(np.argmin(good))
