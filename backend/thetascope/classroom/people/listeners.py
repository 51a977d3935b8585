"""Whoever is sent the state of a room: a connection gets the newest state when it is ready for it, never a queue."""

import asyncio
from collections.abc import Callable

from pydantic import BaseModel

SPACING = 0.15
"""Seconds between two states that one connection is sent."""


class Listener:
    """One connection. What changes while it cannot be sent anything is sent as one state later.

    Args:
        view: returns the state.
    """

    def __init__(self, view: Callable[[], BaseModel]) -> None:
        self._view = view
        self._changed = asyncio.Event()
        self._changed.set()
        self.closing: int | None = None

    def changed(self) -> None:
        """Send the state soon."""
        self._changed.set()

    def close(self, code: int) -> None:
        """End the connection with a code."""
        self.closing = self.closing or code
        self._changed.set()

    async def next(self) -> str | None:
        """Wait for a change, and return the state as JSON; None when the connection is to be closed."""
        await self._changed.wait()
        if self.closing is not None:
            return None
        self._changed.clear()
        return self._view().model_dump_json()

    async def pause(self) -> None:
        """Wait until the next state may be sent, unless the connection is to be closed."""
        await asyncio.sleep(SPACING)
