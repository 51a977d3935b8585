"""Sending immediately as much as a connection accepts.

A server's `send` waits only when the connection's buffer is full. So a frame for hundreds of connections is written in
one go, without waking a task for each; only if a connection is slow does the rest of its `send` go to its task.
"""

from collections.abc import Coroutine, Generator
from typing import Any


class Continuation:
    """The rest of a coroutine that waits; await it to finish it."""

    def __init__(self, coroutine: Coroutine[Any, Any, None], waits_for: object) -> None:
        self._coroutine, self._waits_for = coroutine, waits_for

    def __await__(self) -> Generator[object, Any, None]:
        waits_for = self._waits_for
        while True:
            value, thrown = None, None
            try:
                value = yield waits_for
            except BaseException as error:
                thrown = error
            try:
                waits_for = self._coroutine.send(value) if thrown is None else self._coroutine.throw(thrown)
            except StopIteration:
                return


def send_eagerly(coroutine: Coroutine[Any, Any, None]) -> Continuation | None:
    """Run a coroutine until it waits; return its rest, or None if it has ended. Raises the coroutine's errors."""
    try:
        waits_for = coroutine.send(None)
    except StopIteration:
        return None
    return Continuation(coroutine, waits_for)
