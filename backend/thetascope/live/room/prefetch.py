"""Computing rows ahead: in two halves on the event loop, with commands and frames in between,
or in a thread if rows are slow."""

import logging
from collections.abc import Callable
from functools import partial
from time import thread_time
from typing import TYPE_CHECKING, Any

from thetascope.live.room.prefetch_plan import commit, compute

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.snapshots import SimulatedRows

log = logging.getLogger(__name__)


class Prefetcher:
    """The prefetcher of one room. All methods are called on the event loop."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._busy = False
        self._simulated: tuple[SimulatedRows | None, float] | None = None  # the first half, and the seconds it took

    @property
    def halfway(self) -> bool:
        """Whether rows are simulated whose columns are not made yet."""
        return self._simulated is not None

    def wanted(self) -> tuple[int, bool] | None:
        """Return how many rows to compute now, and whether in a thread; None if none."""
        room, target = self._room, self._room.playback.target
        if self._busy or not room.machine.running or room.broadcast.complete or room.broadcast.blocked:
            return None
        wanted = room.prefetch_plan.wanted(room.playback, room.broadcast.left, room.broadcast.most)
        if wanted is not None and room.waits_for_diagnosis:
            return None
        if wanted is None or target is None:
            return wanted
        rows = min(wanted[0], target - room.shown - room.broadcast.left)
        return (rows, wanted[1]) if rows > 0 else None

    def prefetch_rows(self) -> None:
        """Compute rows ahead if that is needed."""
        room = self._room
        if self._simulated is not None:
            self._commit(*self._simulated)
        elif (wanted := self.wanted()) is not None:
            rows, thread = wanted
            self._busy = True
            if thread:
                room.queue.submit(partial(_timed, compute, room.session, rows, room.services.past()), self._done, True)
            else:
                room.queue.submit(partial(_timed, room.session.simulate, rows), self._halfway)

    def _halfway(self, value: Any, error: Exception | None) -> None:
        """Do the second half in a free moment, or now if a frame waits for the rows."""
        if error is not None:
            self._done(None, error)
            return
        self._simulated, room = value, self._room
        if room.prefetch_plan.behind(room.playback, room.broadcast.left) and room.machine.playing:
            self._commit(*value)
        else:
            room.request_prefetch(True)

    def _commit(self, simulated: "SimulatedRows | None", seconds: float) -> None:
        self._simulated = None
        job = partial(_timed, commit, self._room.session, simulated, self._room.services.past())
        self._room.queue.submit(job, partial(self._done, spent=seconds))

    def _done(self, value: Any, error: Exception | None, spent: float = 0.0) -> None:
        self._busy, room = False, self._room
        if room.machine.closed:
            return
        if error is not None:
            log.error("session %s cannot continue", room.id, exc_info=error)
            room.broadcast.complete = True
            room.update_end()
            room.send_status()
            return
        batch, seconds = value
        room.prefetch_plan.measured(batch.rows.shape[1], spent + seconds)
        room.accept_rows(batch)
        target = room.playback.target
        if (target is not None or room.playback.speed is None) and not room.machine.held:
            if target is not None:
                room.show(target, room.services.clock())
            self.prefetch_rows()
        elif room.machine.playing and room.prefetch_plan.behind(room.playback, room.broadcast.left):
            self.prefetch_rows()


def _timed(job: Callable[..., Any], *args: Any) -> tuple[Any, float]:
    """Return a job's value and its processor seconds; wall time would make the batches ever smaller on a busy
    machine."""
    begin = thread_time()
    value = job(*args)
    return value, thread_time() - begin
