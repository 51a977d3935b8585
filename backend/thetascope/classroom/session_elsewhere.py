"""A session in another process, as a class follows it: its rows come over the session's own websocket.

The newest rows are kept for phones that join later. They are asked for while somebody watches.
"""

import asyncio
import json
import logging
from collections import deque
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from struct import Struct
from weakref import WeakValueDictionary

import numpy as np
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed, WebSocketException

from thetascope.live.room.broadcast import Tap
from thetascope_schemas.service.session import CLOSE_SLOW, HEADER

log = logging.getLogger(__name__)

Connect = Callable[[], AbstractAsyncContextManager[ClientConnection]]

_HEADER = Struct(HEADER)
_KEPT = 8192
"""Rows that are kept."""
_AGAIN = 0.5
"""Seconds before a lost connection is opened again."""
_REASONS = 4000
"""Close codes from here on are reasons of the service."""


class SessionElsewhere:
    """Rows of a session in another process. Used on the event loop; has the interface of `curves.Shown`."""

    def __init__(self, connect: Connect) -> None:
        self._connect = connect
        self._taps: list[Tap] = []
        self._following: asyncio.Task[None] | None = None
        self._forget()

    def attach(self, tap: Tap) -> None:
        """Add a tap; the first one opens the connection."""
        self._taps.append(tap)
        if self._following is None:
            self._following = asyncio.create_task(self._follow())

    def detach(self, tap: Tap) -> None:
        """Remove a tap; the last one closes the connection."""
        if tap in self._taps:
            self._taps.remove(tap)
        if not self._taps and self._following is not None:
            self._following.cancel()
            self._following = None
            self._forget()

    @property
    def oldest(self) -> int:
        """The first row that is kept."""
        return self._rows[0][0] if self._rows else self.shown

    async def past_rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Return rows first … last − 1 in these columns: float32, columns × rows."""
        places = [self.columns.index(name) for name in columns]
        parts = [
            values[places, max(0, first - begin) : max(0, last - begin)]
            for begin, values in self._rows
            if begin < last and begin + values.shape[1] > first
        ]
        return np.concatenate(parts, axis=1) if parts else np.empty((len(columns), 0), np.float32)

    def _forget(self) -> None:
        self.columns: tuple[str, ...] = ()
        self.epoch, self.record, self.shown = 0, 1.0, 0
        self._rows: deque[tuple[int, np.ndarray]] = deque()

    async def _follow(self) -> None:
        """Read what the session sends until it ends; connect again where the connection is lost."""
        while True:
            try:
                async with self._connect() as connection:
                    while not self._is_outdated(message := await connection.recv()):
                        self._take(message)
                continue  # all rows come again, in the new columns
            except ConnectionClosed as end:
                code = end.rcvd.code if end.rcvd else 0
                if code >= _REASONS and code != CLOSE_SLOW:
                    break
            except (OSError, TimeoutError, WebSocketException) as error:
                log.debug("A session elsewhere is not reached: %s", error)
            await asyncio.sleep(_AGAIN)
        self._forget()
        self._following = None
        for tap in list(self._taps):
            tap.closed()
        self._taps.clear()

    @staticmethod
    def _is_outdated(message: str | bytes) -> bool:
        return isinstance(message, str) and json.loads(message)["type"] == "columns"

    def _take(self, message: str | bytes) -> None:
        """Take one message."""
        if isinstance(message, bytes):
            self._take_rows(message)
            return
        data = json.loads(message)
        if data["type"] == "hello":
            self._forget()
            self.columns, self.epoch, self.record = tuple(data["columns"]), data["epoch"], data["record"]
        elif data["type"] == "rewound":
            self.epoch = data["epoch"]
            self._cut(data["row"])
        elif data["type"] == "jump":
            self.epoch, self.shown = data["epoch"], data["row"]
            self._rows.clear()
        else:
            return
        for tap in list(self._taps):
            tap.restarted()

    def _take_rows(self, data: bytes) -> None:
        _, epoch, first, rows, columns = _HEADER.unpack_from(data)
        if epoch != self.epoch or columns != len(self.columns):
            return
        self._rows.append((first, np.frombuffer(data, "<f4", offset=_HEADER.size).reshape(columns, rows)))
        self.shown = first + rows
        while self.shown - self._rows[0][0] - self._rows[0][1].shape[1] >= _KEPT:
            self._rows.popleft()
        for tap in list(self._taps):
            tap.frame(data)

    def _cut(self, row: int) -> None:
        """Drop the rows from here on."""
        kept = [(first, values[:, : max(0, row - first)]) for first, values in self._rows if first < row]
        self._rows = deque(kept)
        self.shown = min(self.shown, row)


class SessionsElsewhere:
    """The sessions in other processes that classes follow, by id, for as long as one does."""

    def __init__(self) -> None:
        self._sessions: WeakValueDictionary[str, SessionElsewhere] = WeakValueDictionary()

    def get(self, id: str, connect: Connect) -> SessionElsewhere:
        """Return a session; `connect` opens its websocket."""
        session = self._sessions.get(id)
        if session is None:
            session = self._sessions[id] = SessionElsewhere(connect)
        return session
