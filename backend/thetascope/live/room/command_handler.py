"""Commands: play, pause, step and speed act on the clock, all others on the session, at the row that is shown."""

import logging
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from pydantic import ValidationError

from thetascope.engine.errors import SpecError
from thetascope.live.room.prefetch_plan import RowBatch, compute
from thetascope.live.room.room_state import Transition
from thetascope.live.session.edits import without_commands
from thetascope.live.wire import messages
from thetascope.live.wire.viewer import Viewer
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Refusal
from thetascope.runs.workers.limits import Ended
from thetascope_schemas.experiment.signals import ExpressionSignal
from thetascope_schemas.service.session import (
    Ack,
    AddObserverNow,
    Batch,
    Command,
    Event,
    Pause,
    Play,
    Refused,
    RemoveObserverNow,
    Reset,
    Seek,
    SessionCommand,
    SetGainNow,
    SetSignalNow,
    SetTruthNow,
    Spec,
    Speed,
    Step,
)

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts

log = logging.getLogger(__name__)

_LONG = (AddObserverNow, Reset, Seek)
"""Commands that may take longer than other sessions should wait: they are carried out in a thread."""
_REHEARSED = (AddObserverNow, RemoveObserverNow, SetTruthNow)
"""Commands that may bring equations, or other kernels: they are carried out in a worker process first."""


@dataclass(frozen=True)
class CommandResult:
    """The session after a command: its row, columns and end, the command's events, and the first rows that follow."""

    row: int
    columns: tuple[str, ...]
    ended: bool
    events: Sequence[Event]
    refusal: Refused | None
    batch: RowBatch | None


class CommandHandler:
    """Carries out the commands of one room, those on the session one after another. Each gets one answer."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._waiting: deque[tuple[Viewer, SessionCommand]] = deque()
        self._busy = False
        self._rehearsal: tuple[Viewer, Callable[[], None]] | None = None

    def left(self, viewer: Viewer) -> None:
        """End what is computed for a viewer that has left."""
        if self._rehearsal is not None and self._rehearsal[0] is viewer:
            self._rehearsal[1]()

    def receive(self, viewer: Viewer, text: str | None, limit: int) -> None:
        """Handle a message of a viewer; the answer goes into its outbox.

        Args:
            text: the message; None if it was binary.
            limit: characters that a message may have.
        """
        command = messages.read(text, limit)
        if not viewer.control and command.id is not None:
            viewer.send(messages.refusal(command.id, Message("session.view-only")))
        elif isinstance(command, Refused):
            viewer.send(command)
        elif isinstance(command, Play | Pause | Step | Speed):
            self._move_clock(viewer, command)
        else:
            self._waiting.append((viewer, command))
            self._next()

    # ---- the clock ---------------------------------------------------------------------------------------------------

    def _move_clock(self, viewer: Viewer, command: Play | Pause | Step | Speed) -> None:
        room = self._room
        now = room.services.clock()
        needed = {Play: Transition.PLAY, Step: Transition.STEP}.get(type(command))
        if room.machine.closed:
            return
        if needed is not None and not room.machine.allows(needed):
            viewer.send(messages.refusal(command.id, Message("session.ended")))
            return
        self._ack(viewer, command)
        match command:
            case Play():
                room.playback.play(room.shown, now)
            case Pause():
                room.playback.pause()
            case Step(rows=rows):
                room.playback.step(room.shown, rows)
            case Speed(value=value):
                room.playback.set_speed(value, room.shown, now)
        room.prefetch_plan.disturbed()
        if room.machine.moving:
            room.clock_started()
            room.prefetch_rows()
        room.send_status()
        room.facts.publish()

    # ---- the session -------------------------------------------------------------------------------------------------

    def _next(self) -> None:
        if self._busy or not self._waiting or self._room.machine.closed:
            return
        self._busy = True
        viewer, command = self._waiting.popleft()
        if any(_is_rehearsed(member) for member in _members(command)):
            self._rehearse(viewer, command)
        else:
            self._submit(viewer, command)

    def _rehearse(self, viewer: Viewer, command: SessionCommand) -> None:
        """Compile the kernels of a command beside the session, into the cache, where the session finds them.

        A command whose equations take too much time or memory is refused, and one whose viewer leaves is dropped.
        """
        session = self._room.session

        def then(_: object, error: Exception | None) -> None:
            self._rehearsal = None
            if not isinstance(error, Refusal | Ended):
                self._submit(viewer, command)
                return
            self._busy = False
            if isinstance(error, Refusal):
                viewer.send(messages.refusal(command.id, error.problem))
            self._next()

        here = without_commands(session.spec, session.t)
        self._rehearsal = viewer, self._room.services.rehearse(here, command, viewer.client, then)

    def _submit(self, viewer: Viewer, command: SessionCommand) -> None:
        room = self._room
        if room.machine.closed:
            return
        room.prefetch_plan.disturbed()
        long = any(isinstance(member, _LONG) for member in _members(command))
        if long:
            room.machine.fire(Transition.HOLD)

        def then(result: CommandResult | None, error: Exception | None) -> None:
            self._done(viewer, command, result, error)

        room.queue.submit(lambda: self._carry_out(command), then, long, urgent=True)

    def _carry_out(self, command: SessionCommand) -> CommandResult:
        """Carry out a command on the session, alone. If it fails, the session has its earlier state again."""
        session = self._room.session
        session.drop_unseen_rows(self._room.shown)
        before = session.state
        try:
            return self._result(session.handle(command)[0])
        except SpecError as error:
            refusal = messages.refused(command.id, error)
        except ValidationError as error:
            refusal = messages.refused_spec(command.id, error)
        except Exception:
            log.exception("session %s: %s failed", self._room.id, command.type)
            refusal = messages.refusal(command.id, Message("session.internal-error"))
        session.state = before
        return replace(self._result([]), refusal=refusal)

    def _result(self, events: Sequence[Event]) -> CommandResult:
        """Return the session as it is, and the rows that are shown with the answer."""
        room, session = self._room, self._room.session
        row, columns, ended = session.row, session.columns, session.ended
        rows = room.prefetch_plan.soon(room.playback) if room.machine.moving else 0
        if row < room.shown or row == 0:
            rows = max(rows, 1)  # the row at the time that the session went back to
        batch = compute(session, rows, room.services.past()) if rows else None
        return CommandResult(row, columns, ended, events, None, batch)

    def _done(
        self, viewer: Viewer, command: SessionCommand, result: CommandResult | None, error: Exception | None
    ) -> None:
        room, self._busy = self._room, False
        if room.machine.closed:
            return
        if result is None:
            log.error("session %s: %s failed", room.id, command.type, exc_info=error)
            session = room.session
            room.broadcast.restart(session.columns, session.row, session.ended)  # the rows computed ahead are void
            room.update_end()
            viewer.send(messages.refusal(command.id, Message("session.internal-error")))
        else:
            self._show(viewer, command, result)
        if room.machine.held:
            room.machine.fire(Transition.RELEASE)
        room.facts.changed(urgent=not isinstance(command, SetGainNow))  # a slider that is dragged sends many of these
        room.prefetch_rows()
        self._next()

    def _show(self, viewer: Viewer, command: SessionCommand, result: CommandResult) -> None:
        """Answer a command, and send its events and the first rows after it."""
        room, broadcast = self._room, self._room.broadcast
        back = result.row < broadcast.shown
        if result.refusal is not None:
            viewer.send(result.refusal)
        else:
            self._ack(viewer, command, result.row)
        broadcast.restart(result.columns, result.row, result.ended)
        for event in result.events:
            broadcast.send(event)
        if result.batch is not None:
            room.accept_rows(result.batch)
        room.update_end()
        now = room.services.clock()
        if back or room.machine.held:
            room.playback.anchor(room.shown, now)
        if back or room.machine.moving or room.shown == 0:
            # The first row that shows the command is sent with the answer, at most one row before its time.
            due = room.playback.due(now)
            room.show(max(due, 0 if room.shown > due and room.machine.moving else room.shown + 1), now)
        if result.refusal is None:  # after the frame: it is long, and nobody waits for it
            broadcast.send(Spec(spec=room.session.spec), "spec")
        if back:
            room.send_status()

    def _ack(self, viewer: Viewer, command: Command, row: int | None = None) -> None:
        row = self._room.shown if row is None else row
        viewer.send(Ack(id=command.id, row=row, t=row * self._room.session.record))


def _members(command: SessionCommand) -> Sequence[SessionCommand]:
    """Return the commands of a batch, or the one command."""
    return command.commands if isinstance(command, Batch) else (command,)


def _is_rehearsed(command: SessionCommand) -> bool:
    """Return whether a command is carried out in a worker process first; of signals, those with a text."""
    if isinstance(command, SetSignalNow):
        return isinstance(command.signal, ExpressionSignal)
    return isinstance(command, _REHEARSED)
