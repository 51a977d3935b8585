"""When which row is due: a session's clock as arithmetic. It never sleeps and never looks at a clock itself.

A row is due when the session's time has reached it: rows move on by speed / record in a second of real time. A clock that
cannot be followed (the simulation is slower than asked for) is set back to what there is, so that nothing is ever caught
up in a rush.
"""

from collections.abc import Callable
from math import ceil, floor, inf

FRAME = 1 / 30
"""Seconds between frames."""

_SLACK = 1e-6  # of a row, for the rounding of times


class PlaybackClock:
    """The clock of one session. `rows` and `due` count rows, so row `due` − 1 is the last that is due. Times in s."""

    def __init__(self, record: float) -> None:
        self.record = record
        self.speed: float | None = 1.0
        self.playing = False
        self._until: int | None = None  # where single steps end
        self._rows = 0.0  # at the time _since
        self._since = 0.0

    @property
    def moving(self) -> bool:
        """Whether rows become due: playing, or on the way of a step."""
        return self.playing or self._until is not None

    def play(self, rows: int, now: float) -> None:
        self.playing, self._until = True, None
        self.anchor(rows, now)

    def pause(self) -> None:
        self.playing, self._until = False, None

    def step(self, rows: int) -> None:
        """Go on to where there are `rows` rows, as fast as possible, and stay there. Steps add up."""
        self.playing, self._until = False, rows

    @property
    def target(self) -> int | None:
        """Where single steps end."""
        return self._until

    def set_speed(self, speed: float | None, rows: int, now: float) -> None:
        """Simulated seconds per second from now on; None is as fast as possible."""
        here = self._position(now) if self.playing and self.speed is not None else float(rows)
        self.speed, self._rows, self._since = speed, here, now

    def anchor(self, rows: float, now: float) -> None:
        """Let there be `rows` rows due now."""
        self._rows, self._since = float(rows), now

    def due(self, now: float) -> float:
        """How many rows are due by now; infinity for as fast as possible."""
        if self._until is not None:
            return self._until
        if not self.playing:
            return 0
        if self.speed is None:
            return inf
        return floor(self._position(now) + _SLACK)

    def reached(self, rows: int) -> None:
        """There are so many rows now: a step may have come to its end."""
        if self._until is not None and rows >= self._until:
            self._until = None

    def next(self, rows: int, before: float, now: float) -> float | None:
        """When to look again after a frame that was due at `before`, with `rows` rows shown; None: not at all.

        Frames keep to their beat, whatever the delay of one of them; where rows are rarer, the next row decides.
        """
        if not self.moving:
            return None
        regular = before + FRAME * (1 + max(0, floor((now - before) / FRAME)))
        if self._until is not None or self.speed is None:
            return regular
        rare = self._since + (rows + 1 - self._rows) * self.record / self.speed
        return rare if rare > regular + FRAME else regular

    def rows_in(self, seconds: float) -> int:
        """Rows that this much real time takes, at least one. Only for a speed that is set."""
        return max(1, ceil(seconds * (self.speed or 1.0) / self.record))

    def _position(self, now: float) -> float:
        return self._rows + (now - self._since) * (self.speed or 0.0) / self.record


class MeasuredSpeed:
    """Simulated seconds per second, as measured between two looks."""

    def __init__(self) -> None:
        self._rows, self._at = 0, -inf
        self.value: float | None = None

    def start(self, rows: int, now: float) -> None:
        """Measure from here."""
        self._rows, self._at, self.value = rows, now, None

    def look(self, rows: int, now: float, record: float) -> float | None:
        """The rate since the last look."""
        if now > self._at and rows >= self._rows:
            self.value = (rows - self._rows) * record / (now - self._at)
        self._rows, self._at = rows, now
        return self.value


class MinimumInterval:
    """Lets something happen only so often, seconds apart."""

    def __init__(self, seconds: float, clock: Callable[[], float]) -> None:
        self._seconds, self._clock = seconds, clock
        self._last = -inf

    def take(self) -> bool:
        """Whether it is time again; then it has happened."""
        now = self._clock()
        if now - self._last < self._seconds:
            return False
        self._last = now
        return True


class RateLimiter:
    """Lets one after the other through, seconds apart at least: whoever comes alone passes at once, a crowd is spread."""

    def __init__(self, seconds: float) -> None:
        self._seconds, self._next = seconds, -inf

    def wait(self, now: float) -> float:
        """Take the next place; the seconds until it is there."""
        at = max(now, self._next)
        self._next = at + self._seconds
        return at - now
