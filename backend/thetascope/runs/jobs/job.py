"""A queued or active run: its status, its progress, and the future that its outcome resolves."""

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from threading import Event
from typing import Any, Self

from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.run import Problem, RunSummary, Status


@dataclass(frozen=True)
class Snapshot:
    """A run at one moment.

    `spec` is the experiment as posted, `created` is Unix time. `owners` are those who asked for it; None: the store
    has them. `not_stored` is the reason why the run is in memory only.
    """

    id: str
    spec: Experiment
    status: Status
    created: float
    progress: float = 0.0
    summary: RunSummary | None = None
    problem: Problem | None = None
    pinned: bool = False
    owners: frozenset[str] | None = None
    not_stored: Message | None = None

    @property
    def active(self) -> bool:
        """Return whether the run is queued or running."""
        return self.status in ("queued", "running")

    def why_ended(self) -> Message:
        """Return why the run has no result: it was cancelled, or it failed."""
        document = self.problem
        if document is None:
            return Message("run.cancelled")
        first = document.errors[0] if document.errors else document
        reason = Message.from_data({"code": first.code, "args": first.args}) if first.code else document.detail
        return Message("run.failed", reason=reason)


@dataclass(eq=False)
class Job:
    """A run that is queued or running.

    `done` resolves to the last snapshot; it does not raise when the run fails (the snapshot says so), only
    InvalidSpec when the spec was refused before the run began. `holders` counts the requests that wait for it.
    `interrupted`: the service ends, and its next start computes the run.
    `owners` are those who asked for it.
    """

    id: str
    spec: Experiment
    created: float = field(default_factory=time.time)
    pinned: bool = False
    status: Status = "queued"
    progress: float = 0.0
    client: str = ""
    owners: frozenset[str] = frozenset()
    holders: int = 1
    announced: bool = False
    interrupted: bool = False
    ending: bool = False
    done: "Future[Snapshot]" = field(default_factory=Future)
    _cancel: Event = field(default_factory=Event)
    _end: Callable[[], None] | None = None

    def __post_init__(self) -> None:
        self.done.set_running_or_notify_cancel()  # it ends by `cancel`, not by cancelling the future

    def snapshot(self) -> Snapshot:
        """Return the present state of the run."""
        return Snapshot(
            self.id, self.spec, self.status, self.created, self.progress, pinned=self.pinned, owners=self.owners
        )

    def begin(self) -> None:
        """Mark the run as running."""
        self.status = "running"

    def report(self, progress: float) -> None:
        """Record the share done."""
        self.progress = min(max(progress, self.progress), 1.0)

    def cancel(self) -> None:
        """End the run."""
        self._cancel.set()
        end = self._end
        if end is not None:
            end()

    def ends(self, end: Callable[[], None]) -> None:
        """Name the function that ends the computation of the run."""
        self._end = end
        if self._cancel.is_set():
            end()

    def forget_computation(self) -> None:
        """Let go of the computation, which has ended: it refers to the job and to the result.

        Otherwise both would stay, with all rows of the result, until Python searches for garbage, which it does rarely.
        """
        self._end = None

    @property
    def cancelled(self) -> bool:
        """Return whether cancellation was requested."""
        return self._cancel.is_set()


@dataclass(frozen=True)
class Ended:
    """A run that has ended. Failed and cancelled runs have only this; a run with a result is a :class:`Finished`."""

    snapshot: Snapshot

    @property
    def size(self) -> int:
        """Return the bytes of the result."""
        return 0

    def with_snapshot(self, **changes: Any) -> Self:
        """Return a copy with fields of the snapshot replaced."""
        return replace(self, snapshot=replace(self.snapshot, **changes))


@dataclass(frozen=True)
class Finished(Ended):
    """A run with its result."""

    result: Result

    @property
    def size(self) -> int:
        """Return the bytes of the result."""
        return self.result.data.nbytes
