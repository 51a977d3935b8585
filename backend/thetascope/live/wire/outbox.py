"""What one viewer is still to be sent, in bounded memory however slow it is.

Texts go out in order. One with a key (status, spec) replaces an unsent one with the same key; the others are never
dropped, and a viewer with too many of them is disconnected. Samples are not stored: the outbox knows which rows the
viewer has, so all rows that it missed become one frame as soon as it can take one. A viewer that is too far behind
jumps.
"""

from collections.abc import Hashable
from typing import NamedTuple

MAX_TEXTS = 2000
MAX_CHARACTERS = 8 * 1024**2
"""Texts and characters that may wait for a viewer; a connection with more is closed."""


class Span(NamedTuple):
    """Rows first … last − 1."""

    first: int
    last: int


class Overflow(Exception):
    """Too many texts wait for a viewer."""


class Outbox:
    """`row` is the first row that the viewer does not have."""

    def __init__(self, row: int = 0) -> None:
        self.row = row
        self._texts: dict[Hashable, str] = {}
        self._count = 0
        self._characters = 0

    def put(self, text: str, key: str | None = None) -> None:
        """Queue a text. Raises :class:`Overflow`."""
        if key is None:
            self._count += 1
            self._texts[self._count] = text
        else:
            self._characters -= len(self._texts.pop(key, ""))
            self._texts[key] = text
        self._characters += len(text)
        if len(self._texts) > MAX_TEXTS or self._characters > MAX_CHARACTERS:
            raise Overflow

    def text(self) -> str | None:
        """Return the next text, which counts as sent; None if none waits."""
        if not self._texts:
            return None
        key = next(iter(self._texts))
        text = self._texts.pop(key)
        self._characters -= len(text)
        return text

    @property
    def is_idle(self) -> bool:
        """Whether no text waits."""
        return not self._texts

    def rewind_to(self, row: int) -> None:
        """Forget that the viewer has rows from this one on: they are void."""
        self.row = min(self.row, row)

    def jump(self, rows: int, backlog: int, oldest: int = 0) -> Span | None:
        """Return the rows that a viewer skips; None if it can follow.

        A viewer skips rows if it is more than `backlog` rows behind, or behind the oldest row that is kept. Half the
        backlog remains, so that it does not jump again immediately.

        Args:
            rows: rows shown so far.
            backlog: rows that it may be behind.
            oldest: the first row that is kept.
        """
        first = self.row
        to = max(first, oldest)
        if rows - first > backlog:
            to = max(to, rows - max(1, backlog // 2))
        self.row = to
        return Span(first, to) if to > first else None

    def span(self, rows: int, most: int) -> Span | None:
        """Return the next rows to send, at most `most` of the `rows` shown so far; None if the viewer has all."""
        if self.row >= rows:
            return None
        return Span(self.row, min(rows, self.row + most))
