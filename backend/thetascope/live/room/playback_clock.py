"""When each row is due: a session's clock as arithmetic. It never sleeps and never reads a clock itself.

A row is due when the session's time has reached it: speed / record rows per second of real time. If the simulation is
slower than the speed that is set, the clock is set back to the rows there are, so that it never rushes to catch up.
"""

from collections.abc import Callable
from math import ceil, floor, inf

from thetascope.live.room.room_state import RoomMachine, Transition

FRAME = 1 / 30
"""Seconds between frames."""

_ROUNDING = 1e-6  # of a row: tolerance for the rounding of times


class PlaybackClock:
    """The clock of one session. Rows are counted: row `due` − 1 is the last one due. Times in s.

    Args:
        record: time between rows, s.
        machine: the state of the room, which says whether time runs.
    """

    def __init__(self, record: float, machine: RoomMachine) -> None:
        self.record = record
        self.speed: float | None = 1.0
        self._machine = machine
        self._target = 0  # the row count at which single steps end
        self._rows = 0.0  # at the time _since
        self._since = 0.0

    def play(self, rows: int, now: float) -> None:
        """Let time run from `rows` rows on."""
        self._machine.fire(Transition.PLAY)
        self.anchor(rows, now)

    def pause(self) -> None:
        """Stop time."""
        self._machine.fire(Transition.PAUSE)

    def step(self, shown: int, rows: int) -> None:
        """Advance by `rows` rows as fast as possible, then stop; steps add up. `shown`: rows shown so far."""
        self._target = (self.target or shown) + rows
        self._machine.fire(Transition.STEP)

    @property
    def target(self) -> int | None:
        """The row count at which single steps end; None if no step is under way."""
        return self._target if self._machine.stepping else None

    def set_speed(self, speed: float | None, rows: int, now: float) -> None:
        """Set the simulated seconds per second from now on; None is as fast as possible."""
        position = self._position(now) if self._machine.playing and self.speed is not None else float(rows)
        self.speed, self._rows, self._since = speed, position, now

    def anchor(self, rows: float, now: float) -> None:
        """Set the clock so that exactly `rows` rows are due now."""
        self._rows, self._since = float(rows), now

    def due(self, now: float) -> float:
        """Return how many rows are due by now; infinity if as fast as possible."""
        target = self.target
        if target is not None:
            return target
        if not self._machine.playing:
            return 0
        return inf if self.speed is None else floor(self._position(now) + _ROUNDING)

    def reached(self, rows: int) -> bool:
        """Return whether a step ends because `rows` rows are shown."""
        target = self.target
        if target is None or rows < target:
            return False
        self._machine.fire(Transition.REACH)
        return True

    def next(self, rows: int, before: float, now: float) -> float | None:
        """Return when to show rows again after a frame that was due at `before`; None if time does not run.

        Frames keep their rhythm whatever the delay of one of them;
        where rows are rarer than frames, the next row decides.

        Args:
            rows: rows shown so far.
        """
        if not self._machine.moving:
            return None
        regular = before + FRAME * (1 + max(0, floor((now - before) / FRAME)))
        if self._machine.stepping or self.speed is None:
            return regular
        next_row = self._since + (rows + 1 - self._rows) * self.record / self.speed
        return next_row if next_row > regular + FRAME else regular

    def rows_in(self, seconds: float) -> int:
        """Return the rows due in this much real time, at least one. Only for a speed that is set."""
        return max(1, ceil(seconds * (self.speed or 1.0) / self.record))

    def _position(self, now: float) -> float:
        return self._rows + (now - self._since) * (self.speed or 0.0) / self.record


class MeasuredSpeed:
    """Simulated seconds per second, measured between two updates."""

    def __init__(self) -> None:
        self._rows, self._at = 0, -inf
        self.value: float | None = None

    def start(self, rows: int, now: float) -> None:
        """Measure from here on."""
        self._rows, self._at, self.value = rows, now, None

    def update(self, rows: int, now: float, record: float) -> float | None:
        """Return the speed since the last update; `record`: time between rows, s."""
        if now > self._at and rows >= self._rows:
            self.value = (rows - self._rows) * record / (now - self._at)
        self._rows, self._at = rows, now
        return self.value


class MinimumInterval:
    """Allows something at most once per interval of `seconds`."""

    def __init__(self, seconds: float, clock: Callable[[], float]) -> None:
        self._seconds, self._clock = seconds, clock
        self._last = -inf

    def take(self) -> bool:
        """Return whether it is allowed now; if so, the interval starts again."""
        now = self._clock()
        if now - self._last < self._seconds:
            return False
        self._last = now
        return True


class RateLimiter:
    """Spreads arrivals at least `seconds` apart; one that comes alone does not wait."""

    def __init__(self, seconds: float) -> None:
        self._seconds, self._next = seconds, -inf

    def wait(self, now: float) -> float:
        """Take the next slot; return the seconds until it begins."""
        at = max(now, self._next)
        self._next = at + self._seconds
        return at - now
