"""Limits of one computation, and the refusals that name them."""

from dataclasses import dataclass

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Refusal


@dataclass(frozen=True)
class Limits:
    """The most that one computation may take.

    Args:
        seconds: time in s, counted from the submission, so the time in the queue is included.
        cpu: processor time in s.
        memory: bytes, in addition to those of an idle worker.
    """

    seconds: float
    cpu: float
    memory: int


class LimitReached(Refusal):
    """The computation was ended because it reached one of its limits. Sent again unchanged, it would do so again."""


class Crashed(Refusal):
    """The worker ended without an answer."""


class Ended(Exception):
    """The computation was cancelled, and nobody waits for its result."""


def time_limit(limits: Limits) -> LimitReached:
    """Return the refusal of a computation that took too long."""
    return LimitReached(Message("work.time-limit", seconds=limits.seconds))


def cpu_limit(limits: Limits) -> LimitReached:
    """Return the refusal of a computation that used too much processor time."""
    return LimitReached(Message("work.cpu-limit", seconds=limits.cpu))


def memory_limit(limits: Limits) -> LimitReached:
    """Return the refusal of a computation that needed too much memory."""
    return LimitReached(Message("work.memory-limit", limit=limits.memory))
