"""Computing ahead: how many rows to ask a session for, and whether that may be done on the event loop.

A call of `Session.advance` costs about the same for one row as for hundreds, so rows are computed for seconds and sent
frame by frame. A command makes what was computed ahead void; right after one the look-ahead is short, and grows again.
"""

from dataclasses import dataclass

from backend.live.frames import narrowed
from backend.live.pacing import FRAME, Pace
from backend.live.session import Session
from shared.session import Event

SHORTEST, LONGEST = 4 * FRAME, 4.0
"""Seconds of real time that are computed ahead: right after a command, and when nothing happens."""

LIGHT = 0.003
"""Seconds of work that the event loop may do itself; handing it to a thread and back costs as much."""
SLICE = 0.008
"""Seconds of work that are done at once, so that a command or another session need not wait long."""


@dataclass(frozen=True)
class Computed:
    """Rows that were computed: columns × rows from row `first` on, float32, and what happened in them."""

    first: int
    columns: tuple[str, ...]
    rows: object
    events: list[Event]
    ended: bool


def compute(session: Session, rows: int) -> Computed:
    """Advance a session."""
    first = session.row
    data = session.advance(rows)
    return Computed(first, session.columns, narrowed(data), session.take_events(), session.ended)


class Lookahead:
    """How far to look ahead in one session, by what its rows have cost so far."""

    def __init__(self) -> None:
        self._reach = SHORTEST
        self._cost = LIGHT / 8  # seconds a row takes, the share of the call in it

    def disturbed(self) -> None:
        """A command came; the next may soon follow."""
        self._reach = SHORTEST

    def measured(self, rows: int, seconds: float) -> None:
        """So many rows took so long."""
        if rows:
            self._cost = seconds / rows
            self._reach = min(LONGEST, 2 * self._reach)

    def soon(self, pace: Pace) -> int:
        """Rows to compute with a command, so that the first frames after it are there at once."""
        return self._affordable(pace.rows_in(SHORTEST))

    def wanted(self, pace: Pace, left: int, most: int) -> tuple[int, bool] | None:
        """How many rows to compute, and whether in a thread; None: enough are `left`. `most`: rows of one frame."""
        if pace.target is not None or pace.speed is None:
            rows = 2 * most - left
            due = rows > 0
        else:
            frame = pace.rows_in(FRAME)
            whole = min(pace.rows_in(self._reach), 64 * most)
            rows = whole - left
            # What takes a thread is asked for while there is still something to show.
            due = left <= frame or (self._long(rows) and left < whole / 2)
        if not due or rows < 1:
            return None
        rows = self._affordable(rows)
        return rows, self._long(rows)

    def _affordable(self, rows: int) -> int:
        return max(1, min(rows, int(SLICE / self._cost)))

    def _long(self, rows: int) -> bool:
        return rows * self._cost > LIGHT
