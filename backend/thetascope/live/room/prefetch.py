"""How a room computes ahead: in two halves on the event loop, so that commands and frames come between, or in a thread where rows cost much."""

import logging
from collections.abc import Callable
from functools import partial
from time import thread_time
from typing import TYPE_CHECKING, Any

from thetascope.live.room.prefetch_plan import completed, compute

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.snapshots import SimulatedRows

log = logging.getLogger(__name__)


class Prefetcher:
    """Of one room. Everything is called on the event loop."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._busy = False
        self._begun: tuple[SimulatedRows | None, float] | None = None  # rows half computed, and the seconds that took

    @property
    def halfway(self) -> bool:
        return self._begun is not None

    def wanted(self) -> tuple[int, bool] | None:
        """How many rows to compute ahead now, and whether in a thread."""
        room, target = self._room, self._room.playback.target
        if (
            self._busy
            or room.finished
            or room.broadcast.blocked
            or room.frozen
            or room.closed
            or not room.playback.moving
        ):
            return None
        wanted = room.prefetch_plan.wanted(room.playback, room.broadcast.left, room.broadcast.most)
        if wanted is None or target is None:
            return wanted
        rows = min(wanted[0], target - room.shown - room.broadcast.left)
        return (rows, wanted[1]) if rows > 0 else None

    def prefetch_rows(self) -> None:
        """Compute ahead, if there is need to."""
        room = self._room
        if self._begun is not None:
            self._complete()
        elif (wanted := self.wanted()) is not None:
            rows, thread = wanted
            self._busy = True
            if thread:
                room.queue.submit(
                    partial(_timed, compute, room.session, rows, room.services.past()), self._filled, True
                )
            else:
                room.queue.submit(partial(_timed, room.session.simulate, rows), self._halfway)

    def _halfway(self, value: Any, error: Exception | None) -> None:
        """Rows are simulated; the rest is done in a free moment, or at once where a frame waits for it."""
        if error is not None:
            self._filled(None, error)
            return
        self._begun, room = value, self._room
        if room.prefetch_plan.behind(room.playback, room.broadcast.left):
            self._complete()
        else:
            room.services.request_prefetch(room, True)

    def _complete(self) -> None:
        (begun, spent), self._begun = self._begun, None
        job = partial(_timed, completed, self._room.session, begun, self._room.services.past())
        self._room.queue.submit(job, partial(self._filled, spent=spent))

    def _filled(self, value: Any, error: Exception | None, spent: float = 0.0) -> None:
        self._busy, room = False, self._room
        if error is not None:
            log.error("session %s cannot go on", room.id, exc_info=error)
            room.finished = True
            room.send_status()
            return
        computed, seconds = value
        room.prefetch_plan.measured(computed.rows.shape[1], spent + seconds)
        room.accept_rows(computed)
        hurried = room.playback.target is not None or room.playback.speed is None
        if hurried and not room.frozen:
            if room.playback.target is not None:
                room.show(room.playback.target, room.services.clock())
            self.prefetch_rows()
        elif room.prefetch_plan.behind(room.playback, room.broadcast.left):
            self.prefetch_rows()


def _timed(job: Callable[..., Any], *given: Any) -> tuple[Any, float]:
    begin = thread_time()  # not the time of day: on a busy machine that would make the pieces ever smaller
    value = job(*given)
    return value, thread_time() - begin
