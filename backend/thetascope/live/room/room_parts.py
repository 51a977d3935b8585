"""The interface of a room to its parts, and the interface of the service to a room."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from thetascope.diagnosis.yield_points import Steps
from thetascope.live.room.playback_clock import PlaybackClock
from thetascope.live.room.prefetch_plan import PrefetchPlan, RowBatch
from thetascope.live.room.room_state import RoomMachine
from thetascope.live.room.serial_queue import Background, Callback, SerialQueue
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis
from thetascope_schemas.service.session import SessionCommand

if TYPE_CHECKING:
    from thetascope.live.room.broadcast import Broadcast
    from thetascope.live.session.session import Session


class PublishesFacts(Protocol):
    """The facts of a room as its other parts see them."""

    def changed(self, urgent: bool = False) -> None:
        """Publish after a change: now, or with the next rows if facts were sent a moment ago."""
        ...

    def publish(self, urgent: bool = False) -> None:
        """Send the facts if they have changed."""
        ...

    def learn(self, diagnosis: ObserverDiagnosis) -> None:
        """Use the newest report of the detector."""
        ...


class RoomParts(Protocol):
    """A room as its commands, its prefetcher and its background checks see it."""

    id: str
    session: "Session"
    services: "RoomServices"
    machine: RoomMachine
    broadcast: "Broadcast"
    playback: PlaybackClock
    prefetch_plan: PrefetchPlan
    queue: SerialQueue

    @property
    def facts(self) -> PublishesFacts:
        """The facts of the room."""
        ...

    @property
    def shown(self) -> int:
        """Rows shown so far."""
        ...

    @property
    def waits_for_diagnosis(self) -> bool:
        """Whether no rows may be computed ahead before more of them are tested for faults."""
        ...

    def send_status(self) -> None:
        """Send the status to all viewers."""
        ...

    def show(self, due: float, now: float) -> None:
        """Show rows up to `due` − 1, as far as they are computed."""
        ...

    def prefetch_rows(self) -> None:
        """Compute rows ahead if that is needed."""
        ...

    def accept_rows(self, batch: RowBatch) -> None:
        """Add computed rows; they are shown when they are due."""
        ...

    def update_end(self) -> None:
        """Tell the state machine whether rows can follow."""
        ...

    def clock_started(self) -> None:
        """Schedule frames: time runs from now on."""
        ...

    def request_prefetch(self, first: bool) -> None:
        """Ask for `prefetch_rows` when there is time, before all other rooms (`first`) or after them."""
        ...

    def request_detection(self) -> None:
        """Ask for waiting rows to be tested for faults when there is time."""
        ...

    def run_exclusive(self, job: Callable[[], Any], long: bool = False) -> Awaitable[Any]:
        """Return the value of a job on the session."""
        ...


class ScheduledRoom(Protocol):
    """A room as the scheduler sees it."""

    id: str

    def tick(self, at: float) -> float | None:
        """Show the rows that are due; return when to call again."""
        ...

    def prefetch_rows(self) -> None:
        """Compute rows ahead if that is needed."""
        ...

    def detection_job(self) -> tuple[Steps[Any], Callback] | None:
        """Return the steps that test waiting rows for faults, and their callback."""
        ...


@dataclass(frozen=True)
class RoomServices:
    """The parts of the service that a room uses.

    Args:
        clock: returns the time, s.
        background: runs short jobs in a thread.
        workshop: runs long jobs in a thread.
        rehearse: carries out a command of a client in a worker process, where its kernels are compiled; calls back with
            the error, if it took too much time or memory, and returns a function that ends it.
        wake: schedules a room's tick at a time.
        request_prefetch: schedules a room's `prefetch_rows`, before all other rooms (True) or after them.
        request_detection: schedules testing a room's waiting rows for faults, in slices.
        may_check: returns whether assumptions of any session may be checked now.
        viewers: viewers that a room may have.
        backlog: bytes of samples that a viewer may be behind.
        past: returns the bytes of samples that a session may keep.
    """

    clock: Callable[[], float]
    background: Background
    workshop: Background
    rehearse: Callable[[ResolvedExperiment, SessionCommand, str, Callback], Callable[[], None]]
    wake: Callable[[ScheduledRoom, float], None]
    request_prefetch: Callable[[ScheduledRoom, bool], None]
    request_detection: Callable[[ScheduledRoom], None]
    may_check: Callable[[], bool]
    viewers: int
    backlog: int
    past: Callable[[], int]
