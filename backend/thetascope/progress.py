"""Progress bars of `thetascope.run` and of the client: in a terminal, in a notebook, or in a function of the caller."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Protocol, TextIO

from thetascope.messages import Message

Shown = bool | None | Callable[[float], object]
"""Whether to show a bar: None where somebody looks at it (a terminal, a notebook); or a function of the share done."""

_WIDTH = 32
_PATIENCE = 0.4
"""Seconds after which a bar appears."""
_EVERY = 0.1
"""Seconds between two drawings."""


class _Canvas(Protocol):
    def draw(self, share: float, left: str) -> None: ...

    def clear(self) -> None: ...


class TerminalBar:
    """A bar in the last line of a terminal."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def draw(self, share: float, left: str) -> None:
        """Draw the share done (0 to 1)."""
        full = round(share * _WIDTH)
        self._stream.write(f"\r{'█' * full}{'░' * (_WIDTH - full)} {share:4.0%}  {left}\x1b[K")
        self._stream.flush()

    def clear(self) -> None:
        """Remove the bar."""
        self._stream.write("\r\x1b[K")
        self._stream.flush()


class NotebookBar:
    """A bar below a cell of a notebook: an HTML element that is replaced, without widgets to install."""

    def __init__(self) -> None:
        self._handle: Any = None

    def draw(self, share: float, left: str) -> None:
        """Draw the share done (0 to 1)."""
        self._put(f'<progress max="1" value="{share:.3f}" style="width: 20em"></progress> {share:.0%} · {left}')

    def clear(self) -> None:
        """Remove the bar."""
        self._put("")

    def _put(self, html: str) -> None:
        area = import_module("IPython.display")  # there is one in a notebook
        if self._handle is None:
            self._handle = area.display(area.HTML(html), display_id=True)
        else:
            self._handle.update(area.HTML(html))


@contextmanager
def progress_bar(shown: Shown = None, stream: TextIO | None = None) -> Iterator[Callable[[float], None]]:
    """Yield a function of the share done that draws a bar, and remove the bar at the end.

    It appears after 0.4 s and is drawn ten times a second at most. A function of the caller gets every share.
    """
    if callable(shown):
        report = shown
        yield lambda share: _ignore(report(share))
        return
    canvas = _canvas(shown, stream or sys.stderr)
    begun = time.monotonic()
    latest: float | None = None

    def show(share: float) -> None:
        nonlocal latest
        moment = time.monotonic()
        if canvas is None or moment - begun < _PATIENCE or (latest is not None and moment - latest < _EVERY):
            return
        latest = moment
        left = Message("cli.preparing")
        if share > 0.01:
            left = Message("cli.time-left", seconds=(moment - begun) * (1 - share) / share)
        canvas.draw(share, left.text())

    try:
        yield show
    finally:
        if canvas is not None and latest is not None:
            canvas.clear()


def _canvas(shown: bool | None, stream: TextIO) -> _Canvas | None:
    """Return where to draw: None where nobody looks, unless a bar is asked for."""
    if shown is False:
        return None
    if _in_notebook():
        return NotebookBar()
    return TerminalBar(stream) if shown or stream.isatty() else None


def _in_notebook() -> bool:
    """Return whether this process is the kernel of a notebook."""
    module = sys.modules.get("IPython")
    shell = module.get_ipython() if module is not None else None
    return getattr(shell, "kernel", None) is not None


def _ignore(_: object) -> None:
    """Drop the value of a function of the caller."""
