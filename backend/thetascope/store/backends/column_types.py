"""Types of columns that read whatever a damaged row holds: a flipped bit makes a value of another type."""

import math
from collections.abc import Callable
from typing import Any

from sqlalchemy import Dialect, Float, LargeBinary, Text
from sqlalchemy.types import BigInteger


class Blob(LargeBinary):
    """Bytes that are written from a buffer, and read as the driver returns them: a damaged row may hold other types."""

    cache_ok = True

    def bind_processor(self, dialect: Dialect) -> Callable[..., Any] | None:
        """Return how a value is passed to the driver: SQLite reads from the buffer itself."""
        return None if dialect.name == "sqlite" else bytes

    def result_processor(self, dialect: Dialect, coltype: object) -> None:
        """Return that values are left as they are."""
        return


class Characters(Text):
    """Text that is read as text in any case, or as None."""

    cache_ok = True

    def result_processor(self, dialect: Dialect, coltype: object) -> Callable[..., Any]:
        """Return the function that makes a text of bytes and numbers."""
        return _text


class Real(Float):
    """A finite number; another value is read as None."""

    cache_ok = True

    def result_processor(self, dialect: Dialect, coltype: object) -> Callable[..., Any]:
        """Return the function that leaves numbers as they are."""
        return _number


class Whole(BigInteger):
    """A whole number; another value is read as None."""

    cache_ok = True

    def result_processor(self, dialect: Dialect, coltype: object) -> Callable[..., Any]:
        """Return the function that leaves whole numbers as they are."""
        return lambda value: value if isinstance(value, int) else None


def _text(value: object) -> str | None:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value if value is None or isinstance(value, str) else str(value)


def _number(value: object) -> float | None:
    return value if isinstance(value, int | float) and math.isfinite(value) else None
