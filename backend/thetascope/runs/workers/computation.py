"""A computation that waits for a worker or runs in one, and the future of its result."""

import pickle
import time
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Event, Lock
from typing import Any

from thetascope.runs.workers.limits import Limits

Report = Callable[[str, Any], None]
"""Receives what a computation tells on its way: a name and a value."""


@dataclass(eq=False)
class Computation:
    """One computation.

    `result` resolves to its value, or to the exception that it raised or that ended it. Several requests may wait for
    one computation (`holders`); it is cancelled when the last of them leaves.

    Args:
        client: whose turn it takes.
        task: a function of a module and its arguments, pickled.
        limits: the most that it may take.
        report: is called in a thread with what the computation tells on its way.
        queued: whether waiting for a turn counts towards the time limit.
        long: whether it is known to take long.
        trusted: whether it is one of the library's own: it does not give way when it takes long.
        took_long: whether it turned out to take long.
    """

    client: str
    task: bytes
    limits: Limits
    report: Report = lambda name, value: None
    queued: bool = True
    long: bool = False
    trusted: bool = False
    took_long: bool = False
    result: "Future[Any]" = field(default_factory=Future)
    holders: int = 1
    deadline: float = field(init=False)
    _first: Limits = field(init=False)
    _cancelled: Event = field(default_factory=Event)
    _lock: Lock = field(default_factory=Lock)

    def __post_init__(self) -> None:
        self.result.set_running_or_notify_cancel()  # it ends by `leave` or `cancel`, not by cancelling the future
        self._first = self.limits
        self.deadline = time.monotonic() + self.limits.seconds if self.queued else float("inf")

    @property
    def cancelled(self) -> bool:
        """Return whether the computation must end."""
        return self._cancelled.is_set()

    def cancel(self) -> None:
        """End the computation."""
        self._cancelled.set()

    def join(self) -> bool:
        """Let one more request wait for the result; return False if the computation is ending."""
        with self._lock:
            if self.holders == 0 or self.cancelled:
                return False
            self.holders += 1
            return True

    def leave(self) -> None:
        """Let a request wait no longer. The computation ends if it was the last."""
        with self._lock:
            self.holders -= 1
            if self.holders <= 0:
                self.cancel()

    def begin(self) -> None:
        """Begin, or begin again: a time limit that does not include waiting counts from now."""
        if not self.queued:
            self.extend(self._first)

    def extend(self, limits: Limits) -> None:
        """Give the computation other limits, counted from now."""
        self.limits, self.deadline = limits, time.monotonic() + limits.seconds

    def succeed(self, value: Any) -> None:
        """Resolve the result."""
        with suppress(InvalidStateError):
            self.result.set_result(value)

    def fail(self, error: BaseException) -> None:
        """Resolve the result with an exception."""
        with suppress(InvalidStateError):
            self.result.set_exception(error)


def packed(task: Callable[..., Any], args: tuple[Any, ...]) -> bytes:
    """Return a function of a module and its arguments as bytes."""
    return pickle.dumps((task, args), protocol=pickle.HIGHEST_PROTOCOL)
