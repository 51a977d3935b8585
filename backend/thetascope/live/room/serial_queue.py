"""One at a time: whoever works on a session has it alone, whether on the event loop or in a thread."""

from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

Job = Callable[[], Any]
Callback = Callable[[Any, Exception | None], None]


class Background(Protocol):
    """Runs a job in a thread and calls `then(value, error)` back on the event loop."""

    def __call__(self, job: Job, then: Callback) -> None: ...


def outcome(job: Job) -> tuple[Any, Exception | None]:
    """What a job gives, or the exception that it ends with."""
    try:
        return job(), None
    except Exception as error:
        return None, error


class SerialQueue:
    """The queue of jobs on one session. Short ones are done on the event loop at once when it is free, long ones in a
    thread. `then` always runs on the event loop, before the next job begins."""

    def __init__(self, background: Background) -> None:
        self._background = background
        self._waiting: deque[tuple[Job, Callback, bool]] = deque()
        self._busy = False

    @property
    def free(self) -> bool:
        return not self._busy

    def submit(self, job: Job, then: Callback, long: bool = False, urgent: bool = False) -> None:
        """Do a job when its turn comes; urgent ones come before all that wait."""
        (self._waiting.appendleft if urgent else self._waiting.append)((job, then, long))
        self._next()

    def _next(self) -> None:
        while self._waiting and not self._busy:
            job, then, long = self._waiting.popleft()
            self._busy = True
            if long:
                self._background(job, lambda value, error, then=then: self._ended(then, value, error))
                return
            value, error = outcome(job)
            self._busy = False
            then(value, error)

    def _ended(self, then: Callback, value: Any, error: Exception | None) -> None:
        self._busy = False
        try:
            then(value, error)
        finally:
            self._next()
