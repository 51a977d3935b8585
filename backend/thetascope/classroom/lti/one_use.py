"""Values that are kept for minutes under a secret, and taken once: logins that have begun, launches on their way."""

import secrets
from collections.abc import Callable
from typing import Generic, TypeVar

from thetascope.classroom.people.codes import digest

Value = TypeVar("Value")

LASTS = 600.0
"""Seconds for which a value is kept."""
_MOST = 5000


class OneUse(Generic[Value]):
    """Used on the event loop only.

    Args:
        clock: returns the time in s.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._kept: dict[bytes, tuple[float, Value]] = {}

    def put(self, value: Value) -> str:
        """Keep a value; return the secret."""
        secret = secrets.token_urlsafe(24)
        now = self._clock()
        for key in [key for key, (end, _) in self._kept.items() if end <= now]:
            del self._kept[key]
        while len(self._kept) >= _MOST:
            del self._kept[next(iter(self._kept))]
        self._kept[digest(secret)] = now + LASTS, value
        return secret

    def look(self, secret: str) -> Value | None:
        """Return a value that is kept, and keep it; None if it is not kept."""
        end, value = self._kept.get(digest(secret), (0.0, None))
        return value if end > self._clock() else None

    def take(self, secret: str) -> Value | None:
        """Return a value, and keep it no longer; None if it is not kept, or was taken."""
        value = self.look(secret)
        self._kept.pop(digest(secret), None)
        return value
