"""What one viewer is still to be sent, in bounded memory however slow it is.

Texts go out in order. One with a key (status, spec) takes the place of an unsent one with the same key; the others are
never dropped, and a viewer that lets too many of them pile up is given up. Samples are not stored at all: the outbox
knows how far the viewer has got, so whatever it has missed becomes one frame as soon as it can take one. One that is too
far behind jumps.
"""

from collections.abc import Hashable
from typing import NamedTuple

MAX_TEXTS = 2000
MAX_CHARACTERS = 8 * 1024**2
"""Texts that may wait for a viewer. A connection that takes none of them for so long is closed."""


class Span(NamedTuple):
    """Rows first … last − 1."""

    first: int
    last: int


class Overflow(Exception):
    """A viewer lets texts pile up."""


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
        """The next text; it counts as sent."""
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
        """Rows from this one on are void."""
        self.row = min(self.row, row)

    def jump(self, rows: int, backlog: int, oldest: int = 0) -> Span | None:
        """Let a viewer that is more than `backlog` rows behind the `rows` there are, or behind the oldest row that is
        kept, miss some: which. It keeps half the backlog, so that it does not jump again at once."""
        first = self.row
        to = max(first, oldest)
        if rows - first > backlog:
            to = max(to, rows - max(1, backlog // 2))
        self.row = to
        return Span(first, to) if to > first else None

    def span(self, rows: int, most: int) -> Span | None:
        """What is to be sent of the `rows` rows there are, at most `most` of them; None: nothing."""
        if self.row >= rows:
            return None
        return Span(self.row, min(rows, self.row + most))
