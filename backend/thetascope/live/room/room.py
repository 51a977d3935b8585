"""A session with its viewers: time runs, rows become frames, viewers come and go.

Everything here runs on the event loop, except the jobs on the session, which run one at a time (serial_queue.py).
Nothing here waits for a viewer. Commands are in command_handler.py, the states of a room in room_state.py.
"""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thetascope.diagnosis.yield_points import Steps
from thetascope.live.facts.facts_publisher import FactsPublisher
from thetascope.live.room.background_checks import BackgroundChecks
from thetascope.live.room.broadcast import Broadcast, Tap
from thetascope.live.room.command_handler import CommandHandler
from thetascope.live.room.playback_clock import MeasuredSpeed, PlaybackClock
from thetascope.live.room.prefetch import Prefetcher
from thetascope.live.room.prefetch_plan import PrefetchPlan, RowBatch
from thetascope.live.room.room_parts import RoomServices
from thetascope.live.room.room_state import RoomMachine, Transition
from thetascope.live.room.serial_queue import Callback, SerialQueue
from thetascope.live.wire.viewer import Viewer
from thetascope.messages import Message
from thetascope_schemas import Experiment
from thetascope_schemas.service.session import Event, Hello, Status

if TYPE_CHECKING:
    from thetascope.live.session.session import Session

STATUS_INTERVAL = 1.0
"""Seconds between two status messages while time runs."""
CHECK_INTERVAL = 3.0
"""Seconds between two checks of the assumptions, at least."""
ASLEEP_AFTER = 60.0
"""Seconds without a viewer after which time stops until one connects."""

_OF_ROWS = {"fault-begins", "fault-ends", "alarm", "alarm-over", "diverged", "substeps"}
"""Kinds of events that come from computing a row; all others come from commands,
which act at the row to be shown next."""


class RoomFull(Exception):
    """The room has as many viewers as it may have."""


class Room:
    """One session with its viewers.

    Args:
        id: the session's id.
        token: grants control.
        session: the session.
        services: the parts of the service that the room uses.
        parent: id of the session that this one was forked from.
    """

    def __init__(
        self, id: str, token: str, session: "Session", services: RoomServices, parent: str | None = None
    ) -> None:
        self.id, self.token, self.parent = id, token, parent
        self.session, self.services = session, services
        self.machine = RoomMachine()
        self.broadcast = Broadcast(session.columns, session.row, session.record, session.ended)
        self.playback = PlaybackClock(session.record, self.machine)
        self.measured_speed, self.prefetch_plan = MeasuredSpeed(), PrefetchPlan()
        self.queue = SerialQueue(services.background)
        self.commands, self.prefetcher = CommandHandler(self), Prefetcher(self)
        self.facts = FactsPublisher(self)
        self.empty_since: float | None = services.clock()
        self._status_sent = services.clock()
        self.checks = BackgroundChecks(self)
        session.new_events()  # of rows that count as shown: they are in the log
        self.update_end()

    # ---- status ------------------------------------------------------------------------------------------------------

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of its frames."""
        return self.broadcast.columns

    @property
    def epoch(self) -> int:
        """Grows when columns or past rows change."""
        return self.broadcast.epoch

    @property
    def record(self) -> float:
        """Time between rows, s."""
        return self.session.record

    @property
    def shown(self) -> int:
        """Rows shown so far."""
        return self.broadcast.shown

    @property
    def t(self) -> float:
        """Time of the last row that was shown, s."""
        return max(0, self.shown - 1) * self.session.record

    def status(self) -> Status:
        """Return the status as it is sent to viewers."""
        return Status(
            row=self.shown,
            t=self.t,
            playing=self.machine.playing,
            speed=self.playback.speed,
            rate=self.measured_speed.value if self.machine.moving else None,
            viewers=len(self.broadcast.viewers),
            ended=self.machine.ended,
        )

    def send_status(self) -> None:
        """Send the status to all viewers."""
        self._status_sent = self.services.clock()
        self.broadcast.send(self.status(), "status")

    # ---- viewers -----------------------------------------------------------------------------------------------------

    def join(self, viewer: Viewer, after: int | None = None) -> None:
        """Add a viewer.

        Args:
            after: number of the last frame that it received before.

        Raises:
            RoomFull: there are as many viewers as there may be.
        """
        if len(self.broadcast.viewers) >= self.services.viewers:
            raise RoomFull
        self._wake()
        viewer.outbox.row = self.broadcast.rows_after(after)
        viewer.send(self._hello(viewer))
        self.broadcast.viewers.append(viewer)
        self.empty_since = None
        self.send_status()
        self.checks.check(0.0)
        if self.session.pending_detection() is not None:  # the last rows before an opening in the middle, paused
            self.request_detection()

    def attach(self, tap: Tap) -> None:
        """Add a tap: time runs for it as for a viewer, but it is sent rows only."""
        self._wake()
        self.broadcast.taps.append(tap)
        self.empty_since = None
        if self.session.pending_detection() is not None:
            self.request_detection()

    def detach(self, tap: Tap) -> None:
        """Remove a tap."""
        if tap in self.broadcast.taps:
            self.broadcast.taps.remove(tap)
        self._note_empty()

    def _wake(self) -> None:
        if self.machine.asleep:
            self.playback.anchor(self.shown, self.services.clock())
            self.machine.fire(Transition.WAKE)
            self.clock_started()

    def _note_empty(self) -> None:
        if not self.broadcast.viewers and not self.broadcast.taps:
            self.empty_since = self.services.clock()

    def _hello(self, viewer: Viewer) -> Hello:
        return Hello(
            session=self.id,
            role="control" if viewer.control else "view",
            spec=self.session.spec,
            columns=self.broadcast.columns,
            epoch=self.broadcast.epoch,
            step=self.session.step,
            record=self.session.record,
            row=self.shown,
            playing=self.machine.playing,
            speed=self.playback.speed,
            parent=self.parent,
            log=tuple(event for event in self.session.log if self._is_shown(event)),
            facts=self.facts.facts(),
        )

    def _is_shown(self, event: Event) -> bool:
        """Return whether the row of an event has been shown."""
        return event.row < self.shown or (event.row == self.shown and event.kind not in _OF_ROWS)

    def leave(self, viewer: Viewer) -> None:
        """Remove a viewer."""
        if viewer in self.broadcast.viewers:
            self.broadcast.viewers.remove(viewer)
            self.commands.left(viewer)
            self.send_status()
        self._note_empty()

    async def samples(self, viewer: Viewer) -> bytes | None:
        """Return the next frame of the rows that a viewer has missed; None if it has all."""
        span = self.broadcast.next_span(viewer, self.services.backlog, self.oldest)
        if span is None or not viewer.outbox.is_idle:
            return None
        data = self.broadcast.encoded(span)
        if data is None:
            epoch, columns = self.broadcast.epoch, self.broadcast.columns
            rows = await self.past_rows(columns, span.first, span.last)
            if self.broadcast.epoch != epoch or not viewer.outbox.is_idle:
                return None  # a rewind came in between
            data = self.broadcast.encode(span, rows)
        viewer.outbox.row = span.last
        return data

    def close(self, code: int, reason: Message) -> None:
        """End the session and close all connections with a code and a reason."""
        self.machine.fire(Transition.CLOSE)
        self.queue.submit(self.session.release, lambda *_: None)  # its memory; the room waits for the garbage collector
        for viewer in list(self.broadcast.viewers):
            viewer.close(code, reason)
        for tap in list(self.broadcast.taps):
            tap.closed()

    # ---- the past, copies --------------------------------------------------------------------------------------------

    @property
    def oldest(self) -> int:
        """The first row that the session still has."""
        return self.session.history.start

    async def past_rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Return rows first … last − 1 in these columns: float32, columns × rows."""
        return await self.run_exclusive(lambda: self.session.history.rows(columns, first, last))

    async def run_exclusive(self, job: Callable[[], Any], long: bool = False) -> Any:
        """Return the value of a job on the session, run when its turn comes; a long one runs in a thread."""
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
        """Return a copy of the session at a time in s, at most the present one, which is the default."""
        row = self.shown if t is None else min(self.shown, round(t / self.session.record) + 1)
        return await self.run_exclusive(partial(self.session.fork, row), long=True)

    def spec(self) -> Experiment:
        """Return the experiment with everything done so far, up to now: its run gives the same numbers."""
        spec, t = self.session.spec, self.t
        commands = tuple(command for command in spec.commands if command.at <= t)
        notes = tuple(note for note in spec.notes if note.t <= t + 0.5 * self.session.record)
        end = {"horizon": t, "record": self.session.record}
        return spec.model_copy(update=end | {"commands": commands, "notes": notes})

    # ---- time --------------------------------------------------------------------------------------------------------

    def tick(self, at: float) -> float | None:
        """Show the rows that are due.

        Args:
            at: the time at which this was to be called, s.

        Returns:
            when to call again; None: when :meth:`clock_started` asks for it.
        """
        now = self.services.clock()
        if self.machine.closed:
            return None
        if self.empty_since is not None and now - self.empty_since > ASLEEP_AFTER:
            if self.machine.allows(Transition.SLEEP):
                self.machine.fire(Transition.SLEEP)
            if self.machine.asleep:
                return None
        if not self.machine.held:
            due = self.playback.due(now)
            if due > self.broadcast.end:
                self.prefetch_rows()
            self.show(due, now)
            if not self.prefetch_plan.enough(self.broadcast.left) and self.prefetcher.wanted() is not None:
                self.request_prefetch(False)
        if now - self._status_sent >= STATUS_INTERVAL:
            self.measured_speed.update(self.shown, now, self.session.record)
            self.send_status()
            self.checks.check(CHECK_INTERVAL)
        return self.playback.next(self.shown, at, now)

    def show(self, due: float, now: float) -> None:
        """Show rows up to `due` − 1, as far as they are computed; the clock waits for the others."""
        self.broadcast.show(due)
        if due > self.shown and self.machine.playing:
            self.playback.anchor(self.shown, now)
        moving = self.machine.moving
        reached = self.playback.reached(self.shown)
        self.update_end()
        if moving and not self.machine.moving:
            self.send_status()
        if reached:
            self.checks.check(0.0)
        self.facts.publish()

    def update_end(self) -> None:
        """Tell the state machine whether rows can follow those that are shown."""
        if self.broadcast.at_end != self.machine.ended and not self.machine.closed:
            self.machine.fire(Transition.END if self.broadcast.at_end else Transition.CONTINUE)
            self.facts.publish()

    def prefetch_rows(self) -> None:
        """Compute rows ahead if that is needed."""
        self.prefetcher.prefetch_rows()

    def accept_rows(self, batch: RowBatch) -> None:
        """Add computed rows; they are shown when they are due."""
        self.broadcast.add(batch)
        self.update_end()
        if batch.rows.shape[1]:
            self.request_detection()

    def clock_started(self) -> None:
        """Schedule frames: time runs from now on."""
        now = self.services.clock()
        self.measured_speed.start(self.shown, now)
        self._status_sent = now
        self.services.wake(self, now)

    def request_prefetch(self, first: bool) -> None:
        """Ask for :meth:`prefetch_rows` when there is time, before all other rooms (`first`) or after them."""
        self.services.request_prefetch(self, first)

    def detection_job(self) -> tuple[Steps[Any], Callback] | None:
        """Return the steps that test waiting rows for faults, and their callback; None if no rows wait."""
        return self.checks.detection_job()

    @property
    def waits_for_diagnosis(self) -> bool:
        """Whether no rows may be computed ahead before more of them are tested for faults."""
        return self.checks.too_far_behind()

    def request_detection(self) -> None:
        """Ask for waiting rows to be tested for faults when there is time."""
        self.services.request_detection(self)
