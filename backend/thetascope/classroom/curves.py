"""Curves of a live session for phones: chosen columns only, so that nothing else of the session reaches them.

The rows of a session are encoded once for its viewers; of these bytes a phone gets those of a few columns. A phone that
is too slow, or comes back, gets the newest rows again from the session's memory: its queue is bounded.
"""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from struct import Struct
from typing import Protocol

import numpy as np

from thetascope.classroom.faults.outcomes import panels_of
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.live.room.broadcast import Tap
from thetascope_schemas.service.classroom.requests import CurveStrip
from thetascope_schemas.service.classroom.views import CurvesHead
from thetascope_schemas.service.session import HEADER

_HEADER = Struct(HEADER)
_QUEUE = 90
"""Frames that wait for a phone; with more it gets the newest rows again."""
_FRAME = 1 / 30
"""Seconds between two frames, at least."""
_PAST = 8192
"""Rows that a phone is sent of the past."""


class Shown(Protocol):
    """What curves need of a session, which lives in this process or in another one."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of its frames."""
        ...

    @property
    def epoch(self) -> int:
        """Grows when columns or past rows change."""
        ...

    @property
    def record(self) -> float:
        """Time in s between rows."""
        ...

    @property
    def shown(self) -> int:
        """Rows shown so far."""
        ...

    @property
    def oldest(self) -> int:
        """The first row that is kept."""
        ...

    async def past_rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Return rows first … last − 1 in these columns."""
        ...

    def attach(self, tap: Tap) -> None:
        """Add a tap, which gets all frames from now on."""
        ...

    def detach(self, tap: Tap) -> None:
        """Remove a tap."""
        ...


class CurveSocket:
    """One phone's connection to curves."""

    def __init__(self) -> None:
        self._frames: deque[bytes] = deque()
        self._ready = asyncio.Event()
        self._again, self._row = True, 0
        self._ready.set()

    def put(self, data: bytes) -> None:
        """Queue a frame."""
        if self._again:
            return
        if len(self._frames) >= _QUEUE:
            self.restart()
        else:
            self._frames.append(data)
        self._ready.set()

    def restart(self) -> None:
        """Send a head and the newest rows again."""
        self._frames.clear()
        self._again = True
        self._ready.set()

    async def next(self, source: "Curves", own: "OwnRecord | None") -> list[str | bytes]:
        """Return what to send next: frames, or a head with the rows so far; `own`: the student's record."""
        if own is not None and not self._again:
            wait = own.next_row()
            with suppress(TimeoutError):
                async with asyncio.timeout(None if wait is None else max(_FRAME, wait)):
                    await self._ready.wait()
        else:
            await self._ready.wait()
        self._ready.clear()
        if own is not None:
            return self._of_record(own)
        if not self._again:
            frames = list(self._frames)
            self._frames.clear()
            return list(frames)
        self._again = False  # frames from here on are queued: none is missed while the past is read
        return await source.beginning()

    def _of_record(self, own: "OwnRecord") -> list[str | bytes]:
        if self._again:
            self._again, self._row = False, 0
            self._frames.clear()
            data = own.frame(0)
            return [own.head().model_dump_json(), *([] if data is None else [self._sent(data)])]
        data = own.frame(self._row)
        return [] if data is None else [self._sent(data)]

    def _sent(self, data: bytes) -> bytes:
        _, _, first, rows, _ = _HEADER.unpack_from(data)
        self._row = first + rows
        return data


class OwnRecord:
    """The record of a student in a round of hidden faults, as far as it has been played.

    Args:
        round: the round.
        student: the student's id.
        now: returns the time, s.
    """

    def __init__(self, round: OwnRound, student: str, now: Callable[[], float]) -> None:
        self._round, self._student, self._now = round, student, now

    def next_row(self) -> float | None:
        """Return the seconds until the next row; None where none follows by itself."""
        return self._round.next_row(self._student, self._now())

    def head(self) -> CurvesHead:
        """Return what comes before the rows."""
        setup = self._round.setup
        panels = panels_of(setup)
        return CurvesHead(
            strip=None, panels=panels, record=setup.record, epoch=self._round.number, row=0, horizon=setup.horizon
        )

    def frame(self, first: int) -> bytes | None:
        """Return the rows from `first` on; None where there are none."""
        rows = self._round.rows(self._student, self._now())
        if rows is None or rows.shape[1] <= first:
            return None
        values = np.ascontiguousarray(rows[:, first:])
        return _HEADER.pack(0, self._round.number, first, values.shape[1], len(values)) + values.tobytes()


class Curves:
    """A strip of curves of one session after another, for any number of phones; a tap of the session's room.

    Args:
        horizon: length of the axis of time in s; None: it grows.
    """

    def __init__(self, horizon: float | None = None) -> None:
        self._horizon = horizon
        self._room: Shown | None = None
        self._strip: CurveStrip | None = None
        self._sockets: set[CurveSocket] = set()
        self._places: tuple[tuple[int, int | None], ...] = ()

    def show(self, room: Shown | None, strip: CurveStrip | None) -> None:
        """Show curves of this session from now on; None: none."""
        if room is self._room and strip == self._strip:
            return
        attached = self._room is not None
        if self._room is not None and room is not self._room:
            self._room.detach(self)
            attached = False
        self._room, self._strip = room, strip
        if room is not None and not attached and self._sockets:
            room.attach(self)
        self.restarted()

    def connect(self, socket: CurveSocket) -> None:
        """Add a phone; the first one lets the session know that somebody watches."""
        if not self._sockets and self._room is not None:
            self._room.attach(self)
        self._sockets.add(socket)

    def disconnect(self, socket: CurveSocket) -> None:
        """Remove a phone."""
        self._sockets.discard(socket)
        if not self._sockets and self._room is not None:
            self._room.detach(self)

    def frame(self, data: bytes) -> None:
        """Send the chosen columns of a frame to all phones."""
        sequence, epoch, first, rows, columns = _HEADER.unpack_from(data)
        if not self._places:
            return
        values = np.frombuffer(data, "<f4", offset=_HEADER.size).reshape(columns, rows)
        chosen = (
            _HEADER.pack(sequence, epoch, first, rows, len(self._places)) + _differences(values, self._places).tobytes()
        )
        for socket in self._sockets:
            socket.put(chosen)

    def restarted(self) -> None:
        """Send heads and rows again: columns, past rows or the session have changed."""
        self._places = self._find()
        for socket in self._sockets:
            socket.restart()

    def closed(self) -> None:
        """Show nothing: the session has ended."""
        self._room = None
        self.restarted()

    async def beginning(self) -> list[str | bytes]:
        """Return the head, and the newest rows of the past in one frame."""
        room, strip = self._room, self._strip
        if room is None or strip is None or not self._places:
            head = CurvesHead(strip=None, record=1, epoch=0, row=0, horizon=None)
            return [head.model_dump_json()]
        epoch, last = room.epoch, room.shown
        first = max(room.oldest, last - _PAST)
        head = CurvesHead(strip=strip, record=room.record, epoch=epoch, row=first, horizon=self._horizon)
        names = self._names()
        values = await room.past_rows(names, first, last)
        places = tuple(
            (names.index(line.column), None if line.minus is None else names.index(line.minus)) for line in strip.lines
        )
        data = _HEADER.pack(0, epoch, first, values.shape[1], len(places)) + _differences(values, places).tobytes()
        return [head.model_dump_json(), data]

    def _names(self) -> tuple[str, ...]:
        lines = () if self._strip is None else self._strip.lines
        return tuple(dict.fromkeys(name for line in lines for name in (line.column, line.minus) if name is not None))

    def _find(self) -> tuple[tuple[int, int | None], ...]:
        """Return the places of the columns in a frame; none if one is missing."""
        if self._room is None or self._strip is None:
            return ()
        columns = self._room.columns
        if any(name not in columns for name in self._names()):
            return ()
        return tuple(
            (columns.index(line.column), None if line.minus is None else columns.index(line.minus))
            for line in self._strip.lines
        )


def _differences(values: np.ndarray, places: tuple[tuple[int, int | None], ...]) -> np.ndarray:
    """Return rows of values, or differences of two, as float32."""
    chosen = [values[a] if b is None else values[a] - values[b] for a, b in places]
    return np.ascontiguousarray(chosen, dtype="<f4")
