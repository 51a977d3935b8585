"""A computation in a worker process, from its begin to its outcome."""

import logging
import signal
from typing import Any

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy
from thetascope.runs.workers.computation import Computation
from thetascope.runs.workers.limits import Crashed, Ended, LimitReached, cpu_limit, memory_limit
from thetascope.runs.workers.process import Gone, WorkerProcess
from thetascope.runs.workers.turns import Lane

log = logging.getLogger(__name__)

_NEAR = 0.5
"""A worker that crashed with more than this share of its memory in use lacked memory: LLVM does not say so."""
_XCPU = getattr(signal, "SIGXCPU", None)
OUTCOMES = {LimitReached: "limit", Ended: "cancelled", Busy: "refused", Crashed: "crashed"}


class Turn:
    """A computation in a process.

    `lane` is where it is now, `nice` its priority, `again` whether it begins again. Its outcome is `value` or `error`;
    `from_task` tells whether the error is the task's own, `clean` whether the process can be used again.
    """

    def __init__(self, computation: Computation, lane: Lane) -> None:
        self.computation, self.lane = computation, lane
        self.process: WorkerProcess | None = None
        self.nice = 0
        self.value: Any = None
        self.error: Exception | None = None
        self.again, self.clean, self.from_task = False, False, False

    @property
    def outcome(self) -> str:
        """Return the name of the outcome."""
        if self.error is None or self.from_task:
            return "done"
        return next((name for kind, name in OUTCOMES.items() if isinstance(self.error, kind)), "failed")

    def take(self, kind: str, value: Any) -> bool:
        """Take a message of the worker; return whether it was the last one."""
        computation = self.computation
        if kind == "limits":
            computation.extend(value)
        if kind in ("limits", "progress"):
            computation.report(kind, value)
            return False
        self.clean = kind != "memory"
        if kind == "value":
            self.value = value
        else:
            self.error = memory_limit(computation.limits) if kind == "memory" else value
            self.from_task = kind != "memory"
        return True


def why_gone(gone: Gone, computation: Computation, grown: int) -> Exception:
    """Return why a worker ended during a computation, for which it had grown by `grown` bytes."""
    if _XCPU is not None and gone.code == -_XCPU:
        return cpu_limit(computation.limits)
    if grown > _NEAR * computation.limits.memory:
        return memory_limit(computation.limits)
    log.error("A worker ended with code %s", gone.code)
    return Crashed(Message("work.crashed"))


def stopping() -> Busy:
    """Return the refusal of a service that ends."""
    return Busy(Message("work.stopping"))
