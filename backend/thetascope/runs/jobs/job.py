"""A queued or active run: its status, its progress, and the future that its end resolves."""

import time
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from threading import Event
from typing import Any, Self

from thetascope.engine.model.result import Result
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.run import Problem, RunSummary, Status


@dataclass(frozen=True)
class Snapshot:
    """A run at one moment. `spec` is as it was posted, `created` is Unix time."""

    id: str
    spec: Experiment
    status: Status
    created: float
    progress: float = 0.0
    summary: RunSummary | None = None
    problem: Problem | None = None
    pinned: bool = False

    @property
    def active(self) -> bool:
        """Whether the run is still waiting or running."""
        return self.status in ("queued", "running")


@dataclass(eq=False)
class Job:
    """A run that is queued or running.

    `done` resolves to the last snapshot; it does not raise when the run fails (the snapshot says so), only
    InvalidSpec when the spec was refused before the run began.
    """

    id: str
    spec: Experiment
    created: float = field(default_factory=time.time)
    pinned: bool = False
    status: Status = "queued"
    progress: float = 0.0
    deadline: float | None = None
    announced: bool = False
    ending: bool = False
    done: "Future[Snapshot]" = field(default_factory=Future)
    _cancel: Event = field(default_factory=Event)

    def __post_init__(self) -> None:
        self.done.set_running_or_notify_cancel()  # a client that goes away must not be able to cancel it

    def snapshot(self) -> Snapshot:
        """The run as it is now."""
        return Snapshot(self.id, self.spec, self.status, self.created, self.progress, pinned=self.pinned)

    def begin(self, seconds: float) -> None:
        """The run starts and has so many seconds."""
        self.status = "running"
        self.deadline = time.monotonic() + seconds

    def report(self, progress: float) -> None:
        """The kernel's loop tells the share done."""
        self.progress = min(max(progress, self.progress), 1.0)

    def cancel(self) -> None:
        """Ask the run to end; the kernel's loop and the worker look at it."""
        self._cancel.set()

    @property
    def cancelled(self) -> bool:
        """Whether somebody asked to cancel the run."""
        return self._cancel.is_set()

    @property
    def late(self) -> bool:
        """Whether the run has used up its time."""
        return self.deadline is not None and time.monotonic() > self.deadline

    def stopped(self) -> bool:
        """Return whether the kernel's loop must end early."""
        return self._cancel.is_set() or self.late


@dataclass(frozen=True)
class Ended:
    """A run that has ended. A failed or cancelled one is only this; one that has a result is a :class:`Finished`."""

    snapshot: Snapshot

    @property
    def size(self) -> int:
        """Bytes of the result."""
        return 0

    def with_snapshot(self, **changes: Any) -> Self:
        """Return the same with fields of the snapshot replaced."""
        return replace(self, snapshot=replace(self.snapshot, **changes))


@dataclass(frozen=True)
class Finished(Ended):
    """A run with its result."""

    result: Result

    @property
    def size(self) -> int:
        """Bytes of the result."""
        return self.result.data.nbytes
