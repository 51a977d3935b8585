"""Sending at once what can be sent at once.

A server's `send` only waits when the connection's buffer is full. So a frame for hundreds of connections is written in
one go, without waking a task for each; only where a connection is slow, what is left of its `send` goes to its task.
"""

from collections.abc import Coroutine, Generator


class Continuation:
    """What is left of a coroutine that waits; await it to bring it to its end."""

    def __init__(self, coroutine: Coroutine, waits_for: object) -> None:
        self._coroutine, self._waits_for = coroutine, waits_for

    def __await__(self) -> Generator[object, object, None]:
        waits_for = self._waits_for
        while True:
            try:
                value = yield waits_for
            except BaseException as error:
                step = self._coroutine.throw, error
            else:
                step = self._coroutine.send, value
            try:
                waits_for = step[0](step[1])
            except StopIteration:
                return


def send_eagerly(coroutine: Coroutine) -> Continuation | None:
    """Run a coroutine up to where it waits. None: it has ended. Raises what the coroutine raises."""
    try:
        waits_for = coroutine.send(None)
    except StopIteration:
        return None
    return Continuation(coroutine, waits_for)
