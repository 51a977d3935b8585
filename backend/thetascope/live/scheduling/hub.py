"""All sessions of the service: opened, found, closed, and closed when nobody has been connected for long."""

import asyncio
import gc
import logging
import secrets
import sys
from collections import Counter, OrderedDict
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from thetascope.engine.errors import SpecError
from thetascope.live.room.playback_clock import MinimumInterval, RateLimiter
from thetascope.live.room.room_state import Transition
from thetascope.live.room.serial_queue import Background, Callback, Job, outcome
from thetascope.live.scheduling.fast_forward import FastForward, return_memory
from thetascope.live.scheduling.session_ids import new_id
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy, OverLimit
from thetascope.runs.workers.pool import Workers
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.service.session import CLOSE_ENDED, SessionCommand

if TYPE_CHECKING:
    from thetascope.live.room.room import Room
    from thetascope.live.room.room_parts import RoomServices
    from thetascope.live.scheduling.scheduler import Scheduler
    from thetascope.live.session.session import Session
    from thetascope.settings import Settings

log = logging.getLogger(__name__)

_ENDED = Message("session.close.ended")
_THREADS = 2  # kernels release Python's lock; the code around them does not
_WORKSHOPS = 2
_CHECKS = 0.2
"""Seconds between two checks of assumptions, of any sessions."""
_SWITCH = 0.0002
"""Seconds after which a thread releases Python's lock to the event loop. Every frame that is sent releases the lock, so
with Python's default of 5 ms one busy thread (a compilation) would leave 200 frames per second for all sessions
together."""
_TOGETHER = 32
"""Sessions that may each keep `past` bytes of samples (a setting); more sessions share the memory of this many."""
_TEMPLATES = 16
"""Sessions with only their first row, kept as copies for new ones: most sessions open one of a few experiments."""
_OPENING, _JOINING = 0.012, 0.006
"""Seconds between two sessions that open and between two viewers that join: twice the time of one, so that a crowd
leaves playing sessions the time they need."""
_COLLECT = 900.0
"""Seconds between two full garbage collections, if sessions were opened."""
_SESSION_ENDS = 10.0
"""Seconds after which a client with too many sessions may try again."""
_REHEARSED = 4096
"""Experiments whose opening was rehearsed and is not rehearsed again."""


class TooManySessions(Exception):
    """The service has as many sessions as it may have."""


class Hub:
    """The rooms by id. All methods are called on the event loop; sessions are created in threads.

    The engine and SymPy are imported with the first session, so that the service starts quickly.
    """

    def __init__(self, settings: "Settings", workers: Workers) -> None:
        self._settings, self._workers = settings, workers
        self._rooms: dict[str, Room] = {}
        self._clients: dict[str, str] = {}
        self._opening: Counter[str] = Counter()
        self._threads = ThreadPoolExecutor(_THREADS, thread_name_prefix="live")
        self._workshop = ThreadPoolExecutor(_WORKSHOPS, thread_name_prefix="workshop")
        self._loop: asyncio.AbstractEventLoop | None = None
        self._scheduler: Scheduler | None = None
        self._room_services: RoomServices | None = None
        self._sweep: asyncio.TimerHandle | None = None
        self._frozen, self._collected, self._closed_some = False, 0.0, False
        self._templates: OrderedDict[str, Session] = OrderedDict()
        self._rehearsed: OrderedDict[str, None] = OrderedDict()
        self._forward = FastForward(
            settings.job_seconds, lambda: workers.usage()["running"] > 0, lambda: self._opening, workers.count
        )
        self._openings, self._joins = RateLimiter(_OPENING), RateLimiter(_JOINING)

    def __len__(self) -> int:
        return len(self._rooms)

    def usage(self) -> dict[str, int]:
        """Return the open sessions, their viewers, and the frames so far with those that were late."""
        frames, late = (0, 0) if self._scheduler is None else (self._scheduler.frames, self._scheduler.frames_late)
        viewers = sum(len(room.broadcast.viewers) for room in list(self._rooms.values()))
        return {"sessions": len(self._rooms), "viewers": viewers, "frames": frames, "frames_late": late}

    def find(self, id: str) -> "Room | None":
        """Return the room of a session; None if the hub has no such session."""
        return self._rooms.get(id)

    async def create(
        self,
        read: Callable[[], ResolvedExperiment],
        t: float = 0.0,
        play: bool = True,
        speed: float | None = 1.0,
        rehearse: Callable[[ResolvedExperiment], Awaitable[None]] | None = None,
        client: str = "",
        most: int | None = None,
    ) -> "Room":
        """Open a session and return its room.

        Args:
            read: returns the spec; it runs in a thread, and its errors are raised here.
            t: time in s to advance to.
            play: whether time runs from the start.
            speed: simulated seconds per second; None: as fast as possible.
            rehearse: opens such a session in a worker process first, where that takes no longer than it may.
            client: whose turn it takes on the way to `t`, and whose session it is.
            most: sessions of the client that may be open.

        Raises:
            TooManySessions, OverLimit, SpecError.
        """
        loop, limit = asyncio.get_running_loop(), self._settings.session_rows
        self._workers.note_request(client)
        with self._reserve(client, most):
            await asyncio.sleep(self._openings.wait(loop.time()))
            spec = await loop.run_in_executor(self._workshop, read)
            key = spec.model_copy(update={"seed": 0}).model_dump_json()
            if rehearse is not None and key not in self._rehearsed:
                await rehearse(spec)
                self._rehearsed[key] = None
                while len(self._rehearsed) > _REHEARSED:
                    self._rehearsed.popitem(last=False)
            until = loop.time() + self._settings.job_seconds
            session = await loop.run_in_executor(self._workshop, lambda: self._template(spec, limit))
            await self._forward.advance(session, _rows_until(session, t, limit), self._past(), client, until)
            return self._add(session, play, speed, None, client)

    async def viewer_slot(self) -> None:
        """Return when the next viewer may join."""
        await asyncio.sleep(self._joins.wait(asyncio.get_running_loop().time()))

    async def fork(self, room: "Room", t: float | None = None, client: str = "", most: int | None = None) -> "Room":
        """Open a second session that continues from this one, at the present or an earlier time.
        Raises TooManySessions or OverLimit."""
        with self._reserve(client, most):
            session = await room.fork(t)
            return self._add(session, room.machine.playing, room.playback.speed, room.id, client)

    def close(self, room: "Room", reason: Message = _ENDED) -> None:
        """End a session."""
        self._rooms.pop(room.id, None)
        self._clients.pop(room.id, None)
        self._closed_some = True
        room.close(CLOSE_ENDED, reason)

    def stop(self) -> None:
        """End all sessions: no more frames, no more threads."""
        if self._sweep is not None:
            self._sweep.cancel()
        if self._scheduler is not None:
            self._scheduler.stop()
        self._rooms.clear()
        self._forward.stop()
        for pool in (self._threads, self._workshop):
            pool.shutdown(wait=False, cancel_futures=True)

    # ------------------------------------------------------------------------------------------------------------------

    def _template(self, spec: ResolvedExperiment, limit: int) -> "Session":
        """Return a session with its first row, copied from an earlier one on the same spec if there was one."""
        from thetascope.live.session.session import Session

        key = spec.model_dump_json()
        template = self._templates.pop(key, None)
        if template is None:
            template = Session(spec, limit)
            template.advance(1)
        self._templates[key] = template
        while len(self._templates) > _TEMPLATES:
            self._templates.popitem(last=False)
        return template.fork()

    def _past(self) -> int:
        """Return the bytes of samples that each session may keep now."""
        return share(self._settings.past, len(self._rooms))

    @contextmanager
    def _reserve(self, client: str, most: int | None) -> Iterator[None]:
        """Count a session that is being opened towards the limits while inside."""
        limit = self._settings.sessions
        if len(self._rooms) + self._opening.total() >= limit:
            raise TooManySessions(f"{limit} sessions are open")
        own = sum(name == client for name in self._clients.values()) + self._opening[client]
        if most is not None and own >= most:
            raise OverLimit(Message("client.sessions", n=most), _SESSION_ENDS)
        self._opening[client] += 1
        try:
            yield
        finally:
            self._opening[client] -= 1
            self._opening += Counter()  # drops clients that open none

    def _add(self, session: "Session", play: bool, speed: float | None, parent: str | None, client: str) -> "Room":
        from thetascope.live.room.room import Room

        services = self._start()
        id, token = new_id(self._settings.process), secrets.token_urlsafe(24)
        room = self._rooms[id] = Room(id, token, session, services, parent)
        self._clients[id] = client
        # Everything in memory now stays for a while. Otherwise Python's garbage collector would search SymPy and all
        # sessions now and then, for a tenth of a second in which no frame is sent.
        gc.freeze()
        self._frozen = True
        now = services.clock()
        room.playback.set_speed(speed, room.shown, now)
        if play and room.machine.allows(Transition.PLAY):
            room.playback.play(room.shown, now)
            room.clock_started()
        return room

    def _start(self) -> "RoomServices":
        """Return the services for rooms; the first call starts them."""
        if self._room_services is not None:
            return self._room_services
        from thetascope.live.room.room_parts import RoomServices
        from thetascope.live.scheduling.scheduler import Scheduler

        self._loop = loop = asyncio.get_running_loop()
        self._scheduler = Scheduler(loop)
        self._room_services = RoomServices(
            clock=loop.time,
            background=_in_pool(self._threads, loop),
            workshop=_in_pool(self._workshop, loop),
            rehearse=self._rehearse,
            wake=self._scheduler.wake,
            request_prefetch=self._scheduler.request_prefetch,
            request_detection=self._scheduler.request_detection,
            may_check=MinimumInterval(_CHECKS, loop.time).take,
            viewers=self._settings.viewers,
            backlog=self._settings.backlog,
            past=self._past,
        )
        sys.setswitchinterval(_SWITCH)
        self._collected = loop.time()
        self._sweep_rooms(loop)
        return self._room_services

    def _rehearse(
        self, spec: ResolvedExperiment, command: SessionCommand, client: str, then: Callback
    ) -> Callable[[], None]:
        """Carry out a command in a worker process, call back with None and the error, and return how to end it."""
        from thetascope.live.scheduling.rehearsal import rehearse_command

        loop = asyncio.get_running_loop()
        try:
            computation = self._workers.call(
                rehearse_command, spec, command, self._settings.session_rows, client=client
            )
        except Busy as refusal:
            loop.call_soon(then, None, refusal)
            return _nothing
        computation.result.add_done_callback(lambda done: _call_on(loop, partial(then, None, _error_of(done))))
        return computation.leave

    def _sweep_rooms(self, loop: asyncio.AbstractEventLoop) -> None:
        """Close sessions without viewers that are idle for too long, and free their memory;
        repeated every few seconds."""
        idle, now = self._settings.idle, loop.time()
        for room in list(self._rooms.values()):
            if room.empty_since is not None and now - room.empty_since > idle:
                self.close(room, Message("session.close.idle"))
        if self._closed_some:
            self._closed_some = False
            self._threads.submit(return_memory)
        if self._rooms:
            gc.freeze()  # objects that have lived until now: collections then have little to search
            self._frozen = True
        if self._frozen and now - self._collected > _COLLECT:
            gc.unfreeze()
            gc.collect()
            gc.freeze()
            self._frozen, self._collected = False, loop.time()
        self._sweep = loop.call_later(min(5.0, max(0.1, idle / 4)), self._sweep_rooms, loop)


def _in_pool(pool: ThreadPoolExecutor, loop: asyncio.AbstractEventLoop) -> Background:
    """Return the function that runs a job in a pool and its callback on the loop; neither once the pool has ended."""

    def run(job: Job, then: Callback) -> None:
        def work() -> None:
            answer = outcome(job)
            loop.call_soon_threadsafe(partial(then, *answer))

        with suppress(RuntimeError):  # the service ends
            pool.submit(work)

    return run


def share(past: int, sessions: int) -> int:
    """Return the bytes of samples for each of `sessions` sessions, where a few may keep `past` bytes each."""
    return past * _TOGETHER // max(_TOGETHER, sessions)


def _rows_until(session: "Session", t: float, limit: int) -> int:
    """Return the rows of a session that is at time `t` in s. Raises SpecError if that is beyond `limit` rows."""
    rows = round(t / session.record) + 1
    if rows > limit:
        record = session.record
        problem = Message(
            "session.open.beyond-limit", limit=limit, duration=limit * record, latest=(limit - 1) * record
        )
        raise SpecError("t", t, problem)
    return rows


def _call_on(loop: asyncio.AbstractEventLoop, then: Callable[[], Any]) -> None:
    """Call back on the loop, unless it has ended."""
    with suppress(RuntimeError):
        loop.call_soon_threadsafe(then)


def _error_of(done: "Future[Any]") -> Exception | None:
    """Return the exception of a future that is done, or None."""
    error = done.exception()
    return error if isinstance(error, Exception) else None


def _nothing() -> None:
    """End nothing."""
