"""The open websockets: counted by client, and closed when the key that admitted them is changed."""

import asyncio
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress

from thetascope.access.key_file import KeyFileError

Close = Callable[[], Awaitable[None]]

_LOOK = 1.0
"""Seconds between two looks at the key while websockets are open that it admitted."""


class OpenSockets:
    """Used on the event loop only.

    Args:
        seal: returns the digest of the present key.
    """

    def __init__(self, seal: Callable[[], bytes | None]) -> None:
        self._seal = seal
        self._counts: Counter[str] = Counter()
        self._sealed: dict[Close, bytes | None] = {}
        self._watch: asyncio.Task[None] | None = None

    def may_open(self, client: str, most: int | None) -> bool:
        """Return whether a client may open one more websocket."""
        return most is None or self._counts[client] < most

    @contextmanager
    def opened(self, client: str, close: Close | None) -> Iterator[None]:
        """Count a websocket while inside; `close` ends one that the present key admitted."""
        self._counts[client] += 1
        if close is not None:
            self._sealed[close] = self._seal()
            if self._watch is None or self._watch.done():
                self._watch = asyncio.create_task(self._watched())
        try:
            yield
        finally:
            self._counts[client] -= 1
            if not self._counts[client]:
                del self._counts[client]
            if close is not None:
                self._sealed.pop(close, None)

    async def _watched(self) -> None:
        """Close the websockets of an earlier key, until there are none that a key admitted."""
        while self._sealed:
            await asyncio.sleep(_LOOK)
            try:
                present = self._seal()
            except KeyFileError:  # said with the next request
                continue
            for close in [close for close, seal in self._sealed.items() if seal != present]:
                del self._sealed[close]
                with suppress(Exception):  # the connection may be lost already
                    await close()
