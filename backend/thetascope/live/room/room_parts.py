"""What a room needs of the outside, and what its parts need of the room."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from thetascope.live.room.playback_clock import PlaybackClock
from thetascope.live.room.prefetch_plan import PrefetchPlan, RowBatch
from thetascope.live.room.serial_queue import Background, SerialQueue
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis

if TYPE_CHECKING:
    from thetascope.live.room.broadcast import Broadcast
    from thetascope.live.session.session import Session


class PublishesFacts(Protocol):
    """What the parts of a room need of its facts."""

    def changed(self, urgent: bool = False) -> None: ...

    def publish(self, urgent: bool = False) -> None: ...

    def learn(self, diagnosis: ObserverDiagnosis) -> None: ...


class RoomParts(Protocol):
    """A room as its commands, its look ahead and its checks see it."""

    id: str
    session: "Session"
    services: "RoomServices"
    broadcast: "Broadcast"
    playback: PlaybackClock
    prefetch_plan: PrefetchPlan
    queue: SerialQueue
    facts: "PublishesFacts"
    frozen: bool
    finished: bool
    closed: bool

    @property
    def shown(self) -> int: ...

    @property
    def ended(self) -> bool: ...

    def send_status(self) -> None: ...

    def show(self, due: float, now: float) -> None: ...

    def prefetch_rows(self) -> None: ...

    def accept_rows(self, computed: RowBatch) -> None: ...

    def clock_started(self) -> None: ...

    def run_exclusive(self, job: Callable[[], Any], long: bool = False) -> Awaitable[Any]: ...


@dataclass(frozen=True)
class RoomServices:
    """What a room needs of the outside.

    clock: seconds. background: short jobs in a thread; workshop: long ones (compiling). wake(room, at): tick then. feed(room, first):
    fill when there is time, before all others or after them. watch(room): do what its `inspection` has to watch when there is time, in slices. may_check: whether
    it is time again for the checks of any session. viewers: how many there may be. backlog: bytes of samples that a viewer
    may be behind; past: those that a session may keep.
    """

    clock: Callable[[], float]
    background: Background
    workshop: Background
    wake: Callable[[RoomParts, float], None]
    request_prefetch: Callable[[RoomParts, bool], None]
    request_detection: Callable[[RoomParts], None]
    may_check: Callable[[], bool]
    viewers: int
    backlog: int
    past: Callable[[], int]
