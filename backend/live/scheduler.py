"""One clock for all sessions: it calls each room's tick when its next frame is due.

A single timer stands for the earliest of them, so 400 sessions are no more than one on the event loop, and no session
has a sleep of its own to drift. Rooms begin at different moments, so their frames spread over time by themselves.
"""

import asyncio
import logging
from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from math import ceil, inf

from backend.live.pacing import FRAME
from backend.live.room import Room

log = logging.getLogger(__name__)

SHARE = 0.002
"""Seconds after which the event loop gets its turn, so that commands are read however many frames are due."""
SLOT, FEW = FRAME / 8, 20
"""Where there are more than a few rooms, those whose frames are due within such a slot are called together at its end:
waking up for each would cost as much as its frame. A frame's time is a whole number of slots, so every room keeps its beat."""
_TINY = 1e-6  # s, for the rounding of times
PAUSE = 0.002
"""Seconds between two rooms that compute ahead."""
TURNS = 2
"""Turns of the event loop before a room computes ahead: so many it takes from a socket to the command's being carried out."""


class Scheduler:
    """Ticks rooms. Made and used on the event loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._due: list[tuple[float, int, Room]] = []
        self._when: dict[Room, float] = {}
        self._hungry: dict[Room, None] = {}  # in order
        self._feeding = 0.0  # when the next of them may compute
        self._order = count()
        self._timer: asyncio.TimerHandle | None = None
        self._running = False
        self._stopped = False

    def wake(self, room: Room, at: float) -> None:
        """Tick a room then, if not earlier anyway."""
        known = self._when.get(room)
        if self._stopped or (known is not None and known <= at):
            return
        self._when[room] = at
        heappush(self._due, (at, next(self._order), room))
        if not self._running:
            self._arm()

    def feed(self, room: Room) -> None:
        """Let a room compute ahead when no frame is due."""
        self._hungry[room] = None

    def stop(self) -> None:
        """Tick no more."""
        self._stopped = True
        self._due.clear()
        self._when.clear()
        self._hungry.clear()
        if self._timer is not None:
            self._timer.cancel()

    def _arm(self) -> None:
        if self._due and not self._stopped:
            at = self._due[0][0]
            if len(self._when) > FEW:
                at = ceil((at - _TINY) / SLOT) * SLOT
            if self._hungry:
                at = min(at, self._feeding)
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
                    following = self._guarded(room, room.tick, at)
                    if following is not None:
                        self.wake(room, following)
                now = self._loop.time()
            if self._hungry and now >= self._feeding and (not self._due or self._due[0][0] > now + _TINY):
                self._feeding = inf
                self._loop.call_soon(self._give_way, TURNS)
        finally:
            self._running = False
            self._arm()

    def _give_way(self, turns: int) -> None:
        """Let commands that have come, or are on their way through the event loop, be carried out before a room computes."""
        if turns > 0:
            self._loop.call_soon(self._give_way, turns - 1)
            return
        room = next(iter(self._hungry), None)
        if room is not None:
            del self._hungry[room]
            self._guarded(room, room.fill)
        self._feeding = self._loop.time() + PAUSE
        if not self._running:
            self._arm()

    def _guarded(self, room: Room, work: Callable[..., float | None], *given: float) -> float | None:
        """Do something with a room; if it fails the others go on."""
        try:
            return work(*given)
        except Exception:
            log.exception("session %s", room.id)
            return None
