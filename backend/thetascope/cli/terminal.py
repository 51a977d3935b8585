"""Progress bars and tables for the command line."""

import sys
import time
import unicodedata
from collections.abc import Sequence
from typing import TextIO

from thetascope.cli.words import Words
from thetascope.progress import TerminalBar

_PATIENCE = 0.4
"""Seconds after which a bar appears."""
_PLAIN_EVERY = 5.0


class Progress:
    """Shows the progress of a run: a bar on a terminal, occasional lines elsewhere (logs)."""

    def __init__(self, say: Words, stream: TextIO | None = None, quiet: bool = False) -> None:
        self._say = say
        self._stream = stream or sys.stderr
        self._terminal = self._stream.isatty()
        self._bar = TerminalBar(self._stream)
        self._quiet = quiet
        self._start = time.monotonic()
        self._shown = self._start + (_PATIENCE - 0.1 if self._terminal else 0.0)
        self._drawn = False

    def show(self, share: float) -> None:
        """Draw the share done (0 to 1), unless the last drawing is too recent."""
        now = time.monotonic()
        if self._quiet or now - self._shown < (0.1 if self._terminal else _PLAIN_EVERY):
            return
        self._shown = now
        left = self._say("cli.preparing")
        if share > 0.01:
            left = self._say("cli.time-left", seconds=(now - self._start) * (1 - share) / share)
        if self._terminal:
            self._bar.draw(share, left)
            self._drawn = True
        else:
            self._stream.write(f"{share:.0%}, {left}\n")
            self._stream.flush()

    def close(self) -> None:
        """Remove the bar."""
        if self._drawn:
            self._bar.clear()


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return text columns as wide as their widest entry, the first aligned left and the others right."""
    lines = [list(head), *[list(row) for row in rows]]
    widths = [max(_width(line[i]) for line in lines) for i in range(len(head))]
    right = [bool(rows) and all(_numeric(row[i]) for row in rows) for i in range(len(head))]
    return "\n".join(
        "  ".join(_padded(text, w, r) for text, w, r in zip(line, widths, right, strict=True)).rstrip()
        for line in lines
    )


def _width(text: str) -> int:
    """Return the number of columns that a text takes on a terminal; Chinese characters take two."""
    return sum(
        2 if unicodedata.east_asian_width(char) in "WF" else 1 for char in text if not unicodedata.combining(char)
    )


def _padded(text: str, width: int, right: bool) -> str:
    blanks = " " * (width - _width(text))
    return blanks + text if right else text + blanks


def number(value: float | None, digits: int = 4) -> str:
    """Return a number rounded for display; a dash for None."""
    return "–" if value is None else f"{value:.{digits}g}"


def _numeric(text: str) -> bool:
    return text[:1] in "–-+.0123456789"
