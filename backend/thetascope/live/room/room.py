"""A session with its viewers: time goes on, rows become frames, and viewers come and go.

Everything here runs on the event loop, except the jobs on the session, which take turns (serial_queue.py). Nothing here waits
for a viewer. Commands are in command_handler.py.
"""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thetascope.live.room.background_checks import BackgroundChecks
from thetascope.live.room.broadcast import Broadcast
from thetascope.live.room.command_handler import CommandHandler
from thetascope.live.room.facts_publisher import FactsPublisher
from thetascope.live.room.playback_clock import MeasuredSpeed, PlaybackClock
from thetascope.live.room.prefetch import Prefetcher
from thetascope.live.room.prefetch_plan import PrefetchPlan, RowBatch
from thetascope.live.room.room_parts import RoomServices
from thetascope.live.room.serial_queue import SerialQueue
from thetascope.live.wire.viewer import Viewer
from thetascope_schemas import Experiment
from thetascope_schemas.service.session import Event, Hello, Status

if TYPE_CHECKING:
    from thetascope.live.session.session import Session

STATUS = 1.0
"""Seconds between two messages on how a session stands while it plays."""
CHECKS = 3.0
"""Seconds between two checks of the assumptions, at least."""
ASLEEP = 60.0
"""Seconds without a viewer after which time stops until one comes."""

_FOUND = {"fault-begins", "fault-ends", "alarm", "alarm-over", "diverged", "substeps"}
"""Events that come of computing a row; all others come of commands, which act at the row to be shown next."""


class RoomFull(Exception):
    """There are as many viewers as there may be."""


class Room:
    """One session. `token` gives the right to command."""

    def __init__(
        self, id: str, token: str, session: "Session", services: RoomServices, parent: str | None = None
    ) -> None:
        self.id, self.token, self.parent = id, token, parent
        self.session, self.services = session, services
        self.broadcast = Broadcast(session.columns, session.row, session.record)
        self.playback, self.measured_speed, self.prefetch_plan = (
            PlaybackClock(session.record),
            MeasuredSpeed(),
            PrefetchPlan(),
        )
        self.queue = SerialQueue(services.background)
        self.commands, self.prefetcher = CommandHandler(self), Prefetcher(self)
        self.facts = FactsPublisher(self)
        self.frozen = False  # while a command that takes long is carried out
        self.closed = False
        self.empty_since: float | None = services.clock()
        self._told = services.clock()
        self.checks = BackgroundChecks(self)
        self.finished = session.ended  # the session has no more rows than those that are computed
        session.detects_outside = True
        session.new_events()  # of rows that are shown already: they are in the log

    # ---- how it stands -------------------------------------------------------------------------------------------------

    @property
    def shown(self) -> int:
        return self.broadcast.shown

    @property
    def t(self) -> float:
        """Time of the last row that was shown, s."""
        return max(0, self.shown - 1) * self.session.record

    @property
    def ended(self) -> bool:
        """Whether there is nothing more to come."""
        return self.finished and self.broadcast.left == 0 and not self.broadcast.blocked

    def status(self) -> Status:
        playback = self.playback
        return Status(
            row=self.shown,
            t=self.t,
            playing=playback.playing,
            speed=playback.speed,
            rate=self.measured_speed.value if playback.moving else None,
            viewers=len(self.broadcast.viewers),
            ended=self.ended,
        )

    def send_status(self) -> None:
        self._told = self.services.clock()
        self.broadcast.send(self.status(), "status")

    # ---- viewers -------------------------------------------------------------------------------------------------------

    def join(self, viewer: Viewer, after: int | None = None) -> None:
        """Let a viewer watch; `after` is the last frame that it got before. Raises :class:`RoomFull`."""
        if len(self.broadcast.viewers) >= self.services.viewers:
            raise RoomFull
        now = self.services.clock()
        if self.empty_since is not None and self.playback.moving and now - self.empty_since > ASLEEP:
            self.playback.anchor(self.shown, now)
            self.clock_started()
        viewer.outbox.row = self.broadcast.rows_after(after)
        hello = Hello(
            session=self.id,
            role="control" if viewer.control else "view",
            spec=self.session.spec,
            columns=self.broadcast.columns,
            epoch=self.broadcast.epoch,
            step=self.session.step,
            record=self.session.record,
            row=self.shown,
            playing=self.playback.playing,
            speed=self.playback.speed,
            parent=self.parent,
            log=tuple(event for event in self.session.log if self._seen(event)),
            facts=self.facts.facts(),
        )
        viewer.put(hello.model_dump_json())
        self.broadcast.viewers.append(viewer)
        self.empty_since = None
        self.send_status()
        self.checks.check(0.0)

    def _seen(self, event: Event) -> bool:
        """Whether an event of the log is no longer ahead of what is shown."""
        return event.row < self.shown or (event.row == self.shown and event.kind not in _FOUND)

    def leave(self, viewer: Viewer) -> None:
        """A viewer has gone."""
        if viewer in self.broadcast.viewers:
            self.broadcast.viewers.remove(viewer)
            self.send_status()
        if not self.broadcast.viewers:
            self.empty_since = self.services.clock()

    async def samples(self, viewer: Viewer) -> bytes | None:
        """The next frame of what a viewer has missed; None: it has everything."""
        span = self.broadcast.next_span(viewer, self.services.backlog, self.oldest)
        if span is None or not viewer.outbox.is_idle:
            return None
        data = self.broadcast.encoded(span)
        if data is None:
            epoch, columns = self.broadcast.epoch, self.broadcast.columns
            rows = await self.past_rows(columns, span.first, span.last)
            if self.broadcast.epoch != epoch or not viewer.outbox.is_idle:
                return None  # a rewind came between
            data = self.broadcast.encode(span, rows)
        viewer.outbox.row = span.last
        return data

    def close(self, code: int, reason: str) -> None:
        """End the session and tell all viewers why."""
        self.closed = True
        self.playback.pause()
        self.queue.submit(
            self.session.release, lambda *_: None
        )  # its memory, at once: the room itself waits for Python's collector
        for viewer in list(self.broadcast.viewers):
            viewer.close(code, reason)

    # ---- the past, copies ----------------------------------------------------------------------------------------------

    @property
    def oldest(self) -> int:
        """The first row that the session still has."""
        return self.session.history.start

    async def past_rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Rows first … last − 1 of the past in these columns: float32, columns × rows."""
        return await self.run_exclusive(lambda: self.session.history.rows(columns, first, last))

    async def run_exclusive(self, job: Callable[[], Any], long: bool = False) -> Any:
        """What a job on the session gives, when its turn has come."""
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

        def then(value: Any, error: Exception | None) -> None:
            if answer.cancelled():
                return
            if error is None:
                answer.set_result(value)
            else:
                answer.set_exception(error)

        self.queue.submit(job, then, long)
        return await answer

    async def fork(self, t: float | None) -> "Session":
        """A copy of the session at a time up to now."""
        row = self.shown if t is None else min(self.shown, round(t / self.session.record) + 1)
        return await self.run_exclusive(partial(self.session.fork, row), long=True)

    def spec(self) -> Experiment:
        """The experiment with everything done so far, up to now: its run gives the same numbers."""
        spec, t = self.session.spec, self.t
        commands = tuple(command for command in spec.commands if command.at <= t)
        return spec.model_copy(update={"horizon": t, "record": self.session.record, "commands": commands})

    # ---- time ----------------------------------------------------------------------------------------------------------

    def tick(self, at: float) -> float | None:
        """Show what is due; `at` is when this was to be called. When to call again (None: when something happens)."""
        now = self.services.clock()
        if self.closed or (self.empty_since is not None and now - self.empty_since > ASLEEP):
            return None
        if not self.frozen:
            due = self.playback.due(now)
            if due > self.broadcast.end:
                self.prefetch_rows()
            self.show(due, now)
            if not self.prefetch_plan.enough(self.broadcast.left) and self.prefetcher.wanted() is not None:
                self.services.request_prefetch(self, False)
        if now - self._told >= STATUS:
            self.measured_speed.look(self.shown, now, self.session.record)
            self.send_status()
            self.checks.check(CHECKS)
        return self.playback.next(self.broadcast.shown, at, now)

    def show(self, due: float, now: float) -> None:
        """Show the rows that are due, as far as they are there; the clock waits for the others."""
        broadcast, playback = self.broadcast, self.playback
        broadcast.show(due)
        if due > broadcast.shown and playback.playing:
            playback.anchor(broadcast.shown, now)
        if playback.target is not None:
            playback.reached(broadcast.shown)
            if not playback.moving:
                self.send_status()
                self.checks.check(0.0)
        if self.finished and self.ended and playback.moving:
            playback.pause()
            self.send_status()
        self.facts.publish()

    def prefetch_rows(self) -> None:
        """Compute ahead, if there is need to."""
        self.prefetcher.prefetch_rows()

    def accept_rows(self, computed: RowBatch) -> None:
        """Take over what was computed; it is shown when it is due."""
        self.finished = computed.ended
        if computed.rows.shape[1]:
            self.broadcast.add(computed)
            self.services.request_detection(self)

    def clock_started(self) -> None:
        """Time goes on from now on."""
        now = self.services.clock()
        self.measured_speed.start(self.shown, now)
        self._told = now
        self.services.wake(self, now)
