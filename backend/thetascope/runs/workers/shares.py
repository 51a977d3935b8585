"""The processor time that clients have used lately: who used much gives way to the others while there are any."""

import time
from collections.abc import Callable

_HALF = 30.0
"""Seconds after which half of the use is forgotten."""
_RECENT = 60.0
"""Seconds for which a client counts as present after its last computation."""
_LEVELS = ((4.0, 5), (15.0, 10))
"""Nice values, by the seconds of processor time used lately."""


class Shares:
    """Not thread-safe.

    Args:
        clock: returns the time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._used: dict[str, tuple[float, float]] = {}

    def add(self, client: str, seconds: float) -> None:
        """Count processor time of a client."""
        now = self._clock()
        self._used[client] = (self.used(client) + seconds, now)
        if len(self._used) > 1000:
            self._used = {name: (s, at) for name, (s, at) in self._used.items() if now - at < _RECENT}

    def used(self, client: str) -> float:
        """Return the processor time of a client in s, of which the older part counts less."""
        seconds, at = self._used.get(client, (0.0, 0.0))
        return seconds * 0.5 ** ((self._clock() - at) / _HALF)

    def nice(self, client: str) -> int:
        """Return the nice value with which a computation of a client begins; 0 while there is no other client."""
        now = self._clock()
        if all(name == client or now - at > _RECENT for name, (_, at) in self._used.items()):
            return 0
        used = self.used(client)
        return max((nice for least, nice in _LEVELS if used > least), default=0)
