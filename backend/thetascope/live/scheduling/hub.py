"""All sessions of the service: opened, found, closed, and closed when nobody has watched them for long."""

import asyncio
import gc
import logging
import secrets
import sys
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING

from thetascope.engine.errors import SpecError
from thetascope.live.room.playback_clock import MinimumInterval, RateLimiter
from thetascope.live.room.serial_queue import Background, Callback, Job, outcome
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.service.session import CLOSE_ENDED

if TYPE_CHECKING:
    from thetascope.live.room.room import Room
    from thetascope.live.scheduling.scheduler import Scheduler
    from thetascope.live.session.session import Session
    from thetascope.settings import Settings

log = logging.getLogger(__name__)

_THREADS = 2  # kernels leave Python's lock; what is around them does not
_WORKSHOPS = 2
_CHECKS = 0.2
"""Seconds between checks of assumptions, of whatever session."""
_SWITCH = 0.0002
"""Seconds after which a thread lets the event loop go on. Every frame that is sent gives Python's lock away, so at Python's
own 5 ms a single busy thread (a compilation) would leave 200 frames a second for all sessions together."""
_TOGETHER = 32
"""Sessions that may each keep all the samples of the setting ``past``; if there are more, they share that room."""
_TEMPLATES = 16
"""Sessions that have their first row only, kept to be copied: most are opened on the same few experiments."""
_OPENING, _JOINING = 0.012, 0.006
"""Seconds between two sessions that are opened, two viewers that come: twice what one takes, so that a crowd leaves the
sessions that play already the time they need."""
_COLLECT = 900.0
"""Seconds between two times that all memory is searched for what is no longer needed, if sessions were opened."""
_ROWS = 4096  # asked for at once on the way to a session's first row


class TooManySessions(Exception):
    """There are as many sessions as there may be."""


class Hub:
    """The rooms by id. Everything is called on the event loop; sessions are made in threads.

    What is needed to run them (the engine, SymPy) is imported with the first session, so the service starts without.
    """

    def __init__(self, settings: "Settings") -> None:
        self._settings = settings
        self._rooms: dict[str, Room] = {}
        self._opening = 0
        self._threads = ThreadPoolExecutor(_THREADS, thread_name_prefix="live")
        self._workshop = ThreadPoolExecutor(_WORKSHOPS, thread_name_prefix="workshop")
        self._loop: asyncio.AbstractEventLoop | None = None
        self._scheduler: Scheduler | None = None
        self._sweep: asyncio.TimerHandle | None = None
        self._frozen, self._collected = False, 0.0
        self._templates: OrderedDict[str, Session] = OrderedDict()
        self._doors, self._seats = RateLimiter(_OPENING), RateLimiter(_JOINING)

    def __len__(self) -> int:
        return len(self._rooms)

    def find(self, id: str) -> "Room | None":
        """The session's room."""
        return self._rooms.get(id)

    async def create(
        self, read: Callable[[], ResolvedExperiment], t: float = 0.0, play: bool = True, speed: float | None = 1.0
    ) -> "Room":
        """Open a session on what `read` gives (a spec with its plant in full), advanced to time `t`.

        Raises :class:`TooManySessions`, SpecError, and what `read` raises.
        """
        rows, past = self._settings.session_rows, self._past()
        return await self._open(lambda: _advanced(self._begun(read(), rows), rows, past, t), play, speed)

    async def viewer_slot(self) -> None:
        """Return when the next viewer may come."""
        await asyncio.sleep(self._seats.wait(asyncio.get_running_loop().time()))

    async def fork(self, room: "Room", t: float | None = None) -> "Room":
        """A second session that begins where this one stands, or at an earlier time. Raises :class:`TooManySessions`."""
        with self._reserve():
            session = await room.fork(t)
        return self._add(session, room.playback.playing, room.playback.speed, room.id)

    def close(self, room: "Room", reason: str = "the session was ended") -> None:
        """End a session."""
        self._rooms.pop(room.id, None)
        room.close(CLOSE_ENDED, reason)

    def stop(self) -> None:
        """End the service: no more frames, no more threads."""
        if self._sweep is not None:
            self._sweep.cancel()
        if self._scheduler is not None:
            self._scheduler.stop()
        self._rooms.clear()
        for pool in (self._threads, self._workshop):
            pool.shutdown(wait=False, cancel_futures=True)

    # --------------------------------------------------------------------------------------------------------------------

    async def _open(self, make: Callable[[], "Session"], play: bool, speed: float | None) -> "Room":
        loop = asyncio.get_running_loop()
        with self._reserve():
            await asyncio.sleep(self._doors.wait(loop.time()))
            session = await loop.run_in_executor(self._workshop, make)
        return self._add(session, play, speed, None)

    def _begun(self, spec: ResolvedExperiment, limit: int) -> "Session":
        """A session that has its first row: a copy of one that was opened before, if there was one on the same spec."""
        from thetascope.live.session.session import Session

        key = spec.model_dump_json()
        found = self._templates.pop(key, None)
        if found is None:
            found = Session(spec, limit)
            found.advance(1)
        self._templates[key] = found
        while len(self._templates) > _TEMPLATES:
            self._templates.popitem(last=False)
        return found.fork()

    def _past(self) -> int:
        """Bytes of samples that a session may keep now."""
        return share(self._settings.past, len(self._rooms))

    def _reserve(self) -> "_Reservation":
        limit = self._settings.sessions
        if len(self._rooms) + self._opening >= limit:
            raise TooManySessions(f"{limit} sessions are open")
        return _Reservation(self)

    def _add(self, session: "Session", play: bool, speed: float | None, parent: str | None) -> "Room":
        from thetascope.live.room.room import Room

        self._start()
        id, token = secrets.token_urlsafe(12), secrets.token_urlsafe(24)
        room = self._rooms[id] = Room(id, token, session, self._room_services, parent)
        # What is there by now stays for a while. Without this, Python's collector would go through SymPy and all sessions
        # now and again, for a tenth of a second in which no frame is sent.
        gc.freeze()
        self._frozen = True
        now = room.services.clock()
        room.playback.set_speed(speed, room.shown, now)
        if play and not room.ended:
            room.playback.play(room.shown, now)
            room.clock_started()
        return room

    def _start(self) -> None:
        """With the first session."""
        if self._loop is not None:
            return
        from thetascope.live.room.room_parts import RoomServices
        from thetascope.live.scheduling.scheduler import Scheduler

        self._loop = asyncio.get_running_loop()
        self._scheduler = Scheduler(self._loop)
        self._room_services = RoomServices(
            clock=self._loop.time,
            background=self._in(self._threads),
            workshop=self._in(self._workshop),
            wake=self._scheduler.wake,
            request_prefetch=self._scheduler.request_prefetch,
            request_detection=self._scheduler.request_detection,
            may_check=MinimumInterval(_CHECKS, self._loop.time).take,
            viewers=self._settings.viewers,
            backlog=self._settings.backlog,
            past=self._past,
        )
        sys.setswitchinterval(_SWITCH)
        self._collected = self._loop.time()
        self._swept()

    def _in(self, pool: ThreadPoolExecutor) -> Background:
        """Background work in a pool."""
        loop = self._loop

        def run(job: Job, then: Callback) -> None:
            def work() -> None:
                answer = outcome(job)
                loop.call_soon_threadsafe(partial(then, *answer))

            pool.submit(work)

        return run

    def _swept(self) -> None:
        """Close what nobody has watched for long, now and again, and free its memory."""
        idle, now = self._settings.idle, self._loop.time()
        for room in list(self._rooms.values()):
            if room.empty_since is not None and now - room.empty_since > idle:
                self.close(room, "nobody has watched the session for long")
        if self._rooms:
            gc.freeze()  # what has lived until now: then no collection goes through much
            self._frozen = True
        if self._frozen and now - self._collected > _COLLECT:
            gc.unfreeze()
            gc.collect()
            gc.freeze()
            self._frozen, self._collected = False, self._loop.time()
        self._sweep = self._loop.call_later(min(5.0, max(0.1, idle / 4)), self._swept)


class _Reservation:
    """A session that is being opened counts as one of those there may be."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub

    def __enter__(self) -> None:
        self._hub._opening += 1

    def __exit__(self, *_: object) -> None:
        self._hub._opening -= 1


def share(past: int, sessions: int) -> int:
    """Bytes of samples for each of so many sessions, where a few may keep ``past`` bytes each."""
    return past * _TOGETHER // max(_TOGETHER, sessions)


def _advanced(session: "Session", limit: int, past: int, t: float) -> "Session":
    """The session with all rows up to time t."""
    from thetascope.live.room.prefetch_plan import compute

    rows = round(t / session.record) + 1
    if rows > limit:
        raise SpecError(
            "t",
            t,
            f"a session has at most {limit:,} rows, that is {limit * session.record:g} s",
            f"give at most {(limit - 1) * session.record:g}, or raise THETASCOPE_SESSION_ROWS",
        )
    while session.row < rows and not session.ended:
        compute(session, min(_ROWS, rows - session.row), past)
    return session
