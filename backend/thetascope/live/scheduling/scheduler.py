"""One timer for all sessions: it calls each room's tick when its next frame is due.

The timer is set to the earliest of them, so 400 sessions cost the event loop no more than one, and no session drifts
with a sleep of its own. Rooms begin at different times, so their frames are spread over time.
"""

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from math import ceil, inf
from typing import Any

from thetascope.live.room.playback_clock import FRAME
from thetascope.live.room.room_parts import ScheduledRoom
from thetascope.live.scheduling.time_slices import TimeSlices

log = logging.getLogger(__name__)

SHARE = 0.002
"""Seconds of frames after which the event loop continues, so that commands are read however many frames are due."""
FEW, MANY, TOGETHER, SLOTS = 20, 150, 50, 8
"""More than a few rooms are called together, once per frame time: waking up for each would cost as much as its frame,
and data that one has brought into the processor's caches serves the next. Many rooms get several such calls per frame
time, a power of two up to a limit, with about fifty rooms in each."""
_TINY = 1e-6  # s, tolerance for the rounding of times
PAUSE = 0.002
"""Seconds between two rooms that compute ahead."""
SLICE, REST = 0.0005, 0.001
"""Seconds of one slice of testing for faults, and between two slices; only while no room waits to compute ahead."""
PATIENCE, SHORT_REST = 0.25, 0.0001
"""When rooms have waited this long (s) for these tests, slices follow each other after a shorter time."""
TURNS = 2
"""Turns of the event loop before a room computes ahead: as many as from a socket's data to the command's execution."""


def slot(rooms: int) -> float:
    """Return the seconds between two calls for this many rooms, each for the rooms whose frames are due by then."""
    return FRAME / (1 if rooms < MANY else min(SLOTS, 1 << ((rooms // TOGETHER).bit_length() - 1)))


class Scheduler:
    """Ticks rooms. It is created and used on the event loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._due: list[tuple[float, int, ScheduledRoom]] = []
        self._when: dict[ScheduledRoom, float] = {}
        self._needs_prefetch: OrderedDict[ScheduledRoom, None] = OrderedDict()
        self._next_free_work = 0.0  # when the next room may compute ahead or be tested
        self._needs_detection: dict[ScheduledRoom, None] = {}  # in order
        self._slices = TimeSlices()
        self._testing_since: float | None = None  # when rooms began to wait for tests, without a moment of none
        self._order = count()
        self._timer: asyncio.TimerHandle | None = None
        self._running = False
        self._stopped = False
        self.frames, self.frames_late = 0, 0  # late: by more than the time of one frame

    def wake(self, room: ScheduledRoom, at: float) -> None:
        """Tick a room at a time, or earlier if that is scheduled already."""
        known = self._when.get(room)
        if self._stopped or (known is not None and known <= at):
            return
        self._when[room] = at
        heappush(self._due, (at, next(self._order), room))
        if not self._running:
            self._arm()

    def request_prefetch(self, room: ScheduledRoom, first: bool) -> None:
        """Let a room compute ahead when no frame is due, before all waiting rooms (`first`) or after them."""
        self._needs_prefetch[room] = None
        if first:
            self._needs_prefetch.move_to_end(room, last=False)
        if not self._running:
            self._arm()

    def request_detection(self, room: ScheduledRoom) -> None:
        """Let a room's waiting rows be tested for faults when there is nothing else to do."""
        self._needs_detection[room] = None
        if not self._running:
            self._arm()

    def stop(self) -> None:
        """Stop ticking."""
        self._stopped = True
        self._due.clear()
        self._when.clear()
        self._needs_prefetch.clear()
        self._needs_detection.clear()
        if self._timer is not None:
            self._timer.cancel()

    @property
    def _left(self) -> bool:
        """Whether there is work for free moments."""
        return bool(self._needs_prefetch or self._needs_detection or self._slices.busy)

    def _arm(self) -> None:
        if (self._due or self._left) and not self._stopped:
            at = self._due[0][0] if self._due else self._next_free_work
            if self._due and len(self._when) > FEW:
                part = slot(len(self._when))
                at = ceil((at - _TINY) / part) * part
            if self._left:
                at = min(at, self._next_free_work)
            if self._timer is not None:
                if self._timer.when() <= at and not self._timer.cancelled():
                    return
                self._timer.cancel()
            self._timer = self._loop.call_at(at, self._run)

    def _run(self) -> None:
        self._timer, self._running = None, True
        begin = now = self._loop.time()
        try:
            while self._due and self._due[0][0] <= now + _TINY and now - begin < SHARE:
                at, _, room = heappop(self._due)
                if self._when.get(room) == at:
                    del self._when[room]
                    self.frames += 1
                    self.frames_late += now - at > FRAME
                    following = self._guarded(room, room.tick, at)
                    if following is not None:
                        self.wake(room, following)
                now = self._loop.time()
            if self._left and now >= self._next_free_work and (not self._due or self._due[0][0] > now + _TINY):
                self._next_free_work = inf
                self._loop.call_soon(self._give_way, TURNS)
        finally:
            self._running = False
            self._arm()

    def _give_way(self, turns: int) -> None:
        """Let commands that are on their way through the event loop be carried out before a room computes ahead."""
        if turns > 0:
            self._loop.call_soon(self._give_way, turns - 1)
            return
        room = next(iter(self._needs_prefetch), None)
        if room is not None:
            del self._needs_prefetch[room]
            self._guarded(room, room.prefetch_rows)
        else:
            self._slice()
        self._next_free_work = self._loop.time() + (self._rest() if room is None else PAUSE)
        if not self._running:
            self._arm()

    def _slice(self) -> None:
        """Test waiting rows for one slice of time."""
        while not self._slices.busy and self._needs_detection:
            room = next(iter(self._needs_detection))
            del self._needs_detection[room]
            pending = self._guarded(room, room.detection_job)
            if pending is not None:
                self._slices.begin(*pending)
        if self._slices.busy and not self._stopped:
            self._slices.run_for(SLICE)

    def _rest(self) -> float:
        """Return the seconds between two slices."""
        now = self._loop.time()
        if not (self._needs_detection or self._slices.busy):
            self._testing_since = None
            return REST
        if self._testing_since is None:
            self._testing_since = now
        return REST if now - self._testing_since < PATIENCE else SHORT_REST

    def _guarded(self, room: ScheduledRoom, work: Callable[..., Any], *args: float) -> Any:
        """Return the value of work for a room; if it fails the others continue."""
        try:
            return work(*args)
        except Exception:
            log.exception("session %s", room.id)
            return None
