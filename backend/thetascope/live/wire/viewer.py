"""One connection of a viewer to a session: the messages for it, and when they are sent."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Protocol

from pydantic import BaseModel

from thetascope.live.wire.eager_send import Continuation, send_eagerly
from thetascope.live.wire.localize import encode
from thetascope.live.wire.outbox import Outbox, Overflow
from thetascope.messages import Message
from thetascope_schemas.service.session import CLOSE_SLOW


class Source(Protocol):
    """Where a viewer's samples come from."""

    def samples(self, viewer: "Viewer") -> Awaitable[bytes | None]:
        """Return the next frame of the rows that the viewer has missed; None if it has all."""
        ...


class Viewer:
    """A connection.

    Whoever publishes never waits for a viewer: as much as the connection accepts is written immediately, and the rest
    waits in the outbox for the viewer's own task, :meth:`run`.

    Args:
        text, samples: send a text or binary frame; they wait while the connection's buffer is full.
        control: whether the viewer may send commands.
        loop: the event loop.
        language: the language of the sentences it is sent.
        client: whose turn its commands take.
    """

    def __init__(
        self,
        text: Callable[[str], Coroutine],
        samples: Callable[[bytes], Coroutine],
        control: bool,
        loop: asyncio.AbstractEventLoop,
        language: str = "en",
        client: str = "",
    ) -> None:
        self.control, self.language, self.client = control, language, client
        self.outbox = Outbox()
        self.closing: tuple[int, Message] | None = None
        self.closed = asyncio.Event()
        self._text, self._samples, self._loop = text, samples, loop
        self._parked: asyncio.Future[None] | None = None  # while the task has nothing to send
        self._continuation: Continuation | None = None

    def send(self, message: BaseModel) -> None:
        """Send a message in the viewer's language, after those that wait."""
        self.put(encode(message, self.language))

    def put(self, text: str, key: str | None = None) -> None:
        """Send a text after those that wait; a keyed one replaces a waiting one with the same key."""
        if self._idle:
            self._send_now(self._text(text))
            return
        try:
            self.outbox.put(text, key)
        except Overflow:
            self.close(CLOSE_SLOW, Message("session.close.slow"))
        self.wake()

    def frame(self, data: bytes, first: int, last: int) -> None:
        """Send a new frame, of rows first … last − 1."""
        outbox = self.outbox
        if outbox.row == first and self._idle:
            outbox.row = last
            self._send_now(self._samples(data))
        else:
            self.wake()

    @property
    def _idle(self) -> bool:
        """Whether the task has nothing to send."""
        return self._parked is not None and self._continuation is None and self.outbox.is_idle and self.closing is None

    def _send_now(self, sending: Coroutine) -> None:
        """Send as much as the connection accepts now; the task sends the rest."""
        try:
            self._continuation = send_eagerly(sending)
        except Exception:
            self.close(1006, Message("session.close.lost"))
        if self._continuation is not None:
            self.wake()

    def close(self, code: int, reason: Message) -> None:
        """Ask the holder of the connection, who waits for `closed`, to close it."""
        self.closing = self.closing or (code, reason)
        self.closed.set()
        self.wake()

    def wake(self) -> None:
        """Let the task continue: there is something to send."""
        parked, self._parked = self._parked, None
        if parked is not None and not parked.done():  # done: its task was cancelled
            parked.set_result(None)

    async def run(self, source: Source) -> None:
        """Send everything that waits until the connection is closed. Raises the connection's error if it is lost."""
        while self.closing is None:
            if self._continuation is not None:
                continuation, self._continuation = self._continuation, None
                await continuation
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
