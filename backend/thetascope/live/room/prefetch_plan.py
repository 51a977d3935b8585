"""Computing ahead: how many rows to ask a session for, and whether that may be done on the event loop.

A call of `Session.advance` costs about the same for one row as for hundreds, so rows are computed for seconds and sent
frame by frame. A command makes what was computed ahead void; right after one the look-ahead is short, and grows again.
"""

from dataclasses import dataclass
from math import inf

from thetascope.live.room.playback_clock import FRAME, PlaybackClock
from thetascope.live.session.session import Session
from thetascope.live.session.snapshots import SimulatedRows
from thetascope.live.wire.frames import as_float32
from thetascope_schemas.service.session import Event

SHORTEST, LONGEST = 4 * FRAME, 8.0
"""Seconds of real time that are computed ahead: right after a command, and when nothing happens."""

LIGHT = 0.004
"""Seconds of work that the event loop may do itself at once: in a thread, Python's lock would keep the others waiting as long."""
PIECE = 0.002
"""Of them, seconds for the rows: beyond that, a longer call is hardly cheaper by the row, and a command waits longer."""
HALVES = 0.007
"""Seconds of work that the event loop may do in two halves, with time for commands and frames between them."""
SLICE = 0.010
"""Seconds of work in a thread, so that a command or another session need not wait long."""
MARGIN = 0.5
"""Seconds that may pass until what is shown next has been computed, as many sessions may ask for it at the same time."""


@dataclass(frozen=True)
class RowBatch:
    """Rows that were computed: columns × rows from row `first` on, float32, and what happened in them."""

    first: int
    columns: tuple[str, ...]
    rows: object
    events: list[Event]
    ended: bool


def compute(session: Session, rows: int, past: int) -> RowBatch:
    """Advance a session, which is to keep `past` bytes of samples."""
    return completed(session, session.simulate(rows), past)


def completed(session: Session, begun: SimulatedRows | None, past: int) -> RowBatch:
    """The second half of that."""
    first = session.row
    data = session.commit(begun)
    session.history.forget(max(1, past // (4 * len(session.columns))))
    return RowBatch(first, session.columns, as_float32(data), session.new_events(), session.ended)


class Cost:
    """What a call of advance takes: a share of its own and one for each row, fitted to the calls so far."""

    _FORGET = 0.9
    _FURTHER = 4  # times as many rows as lately are asked for at most: what those cost is a guess

    def __init__(self) -> None:
        self._sums = [0.0] * 5  # weights, rows, seconds, rows², rows · seconds
        self._call = self._row = 0.0
        self._mean, self._took = 1000.0, 0.0  # rows and seconds of a call lately; to begin with, a guess

    def measured(self, rows: int, seconds: float) -> None:
        """So many rows took so long."""
        terms = (1.0, rows, seconds, rows * rows, rows * seconds)
        n, x, y, xx, xy = self._sums = [self._FORGET * s + t for s, t in zip(self._sums, terms, strict=True)]
        spread = n * xx - x * x
        slope = (
            (n * xy - x * y) / spread if spread > 1e-2 * xx * n else y / x
        )  # the most it can be, where nothing tells
        self._row = min(max(slope, 0.0), y / x)  # beyond that the call itself would cost less than nothing
        self._call = (y - self._row * x) / n
        self._mean, self._took = x / n, y / n

    def seconds(self, rows: int) -> float:
        return self._call + rows * self._row

    def surely(self, seconds: float) -> int:
        """Rows that take no longer, if longer calls are no dearer by the row than those lately.

        The fit cannot tell what the call costs from what its rows do while all calls are alike, and asked for few rows it would
        go on asking for few.
        """
        return int(min(seconds / self._took, self._FURTHER) * self._mean) if self._took > 0.0 else 0

    def rows(self, seconds: float) -> int:
        """Rows whose own share takes so long; the call itself has to be paid anyway."""
        return max(1, int(min(seconds / max(self._row, 1e-9), self._FURTHER * self._mean)))


class PrefetchPlan:
    """How far to look ahead in one session, by what its rows have cost so far."""

    def __init__(self) -> None:
        self._reach = SHORTEST
        self._cost = Cost()
        self._low = inf

    def disturbed(self) -> None:
        """A command came, and the rows of SHORTEST are computed with it; the next command may soon follow."""
        self._reach, self._low = 8 * SHORTEST, inf

    def measured(self, rows: int, seconds: float) -> None:
        """So many rows took so long."""
        if rows:
            self._cost.measured(rows, seconds)
            self._reach = min(LONGEST, 8 * self._reach)

    def soon(self, playback: PlaybackClock) -> int:
        """Rows to compute with a command, so that the first frames after it are there at once."""
        return min(playback.rows_in(SHORTEST), self._cost.rows(LIGHT))

    def enough(self, left: int) -> bool:
        """Whether so many rows are enough for now, whatever else is asked: a quick answer for every frame."""
        return left > self._low

    def wanted(self, playback: PlaybackClock, left: int, most: int) -> tuple[int, bool] | None:
        """How many rows to compute, and whether in a thread; None: enough are `left`. `most`: rows of one frame."""
        if playback.target is not None or playback.speed is None:
            rows = min(2 * most - left, self._cost.rows(SLICE))
            return (rows, True) if rows > 0 else None
        if left > self._low:
            return None
        frame = playback.rows_in(FRAME)
        long = self._cost.seconds(frame) > LIGHT
        piece = self._cost.rows(SLICE) if long else max(self._cost.rows(PIECE), self._cost.surely(HALVES))
        whole = max(2 * frame, min(playback.rows_in(self._reach), 64 * most, piece))
        # Asked for while there is still something to show, so that it may wait for a free moment.
        self._low = max(frame + frame // 2, min(playback.rows_in(MARGIN), whole // 2))
        rows = min(whole - left, piece if long else whole)
        return (rows, long) if left <= self._low and rows > 0 else None

    def behind(self, playback: PlaybackClock, left: int) -> bool:
        """Whether ``left`` rows are not even the next frame: a piece in a thread may be less than that."""
        return playback.speed is not None and playback.playing and left < playback.rows_in(FRAME)
