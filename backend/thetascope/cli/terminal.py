"""What the command line shows: a progress bar and tables."""

import sys
import time
from collections.abc import Sequence
from typing import TextIO

_WIDTH = 32
_PATIENCE = 0.4
"""Seconds after which a run is long enough for a bar."""
_PLAIN_EVERY = 5.0


class Progress:
    """How far a run is: a bar that is redrawn on a terminal, a line now and then elsewhere (logs)."""

    def __init__(self, stream: TextIO | None = None, quiet: bool = False) -> None:
        self._stream = stream or sys.stderr
        self._terminal = self._stream.isatty()
        self._quiet = quiet
        self._start = time.monotonic()
        self._shown = self._start + (_PATIENCE - 0.1 if self._terminal else 0.0)
        self._drawn = False

    def show(self, share: float) -> None:
        """Draw the share done (0 to 1), if it is time to."""
        now = time.monotonic()
        if self._quiet or now - self._shown < (0.1 if self._terminal else _PLAIN_EVERY):
            return
        self._shown = now
        left = f"{(now - self._start) * (1 - share) / share:.0f} s left" if share > 0.01 else "preparing"
        if self._terminal:
            full = round(share * _WIDTH)
            self._stream.write(f"\r{'█' * full}{'░' * (_WIDTH - full)} {share:4.0%}  {left}\x1b[K")
            self._drawn = True
        else:
            self._stream.write(f"{share:.0%}, {left}\n")
        self._stream.flush()

    def close(self) -> None:
        """Take the bar away."""
        if self._drawn:
            self._stream.write("\r\x1b[K")
            self._stream.flush()


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns as wide as their widest entry, the first to the left and numbers to the right."""
    lines = [list(head), *[list(row) for row in rows]]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    right = [bool(rows) and all(_numeric(row[i]) for row in rows) for i in range(len(head))]
    return "\n".join(
        "  ".join(
            text.rjust(w) if r else text.ljust(w) for text, w, r in zip(line, widths, right, strict=True)
        ).rstrip()
        for line in lines
    )


def number(value: float | None, digits: int = 4) -> str:
    """A number as people read it; a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}g}"


def _numeric(text: str) -> bool:
    return text[:1] in "–-+.0123456789"
