"""Long work in slices of milliseconds on the event loop: what names faults must keep neither frames nor commands waiting.

The work is done in a thread of its own, which runs only while the loop waits for it: a thread that runs beside the loop would
take Python's lock from it at every frame that is sent.
"""

import threading
from time import perf_counter
from typing import Any

from thetascope.diagnosis.yield_points import pausing
from thetascope.live.room.serial_queue import Callback, Job, outcome


class Slices:
    """One job at a time. Made and used on the event loop."""

    def __init__(self) -> None:
        self._go, self._back = threading.Semaphore(0), threading.Semaphore(0)
        self._until = 0.0
        self._job: tuple[Job, Callback] | None = None
        self._found: tuple[Any, Exception | None] | None = None
        self._thread: threading.Thread | None = None

    @property
    def busy(self) -> bool:
        return self._job is not None

    def begin(self, job: Job, then: Callback) -> None:
        """Take on a job; nothing is done yet. ``then(value, error)`` is called in the slice that ends it."""
        self._job, self._found = (job, then), None
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="slices", daemon=True)
            self._thread.start()

    def go_on(self, seconds: float) -> None:
        """Work for about so long."""
        self._until = perf_counter() + seconds
        self._go.release()
        self._back.acquire()
        if self._found is not None:
            (_, then), found = self._job, self._found
            self._job = self._found = None
            then(*found)

    def _wait(self) -> None:
        if perf_counter() >= self._until:
            self._back.release()
            self._go.acquire()

    def _work(self) -> None:
        with pausing(self._wait):
            while True:
                self._go.acquire()
                self._found = outcome(self._job[0])
                self._back.release()
