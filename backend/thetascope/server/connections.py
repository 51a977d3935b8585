"""Connections that wait for nothing: time limits for heads, bodies and answers, and a limit on their number.

uvicorn closes an idle connection between two requests, but waits without limit for the first request, for the rest of a
head or a body, and for a client that does not read its answer. Each of them holds a file handle. When there are as many
connections as may be, those that wait for their client give way, beginning with the network that has most of them.
"""

import asyncio
import logging
import sys
import time
from collections.abc import Callable
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from thetascope.access.wrong_keys import network

log = logging.getLogger(__name__)

HEAD_SECONDS = 15.0
"""Time for the head of a request, from the connection or from its first byte on."""
BODY_SECONDS = 30.0
"""Time for a body of any size …"""
BODY_RATE = 4096
"""… and the bytes per second at which a longer one has to arrive."""
ANSWER_SECONDS = 60.0
"""Time in which a client has to read something of its answer."""
REST_SECONDS = 10.0
"""Time in which the rest of a body is taken in that was refused …"""
REST_BYTES = 128 * 1024**2
"""… and the most bytes of it. A client that is cut off while it sends does not see why it was refused."""
_PATIENCE = 2.0
"""Seconds for which a connection with a request does not give way to others."""
_LOOK = 1.0
"""Seconds between two looks at a connection that is waited for."""
_RESERVED = 256
"""File handles that connections leave to the store, to workers and to files of the page."""
_HANDLES = 65_536
"""The most file handles that this process asks for."""
_QUIET = 10.0
"""Seconds in which equal trouble with connections is logged once."""

_FULL = (
    b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: 39\r\n"
    b"Retry-After: 5\r\nConnection: close\r\n\r\nToo many connections; try again later.\n"
)


def allowed(wanted: int) -> int:
    """Return how many connections may be open: `wanted`, or what the system's limit on file handles leaves.

    The limit of this process is raised as far as the system lets it: a crowd is accepted before it is counted.
    """
    if sys.platform == "win32":
        return wanted
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return wanted
    most = _HANDLES if hard == resource.RLIM_INFINITY else min(hard, _HANDLES)
    if soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
        soft = most
    return max(1, min(wanted, soft - min(_RESERVED, soft // 2)))


class Notes:
    """Writes log lines about trouble that may come a thousand times a second: each kind once in a while, counted."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._last: dict[str, float] = {}
        self._left_out: dict[str, int] = {}

    def add(self, what: str, **fields: Any) -> None:
        """Write a line, or count it where one about the same was written less than ten seconds ago."""
        now = self._clock()
        if now - self._last.get(what, -_QUIET) < _QUIET:
            self._left_out[what] = self._left_out.get(what, 0) + 1
            return
        self._last[what] = now
        if more := self._left_out.pop(what, 0):
            fields["more"] = more
        log.warning("%s", what, extra={"fields": fields})


def protocol(limit: int, notes: Notes) -> type[H11Protocol]:
    """Return the protocol of connections of one server, which has at most `limit` of them."""

    class Limited(Connection):
        most, trouble = limit, notes

    return Limited


class Connection(H11Protocol):
    """An HTTP connection that is closed when its client keeps the service waiting."""

    most: int
    trouble: Notes

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._waits: tuple[str, float] | None = None  # for what, and since when
        self._received = 0
        self._stuck: tuple[int, float] | None = None  # bytes of the answer that wait, and since when
        self._look: asyncio.TimerHandle | None = None
        self._upgraded = False
        self._idle_since: float | None = None  # when it began to wait for a request
        self._rests = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for the head of a request; refuse the connection if there are too many."""
        super().connection_made(transport)
        self.transport = _Transport(transport, self._takes_rest)  # type: ignore[assignment]
        if len(self.connections) > self.most:
            self.trouble.add("Too many connections", limit=self.most, client=self._address)
            if not self._made_room():
                transport.write(_FULL)
                transport.close()
                return
        self._idle_since = self.loop.time()
        self._waits = "head", self._idle_since
        self._check_later()

    def data_received(self, data: bytes) -> None:
        """Read a part of a request."""
        self._received += len(data)
        if self._rests:
            if self._received > REST_BYTES:
                self.transport.abort()
            return
        super().data_received(data)
        if self._rests or self._upgraded:
            return
        state = self.conn.their_state
        if state is not h11.IDLE:
            self._idle_since = None
        phase = {h11.IDLE: "head", h11.SEND_BODY: "body"}.get(state)
        if phase is None:
            self._waits = None
        elif self._waits is None or self._waits[0] != phase:
            self._waits, self._received = (phase, self.loop.time()), 0
            self._check_later()

    def on_response_complete(self) -> None:
        """Wait for the next request: its head begins with its first byte."""
        if not self._rests:
            self._waits = None
        if self.conn.their_state is h11.DONE:
            self._idle_since = self.loop.time()
        super().on_response_complete()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection over to the websocket, which has limits of its own."""
        self._upgraded = True
        self._end_checks()
        self.transport = self.transport.inner  # type: ignore[attr-defined]
        super().handle_websocket_upgrade(event)

    def pause_writing(self) -> None:
        """Wait until the client has read some of the answer."""
        super().pause_writing()
        self._stuck = self.transport.get_write_buffer_size(), self.loop.time()
        self._check_later()

    def resume_writing(self) -> None:
        """Go on with the answer."""
        self._stuck = None
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """End the checks."""
        self._end_checks()
        super().connection_lost(exc)

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    def _check_later(self) -> None:
        if self._look is None and not self._upgraded:
            self._look = self.loop.call_later(_LOOK, self._check)

    def _end_checks(self) -> None:
        if self._look is not None:
            self._look.cancel()
        self._look = self._waits = self._stuck = self._idle_since = None

    def _takes_rest(self) -> bool:
        """Begin to take in the rest of a body that is refused; return whether there is one."""
        if self._rests or self.conn.their_state is not h11.SEND_BODY:
            return False
        self._rests, self._received, self._waits = True, 0, ("rest", self.loop.time())
        self.flow.resume_reading()
        self._check_later()
        return True

    @property
    def _waiting(self) -> tuple[int, float] | None:
        """How soon it gives way where connections are short: without a request the sooner, and the longer it waits."""
        if self._idle_since is not None:
            return 0, self._idle_since
        since = self._stuck[1] if self._stuck is not None else self._waits[1] if self._waits is not None else None
        return None if since is None or self.loop.time() - since < _PATIENCE else (1, since)

    def _made_room(self) -> bool:
        """Close connections that wait for their client, of the network that has most of them; return whether any did.

        Some are closed together, since each look at all of them takes a part of a millisecond.
        """
        by_network: dict[str, list[tuple[tuple[int, float], Connection]]] = {}
        for one in self.connections:
            if isinstance(one, Connection) and (waiting := one._waiting) is not None:
                by_network.setdefault(network(one._address), []).append((waiting, one))
        if not by_network:
            return False
        most = sorted(max(by_network.values(), key=len), key=lambda pair: pair[0])
        for _, one in most[: max(1, self.most // 50)]:
            one._end_checks()
            self.connections.discard(one)
            one.transport.abort()
        return True

    def _check(self) -> None:
        """Close the connection if its client is too slow; look again later while anything is waited for."""
        self._look, now = None, self.loop.time()
        if self.transport.is_closing():  # an answer may wait to be read all the same
            self._waits = None
        if self._waits is not None:
            phase, since = self._waits
            if phase == "body" and self.flow.read_paused:  # the service is slow, not the client
                self._waits, self._received = (phase, now), 0
            elif phase == "rest":
                if now - since > REST_SECONDS:
                    self.transport.abort()
                    return
            elif now - since > (HEAD_SECONDS if phase == "head" else BODY_SECONDS + self._received / BODY_RATE):
                self._close(f"A client was too slow to send the {phase} of a request")
                return
        if self._stuck is not None:
            size, since = self._stuck
            left = self.transport.get_write_buffer_size()
            if left < size:
                self._stuck = left, now
            elif now - since > ANSWER_SECONDS:
                self._close("A client did not read its answer")
                return
        if self._waits is not None or self._stuck is not None:
            self._check_later()

    def _close(self, why: str) -> None:
        self.trouble.add(why, client=self._address)
        self.transport.abort()


class _Transport:
    """A transport that is closed later while there is a rest of a request to take in; only its answer ends then."""

    def __init__(self, inner: asyncio.Transport, takes_rest: Callable[[], bool]) -> None:
        self.inner, self._takes_rest = inner, takes_rest

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def close(self) -> None:
        """Close it, or its sending half."""
        if not self.inner.is_closing() and self.inner.can_write_eof() and self._takes_rest():
            self.inner.write_eof()
        else:
            self.inner.close()


def watch(loop: asyncio.AbstractEventLoop, notes: Notes) -> None:
    """Log trouble of the event loop with connections in one line each; other errors keep their tracebacks."""

    def handle(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if isinstance(error, OSError):
            notes.add(context.get("message") or "Trouble with a connection", error=str(error))
        else:
            loop.default_exception_handler(context)

    loop.set_exception_handler(handle)
