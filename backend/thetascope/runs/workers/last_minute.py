"""The processor time that each client has used within the last minute."""

import time
from collections import deque
from collections.abc import Callable

MINUTE = 60.0
_STEP = 1.0
"""Seconds whose use is counted together."""


class LastMinute:
    """Not thread-safe.

    Args:
        clock: returns the time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._uses: dict[str, deque[list[float]]] = {}

    def add(self, client: str, seconds: float) -> None:
        """Count processor time of a client."""
        now = self._clock()
        uses = self._uses.setdefault(client, deque())
        if uses and now - uses[-1][0] < _STEP:
            uses[-1][1] += seconds
        else:
            uses.append([now, seconds])
        if len(self._uses) > 1000:
            self._uses = {name: uses for name, uses in self._uses.items() if now - uses[-1][0] < MINUTE}

    def used(self, client: str) -> float:
        """Return the processor time of a client in s."""
        return sum(seconds for _, seconds in self._recent(client))

    def wait(self, client: str, most: float) -> float:
        """Return the seconds after which a client that uses no more has used less than `most`; 0: it has already."""
        uses = self._recent(client)
        used, now = sum(seconds for _, seconds in uses), self._clock()
        for at, seconds in uses:
            if used < most:
                return 0.0
            used -= seconds
            if used < most:
                return at + MINUTE - now
        return 0.0

    def _recent(self, client: str) -> deque[list[float]]:
        uses = self._uses.get(client, deque())
        while uses and self._clock() - uses[0][0] >= MINUTE:
            uses.popleft()
        if not uses:
            self._uses.pop(client, None)
        return uses
