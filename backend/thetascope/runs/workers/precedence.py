"""Which clients give way: those whose computations take long, while others are there."""

import time
from collections import deque
from collections.abc import Callable

LEFTOVERS = 20
"""A nice value above those of the system: such a process runs when a processor has nothing else to do."""
_PRESENT = 10.0
"""Seconds after its last request for which others give way to a client."""
_RECENT, _TWICE = 30.0, 2
"""Seconds, and the number of long computations within them, after which a client gives way from the next one on."""
_CLIENTS = 1000


class Precedence:
    """Not thread-safe.

    Args:
        clock: returns the time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._last_request: dict[str, float] = {}
        self._long: dict[str, deque[float]] = {}

    def note_request(self, client: str) -> None:
        """Note that a client is there."""
        now = self._clock()
        self._last_request[client] = now
        if len(self._last_request) > _CLIENTS:
            self._last_request = {name: at for name, at in self._last_request.items() if now - at <= _PRESENT}

    def note_long(self, client: str) -> None:
        """Note that a computation of a client took long."""
        now = self._clock()
        self._long.setdefault(client, deque(maxlen=_TWICE)).append(now)
        if len(self._long) > _CLIENTS:
            self._long = {name: times for name, times in self._long.items() if now - times[-1] <= _RECENT}

    def others(self, client: str) -> bool:
        """Return whether another client is there."""
        now = self._clock()
        return any(name != client and now - at <= _PRESENT for name, at in self._last_request.items())

    def gives_way(self, client: str) -> bool:
        """Return whether the computations of a client give way from their beginning, if others are there."""
        times = self._long.get(client, ())
        return len(times) == _TWICE and self._clock() - times[0] <= _RECENT
