"""Write to the store in the background, in order, with a bounded queue."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import BoundedSemaphore
from typing import TypeVar

from thetascope.store import StoreError

log = logging.getLogger(__name__)

_WAITING = 8
"""Most queued writes; another one blocks until the disk has caught up."""
Value = TypeVar("Value")


class Writer:
    """One thread that performs all writes in the order of the requests."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="store")
        self._room = BoundedSemaphore(_WAITING)
        self.failures = 0
        """Queued writes that failed."""
        self.fails = False
        """Whether the last queued write failed."""

    def later(self, write: Callable[[], object]) -> None:
        """Queue a write. A failure is logged: the run stays in memory and can be recomputed."""
        self._room.acquire()
        try:
            self._thread.submit(self._quietly, write)
        except BaseException:
            self._room.release()
            raise

    def now(self, write: Callable[[], Value]) -> Value:
        """Perform a write after all queued ones; return its value or raise the :class:`StoreError`."""
        return self._thread.submit(write).result()

    def close(self) -> None:
        """Perform the queued writes, and stop."""
        self._thread.shutdown(wait=True)

    def _quietly(self, write: Callable[[], object]) -> None:
        try:
            write()
            self.fails = False
        except StoreError as error:
            self.fails = True
            self.failures += 1
            log.error("A run was not stored. %s", error)
        finally:
            self._room.release()
