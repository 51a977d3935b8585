"""A session with its viewers: time goes on, rows become frames, and viewers come and go.

Everything here runs on the event loop, except the jobs on the session, which take turns (serial_queue.py). Nothing here waits
for a viewer. Commands are in command_handler.py.
"""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thetascope.live.room.background_checks import Inspection
from thetascope.live.room.broadcast import Screen
from thetascope.live.room.command_handler import Control
from thetascope.live.room.playback_clock import Pace, Rate
from thetascope.live.room.prefetch import Computing
from thetascope.live.room.prefetch_plan import Computed, Lookahead
from thetascope.live.room.room_parts import House
from thetascope.live.room.serial_queue import Turns
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


class Full(Exception):
    """There are as many viewers as there may be."""


class Room:
    """One session. `token` gives the right to command."""

    def __init__(self, id: str, token: str, session: "Session", house: House, parent: str | None = None) -> None:
        self.id, self.token, self.parent = id, token, parent
        self.session, self.house = session, house
        self.screen = Screen(session.columns, session.row, session.record)
        self.pace, self.rate, self.lookahead = Pace(session.record), Rate(), Lookahead()
        self.turns = Turns(house.background)
        self.control, self.computing = Control(self), Computing(self)
        self.frozen = False  # while a command that takes long is carried out
        self.closed = False
        self.empty_since: float | None = house.clock()
        self._told = house.clock()
        self.inspection = Inspection(self)
        self.finished = session.ended  # the session has no more rows than those that are computed
        session.leaves_watching = True
        session.take_events()  # of rows that are shown already: they are in the log

    # ---- how it stands -------------------------------------------------------------------------------------------------

    @property
    def shown(self) -> int:
        return self.screen.shown

    @property
    def t(self) -> float:
        """Time of the last row that was shown, s."""
        return max(0, self.shown - 1) * self.session.record

    @property
    def ended(self) -> bool:
        """Whether there is nothing more to come."""
        return self.finished and self.screen.left == 0 and not self.screen.blocked

    def status(self) -> Status:
        pace = self.pace
        return Status(
            row=self.shown,
            t=self.t,
            playing=pace.playing,
            speed=pace.speed,
            rate=self.rate.value if pace.moving else None,
            viewers=len(self.screen.viewers),
            ended=self.ended,
        )

    def tell_status(self) -> None:
        self._told = self.house.clock()
        self.screen.tell(self.status(), "status")

    # ---- viewers -------------------------------------------------------------------------------------------------------

    def join(self, viewer: Viewer, after: int | None = None) -> None:
        """Let a viewer watch; `after` is the last frame that it got before. Raises :class:`Full`."""
        if len(self.screen.viewers) >= self.house.viewers:
            raise Full
        now = self.house.clock()
        if self.empty_since is not None and self.pace.moving and now - self.empty_since > ASLEEP:
            self.pace.anchor(self.shown, now)
            self.moving()
        viewer.outbox.row = self.screen.rows_after(after)
        hello = Hello(
            session=self.id,
            role="control" if viewer.control else "view",
            spec=self.session.spec,
            columns=self.screen.columns,
            epoch=self.screen.epoch,
            step=self.session.step,
            record=self.session.record,
            row=self.shown,
            playing=self.pace.playing,
            speed=self.pace.speed,
            parent=self.parent,
            log=tuple(event for event in self.session.log if self._seen(event)),
        )
        viewer.put(hello.model_dump_json())
        self.screen.viewers.append(viewer)
        self.empty_since = None
        self.tell_status()
        self.inspection.check(0.0)

    def _seen(self, event: Event) -> bool:
        """Whether an event of the log is no longer ahead of what is shown."""
        return event.row < self.shown or (event.row == self.shown and event.kind not in _FOUND)

    def leave(self, viewer: Viewer) -> None:
        """A viewer has gone."""
        if viewer in self.screen.viewers:
            self.screen.viewers.remove(viewer)
            self.tell_status()
        if not self.screen.viewers:
            self.empty_since = self.house.clock()

    async def samples(self, viewer: Viewer) -> bytes | None:
        """The next frame of what a viewer has missed; None: it has everything."""
        span = self.screen.next_span(viewer, self.house.backlog, self.oldest)
        if span is None or not viewer.outbox.quiet:
            return None
        data = self.screen.encoded(span)
        if data is None:
            epoch, columns = self.screen.epoch, self.screen.columns
            rows = await self.past(columns, span.first, span.last)
            if self.screen.epoch != epoch or not viewer.outbox.quiet:
                return None  # a rewind came between
            data = self.screen.encode(span, rows)
        viewer.outbox.row = span.last
        return data

    def close(self, code: int, reason: str) -> None:
        """End the session and tell all viewers why."""
        self.closed = True
        self.pace.pause()
        self.turns.do(
            self.session.release, lambda *_: None
        )  # its memory, at once: the room itself waits for Python's collector
        for viewer in list(self.screen.viewers):
            viewer.close(code, reason)

    # ---- the past, copies ----------------------------------------------------------------------------------------------

    @property
    def oldest(self) -> int:
        """The first row that the session still has."""
        return self.session.past.start

    async def past(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Rows first … last − 1 of the past in these columns: float32, columns × rows."""
        return await self.alone(lambda: self.session.past.rows(columns, first, last))

    async def alone(self, job: Callable[[], Any], long: bool = False) -> Any:
        """What a job on the session gives, when its turn has come."""
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

        def then(value: Any, error: Exception | None) -> None:
            if answer.cancelled():
                return
            if error is None:
                answer.set_result(value)
            else:
                answer.set_exception(error)

        self.turns.do(job, then, long)
        return await answer

    async def fork(self, t: float | None) -> "Session":
        """A copy of the session at a time up to now."""
        row = self.shown if t is None else min(self.shown, round(t / self.session.record) + 1)
        return await self.alone(partial(self.session.fork, row), long=True)

    def spec(self) -> Experiment:
        """The experiment with everything done so far, up to now: its run gives the same numbers."""
        spec, t = self.session.spec, self.t
        commands = tuple(command for command in spec.commands if command.at <= t)
        return spec.model_copy(update={"horizon": t, "record": self.session.record, "commands": commands})

    # ---- time ----------------------------------------------------------------------------------------------------------

    def tick(self, at: float) -> float | None:
        """Show what is due; `at` is when this was to be called. When to call again (None: when something happens)."""
        now = self.house.clock()
        if self.closed or (self.empty_since is not None and now - self.empty_since > ASLEEP):
            return None
        if not self.frozen:
            due = self.pace.due(now)
            if due > self.screen.end:
                self.fill()
            self.show(due, now)
            if not self.lookahead.enough(self.screen.left) and self.computing.wanted() is not None:
                self.house.feed(self, False)
        if now - self._told >= STATUS:
            self.rate.look(self.shown, now, self.session.record)
            self.tell_status()
            self.inspection.check(CHECKS)
        return self.pace.next(self.screen.shown, at, now)

    def show(self, due: float, now: float) -> None:
        """Show the rows that are due, as far as they are there; the clock waits for the others."""
        screen, pace = self.screen, self.pace
        screen.show(due)
        if due > screen.shown and pace.playing:
            pace.anchor(screen.shown, now)
        if pace.target is not None:
            pace.reached(screen.shown)
            if not pace.moving:
                self.tell_status()
                self.inspection.check(0.0)
        if self.finished and self.ended and pace.moving:
            pace.pause()
            self.tell_status()

    def fill(self) -> None:
        """Compute ahead, if there is need to."""
        self.computing.fill()

    def take(self, computed: Computed) -> None:
        """Take over what was computed; it is shown when it is due."""
        self.finished = computed.ended
        if computed.rows.shape[1]:
            self.screen.add(computed)
            self.house.watch(self)

    def moving(self) -> None:
        """Time goes on from now on."""
        now = self.house.clock()
        self.rate.start(self.shown, now)
        self._told = now
        self.house.wake(self, now)
