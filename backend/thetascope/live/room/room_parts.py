"""What a room needs of the outside, and what its parts need of the room."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from thetascope.live.room.playback_clock import Pace
from thetascope.live.room.prefetch_plan import Computed, Lookahead
from thetascope.live.room.serial_queue import Background, Turns

if TYPE_CHECKING:
    from thetascope.live.room.broadcast import Screen
    from thetascope.live.session.session import Session


class RoomParts(Protocol):
    """A room as its commands, its look ahead and its checks see it."""

    id: str
    session: "Session"
    house: "House"
    screen: "Screen"
    pace: Pace
    lookahead: Lookahead
    turns: Turns
    frozen: bool
    finished: bool
    closed: bool

    @property
    def shown(self) -> int: ...

    @property
    def ended(self) -> bool: ...

    def tell_status(self) -> None: ...

    def show(self, due: float, now: float) -> None: ...

    def fill(self) -> None: ...

    def take(self, computed: Computed) -> None: ...

    def moving(self) -> None: ...

    def alone(self, job: Callable[[], Any], long: bool = False) -> Awaitable[Any]: ...


@dataclass(frozen=True)
class House:
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
    feed: Callable[[RoomParts, bool], None]
    watch: Callable[[RoomParts], None]
    may_check: Callable[[], bool]
    viewers: int
    backlog: int
    past: Callable[[], int]
