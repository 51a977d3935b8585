"""One connection that watches a session: what it is sent, and when."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Protocol

from thetascope.live.wire.eager_send import Continuation, send_eagerly
from thetascope.live.wire.outbox import Outbox, Overflow
from thetascope_schemas.service.session import CLOSE_SLOW


class Source(Protocol):
    """Where a viewer's samples come from."""

    def samples(self, viewer: "Viewer") -> Awaitable[bytes | None]:
        """The next frame of what the viewer has missed; None: it has everything."""
        ...


class Viewer:
    """A connection. `text` and `samples` send; they wait while the connection's buffer is full.

    Whoever publishes never waits for a viewer: what the connection takes at once is written at once, and all else waits
    in the outbox for the viewer's own task, :meth:`run`.
    """

    def __init__(
        self,
        text: Callable[[str], Coroutine],
        samples: Callable[[bytes], Coroutine],
        control: bool,
        loop: asyncio.AbstractEventLoop,
    ) -> None:
        self.control = control
        self.outbox = Outbox()
        self.closing: tuple[int, str] | None = None
        self.closed = asyncio.Event()
        self._text, self._samples, self._loop = text, samples, loop
        self._parked: asyncio.Future[None] | None = None  # while the task waits for something to send
        self._continuation: Continuation | None = None

    def put(self, text: str, key: str | None = None) -> None:
        """Send a text in its turn."""
        if self._idle:
            self._begin(self._text(text))
            return
        try:
            self.outbox.put(text, key)
        except Overflow:
            self.close(CLOSE_SLOW, "this viewer does not read what it is sent")
        self.wake()

    def frame(self, data: bytes, first: int, last: int) -> None:
        """There is a new frame, of rows first … last − 1."""
        outbox = self.outbox
        if outbox.row == first and self._idle:
            outbox.row = last
            self._begin(self._samples(data))
        else:
            self.wake()

    @property
    def _idle(self) -> bool:
        """Whether the task waits and nothing is to be sent before."""
        return self._parked is not None and self._continuation is None and self.outbox.is_idle and self.closing is None

    def _begin(self, sending: Coroutine) -> None:
        """Send as much as the connection takes now; the task does the rest."""
        try:
            self._continuation = send_eagerly(sending)
        except Exception:
            self.close(1006, "the connection is lost")
        if self._continuation is not None:
            self.wake()

    def close(self, code: int, reason: str) -> None:
        """Have the connection closed; `closed` tells whoever holds it."""
        self.closing = self.closing or (code, reason)
        self.closed.set()
        self.wake()

    def wake(self) -> None:
        parked, self._parked = self._parked, None
        if parked is not None and not parked.done():  # done: its task was cancelled
            parked.set_result(None)

    async def run(self, source: Source) -> None:
        """Send what waits, until the connection is closed. Raises what the connection raises when it is lost."""
        while self.closing is None:
            if self._continuation is not None:
                rest, self._continuation = self._continuation, None
                await rest
            elif (text := self.outbox.text()) is not None:
                await self._text(text)
            elif (data := await source.samples(self)) is not None:
                await self._samples(data)
            elif self.outbox.is_idle and self.closing is None:
                self._parked = parked = self._loop.create_future()
                try:
                    await parked
                finally:
                    self._parked = None
