"""One job at a time: a job on a session has it exclusively, whether it runs on the event loop or in a thread."""

from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

Job = Callable[[], Any]
Callback = Callable[[Any, Exception | None], None]
"""Is called with the job's value, or with None and its exception."""


class Background(Protocol):
    """Runs a job in a thread, then calls `then(value, error)` on the event loop."""

    def __call__(self, job: Job, then: Callback) -> None:
        """Run a job in the background, then call back with its outcome."""
        ...


def outcome(job: Job) -> tuple[Any, Exception | None]:
    """Run a job; return its value, or the exception that it raises."""
    try:
        return job(), None
    except Exception as error:
        return None, error


class SerialQueue:
    """The queue of jobs on one session.

    Short jobs run on the event loop as soon as the queue is free, long ones in a thread. The callback always runs on
    the event loop, before the next job begins.
    """

    def __init__(self, background: Background) -> None:
        self._background = background
        self._waiting: deque[tuple[Job, Callback, bool]] = deque()
        self._busy = False

    def submit(self, job: Job, then: Callback, long: bool = False, urgent: bool = False) -> None:
        """Run a job when its turn comes; an urgent one overtakes all that wait."""
        (self._waiting.appendleft if urgent else self._waiting.append)((job, then, long))
        self._next()

    def _next(self) -> None:
        while self._waiting and not self._busy:
            job, then, long = self._waiting.popleft()
            self._busy = True
            if long:
                self._background(job, lambda value, error, then=then: self._finished(then, value, error))
                return
            value, error = outcome(job)
            self._busy = False
            then(value, error)

    def _finished(self, then: Callback, value: Any, error: Exception | None) -> None:
        self._busy = False
        try:
            then(value, error)
        finally:
            self._next()
