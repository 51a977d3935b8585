"""Evidence and decisions along rows, a stretch at a time: the value `Watched` goes in and comes out.

Rows become decisions every ``stride`` rows, counted from t = 0, so what is decided does not depend on how a run is cut.
When something is found the filter is told, from that decision on; rows after it that it had already seen are taken again.
"""

from dataclasses import dataclass, replace

import numpy as np

from backend.diagnosis.ahead import Backwards
from backend.diagnosis.calibration import Calibrated
from backend.diagnosis.decisions import decide
from backend.diagnosis.evidence import Filter, Innovations
from backend.diagnosis.pauses import pause
from backend.diagnosis.standing import Look, Replay, Standing
from backend.diagnosis.supposing import Courses, Supposed, Supposing
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
        self.supposing, self.backwards = Supposing(filter_), Backwards(filter_)

    def prepare(self) -> None:
        """Have at hand what naming needs: compiling takes up to a second."""
        self.supposing.prepare()
        self.backwards.prepare()

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
        pause()
        standing = now.standing
        seen = self._over(now, first, last, now.states[-1], standing.known.course, standing.heed)
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
        if standing.change.states is not None:  # those before as well: what is looked at later may begin there
            states[-len(standing.change.states) :] = standing.change.states
        return replace(now, standing=replace(standing, change=None), sums=sums.until(at), states=states)

    def _restarted(self, now: Watched) -> Watched:
        """Past a decision at which the filter has left what numbers hold (an outlier may do that): begun anew after it."""
        p, m, stride = self.filter.p, self.filter.m, self.stride
        sums = now.sums.extended(np.zeros((1, stride, m, p)), np.zeros((1, stride, m)))
        at = sums.last + self.calibrated.begin
        standing = replace(now.standing, at=at, start=at, again=at, detected=None, pending=None)
        return replace(now, sums=sums, states=np.concatenate([now.states, self.filter.start()[None, :]]), standing=standing)

    def _look(self, now: Watched) -> Look:
        made, first, stride = self.filter, now.sums.first, self.stride

        def replay(state: np.ndarray, begin: int, at: int, known, heed: np.ndarray, fresh: bool) -> Replay:
            pause()
            state = made.unanswered(state) if fresh else state
            if begin == at:
                return Replay(np.zeros((1, made.m)), state[None], heed)
            seen = self._over(now, begin, at, state, known, heed)
            q = np.cumsum((seen.nu**2).reshape(at - begin, stride, -1).sum(axis=1), axis=0)
            q = np.concatenate([np.zeros((1, made.m)), q])
            return Replay(q, np.concatenate([state[None], seen.states[stride - 1 :: stride]]), heed)

        def suppose(states: np.ndarray, begin: int, known, courses: Courses, heed: np.ndarray, stops: np.ndarray) -> Supposed:
            pause()
            rows, d = self._rows(now, begin, begin + int(stops[-1]))
            return self.supposing.run(states, known(d), now.table[rows], now.t[rows], d, courses, heed, stops * stride)

        def handed(state: np.ndarray, begin: int, at: int, known, heed: np.ndarray) -> np.ndarray:
            pause()
            rows, d = self._rows(now, begin, at)
            return self.backwards.handed(state, self._within(known(d)), now.table[rows], now.t[rows], heed)

        return Look(now.sums, self.calibrated, replay, suppose, handed, lambda d: now.states[d - first], made, self.backwards, first, stride)

    def _rows(self, now: Watched, first: int, last: int) -> tuple[slice, np.ndarray]:
        """Where the rows of decisions are kept, and their times in decisions."""
        rows = slice((first - now.sums.first) * self.stride, (last - now.sums.first) * self.stride)
        return rows, np.arange(first * self.stride, last * self.stride) / self.stride

    def _within(self, course: np.ndarray) -> np.ndarray:
        return np.clip(course, self.calibrated.within.low, self.calibrated.within.high)

    def _over(self, now: Watched, first: int, last: int, state: np.ndarray, known, heed: np.ndarray) -> Innovations:
        """The filter along the rows of decisions; what is known of θ is a function of time in decisions."""
        rows, d = self._rows(now, first, last)
        seen = self.filter.run(state, self._within(known(d)), now.table[rows], now.t[rows], heed=heed)
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
