"""Places in the diagnosis at which it may be made to wait, so that it can be done in slices while something else goes on."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_mine = threading.local()


def pause() -> None:
    """Called before every longer step: what the thread has asked for happens, which is nothing as a rule."""
    wait = getattr(_mine, "wait", None)
    if wait is not None:
        wait()


@contextmanager
def pausing(wait: Callable[[], None]) -> Iterator[None]:
    """In this thread, ``wait`` is called at every pause."""
    _mine.wait = wait
    try:
        yield
    finally:
        _mine.wait = None


class once:
    """A property that is found once an object. Unlike functools.cached_property of Python 3.11 it holds no lock meanwhile, which a
    thread that is made to wait would keep from all others."""

    def __init__(self, find: Callable[[Any], Any]) -> None:
        self._find, self._name, self.__doc__ = find, find.__name__, find.__doc__

    def __get__(self, owner: Any, kind: type) -> Any:
        if owner is None:
            return self
        value = owner.__dict__[self._name] = self._find(owner)
        return value
