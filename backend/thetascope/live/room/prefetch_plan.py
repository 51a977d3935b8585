"""How many rows to compute ahead, and whether on the event loop or in a thread.

A call of `Session.advance` costs about the same for one row as for hundreds, so rows are computed for seconds and sent
frame by frame. A command makes the rows computed ahead void; right after one the look-ahead is short, and grows again.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from thetascope.live.room.playback_clock import FRAME, PlaybackClock
from thetascope.live.session.session import Session
from thetascope.live.session.snapshots import SimulatedRows
from thetascope.live.wire.frames import as_float32
from thetascope_schemas.service.session import Event

SHORTEST, LONGEST = 4 * FRAME, 8.0
"""Seconds of real time computed ahead: right after a command, and when nothing happens."""

LIGHT = 0.004
"""Seconds of work that the event loop may do itself in one go:
in a thread, Python's lock would block the others as long."""
PIECE = 0.002
"""Of these, seconds for the rows: a longer call is hardly cheaper per row, and commands wait longer."""
HALVES = 0.007
"""Seconds of work that the event loop may do in two halves, with commands and frames in between."""
SLICE = 0.010
"""Seconds of work in a thread, so that commands and other sessions do not wait long."""
MARGIN = 0.5
"""Seconds that may pass until the next rows are computed, as many sessions may ask at the same time."""


@dataclass(frozen=True)
class RowBatch:
    """Computed rows.

    Args:
        first: number of the first row.
        columns: names of the columns.
        rows: float32, columns × rows.
        events: the events in these rows.
        ended: whether no row can follow.
    """

    first: int
    columns: tuple[str, ...]
    rows: np.ndarray
    events: tuple[Event, ...]
    ended: bool


def compute(session: Session, rows: int, past: int) -> RowBatch:
    """Advance a session by up to `rows` rows; it keeps `past` bytes of samples."""
    return commit(session, session.simulate(rows), past)


def commit(session: Session, simulated: SimulatedRows | None, past: int) -> RowBatch:
    """Do the second half of :func:`compute`."""
    first = session.row
    data = session.commit(simulated)
    session.drop_oldest(max(1, past // (4 * len(session.columns))))
    return RowBatch(first, session.columns, as_float32(data), session.new_events(), session.ended)


class Cost:
    """The cost of a call of advance: a constant and a part per row, fitted to the calls so far."""

    _FORGET = 0.9
    _GROWTH = 4  # at most this many times the recent rows are requested: their cost is extrapolated

    def __init__(self) -> None:
        self._sums = [0.0] * 5  # weights, rows, seconds, rows², rows · seconds
        self._call = self._row = 0.0
        self._mean, self._took = 1000.0, 0.0  # rows and seconds of recent calls; initially a guess

    def measured(self, rows: int, seconds: float) -> None:
        """Add a call: its rows and its seconds."""
        terms = (1.0, rows, seconds, rows * rows, rows * seconds)
        n, x, y, xx, xy = self._sums = [self._FORGET * s + t for s, t in zip(self._sums, terms, strict=True)]
        spread = n * xx - x * x
        slope = (n * xy - x * y) / spread if spread > 1e-2 * xx * n else y / x  # y / x: all the cost is in the rows
        self._row = min(max(slope, 0.0), y / x)  # a larger one would make the call itself cheaper than nothing
        self._call = (y - self._row * x) / n
        self._mean, self._took = x / n, y / n

    def seconds(self, rows: int) -> float:
        """Return the seconds that a call for `rows` rows takes."""
        return self._call + rows * self._row

    def rows_surely(self, seconds: float) -> int:
        """Return the rows that take at most `seconds`, if a row costs no more in a longer call than in recent ones.

        While all calls are alike the fit cannot separate the cost of a call from that of its rows; without this
        estimate, short calls would stay short.
        """
        return int(min(seconds / self._took, self._GROWTH) * self._mean) if self._took > 0.0 else 0

    def rows(self, seconds: float) -> int:
        """Return the rows whose own part takes `seconds`; the constant part of the call comes in any case."""
        return max(1, int(min(seconds / max(self._row, 1e-9), self._GROWTH * self._mean)))


class PrefetchPlan:
    """How far to compute ahead in one session, from the cost of its rows so far."""

    def __init__(self) -> None:
        self._reach = SHORTEST
        self._cost = Cost()
        self._low = inf

    def disturbed(self) -> None:
        """Shorten the look-ahead: a command came with the rows of SHORTEST, and the next one may follow soon."""
        self._reach, self._low = 8 * SHORTEST, inf

    def measured(self, rows: int, seconds: float) -> None:
        """Add a call: its rows and its seconds."""
        if rows:
            self._cost.measured(rows, seconds)
            self._reach = min(LONGEST, 8 * self._reach)

    def soon(self, playback: PlaybackClock) -> int:
        """Return the rows to compute together with a command, for the first frames after it."""
        return min(playback.rows_in(SHORTEST), self._cost.rows(LIGHT))

    def enough(self, left: int) -> bool:
        """Return whether `left` rows are certainly enough for now: a cheap test for every frame."""
        return left > self._low

    def wanted(self, playback: PlaybackClock, left: int, most: int) -> tuple[int, bool] | None:
        """Return how many rows to compute, and whether in a thread; None if `left` rows are enough.

        Args:
            left: rows computed and not shown yet.
            most: rows that fit into one frame.
        """
        if playback.target is not None or playback.speed is None:
            rows = min(2 * most - left, self._cost.rows(SLICE))
            return (rows, True) if rows > 0 else None
        if left > self._low:
            return None
        frame = playback.rows_in(FRAME)
        long = self._cost.seconds(frame) > LIGHT
        piece = self._cost.rows(SLICE) if long else max(self._cost.rows(PIECE), self._cost.rows_surely(HALVES))
        whole = max(2 * frame, min(playback.rows_in(self._reach), 64 * most, piece))
        # Requested while there are still rows to show, so that it may wait for a free moment.
        self._low = max(frame + frame // 2, min(playback.rows_in(MARGIN), whole // 2))
        rows = min(whole - left, piece if long else whole)
        return (rows, long) if left <= self._low and rows > 0 else None

    def behind(self, playback: PlaybackClock, left: int) -> bool:
        """Return whether `left` rows are less than the next frame: a batch computed in a thread may be."""
        return playback.speed is not None and left < playback.rows_in(FRAME)
