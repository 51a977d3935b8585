"""Commands: play, pause, step and speed act on the clock; all others on the session, at the row that is shown."""

import logging
from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from thetascope.engine.errors import SpecError
from thetascope.live.room.prefetch_plan import RowBatch, compute
from thetascope.live.wire import messages
from thetascope.live.wire.viewer import Viewer
from thetascope_schemas.service.session import (
    Ack,
    AddObserverNow,
    Batch,
    Command,
    Event,
    Pause,
    Play,
    Refused,
    Reset,
    Seek,
    SetGainNow,
    Spec,
    Speed,
    Step,
)

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts

log = logging.getLogger(__name__)

_INSIDE = "an error inside the program; its log tells more"

_LONG = (AddObserverNow, Reset, Seek)
"""Commands that may take longer than other sessions should wait: they are carried out in a thread."""


def _members(command: Command) -> tuple[Command, ...]:
    """Return the commands of a batch, or the one command."""
    return command.commands if isinstance(command, Batch) else (command,)


@dataclass(frozen=True)
class CommandResult:
    """What carrying out a command gave: where the session stands, what happened, and the first rows after it."""

    row: int
    columns: tuple[str, ...]
    ended: bool
    events: list[Event]
    refusal: Refused | None
    computed: RowBatch | None


class CommandHandler:
    """Carries out the commands of one room, those on the session one after the other. Each gets one answer."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._waiting: deque[tuple[Viewer, Command]] = deque()
        self._busy = False

    def receive(self, viewer: Viewer, text: str | None, limit: int) -> None:
        """Take a message of a viewer; the answer goes into its outbox. None stands for a binary message."""
        command = messages.read(text, limit)
        if isinstance(command, Refused) and (viewer.control or command.id is None):
            viewer.put(command.model_dump_json())
        elif not viewer.control:
            self._refuse(viewer, command, "this link only watches", "fork the session to have one of your own")
        elif isinstance(command, Play | Pause | Step | Speed):
            self._transport(viewer, command)
        else:
            self._waiting.append((viewer, command))
            self._next()

    # ---- the clock -----------------------------------------------------------------------------------------------------

    def _transport(self, viewer: Viewer, command: Command) -> None:
        room = self._room
        now = room.services.clock()
        if isinstance(command, Play | Step) and room.ended:
            self._refuse(viewer, command, "the session has come to its end", "go back to an earlier time, or reset it")
            return
        self._ack(viewer, command)
        match command:
            case Play():
                room.playback.play(room.shown, now)
            case Pause():
                room.playback.pause()
            case Step(rows=rows):
                room.playback.step((room.playback.target or room.shown) + rows)
            case Speed(value=value):
                room.playback.set_speed(value, room.shown, now)
        room.prefetch_plan.disturbed()
        if room.playback.moving:
            room.clock_started()
            room.prefetch_rows()
        room.send_status()
        room.facts.publish()

    # ---- the session ---------------------------------------------------------------------------------------------------

    def _next(self) -> None:
        if self._busy or not self._waiting or self._room.closed:
            return
        self._busy = True
        viewer, command = self._waiting.popleft()
        added = [member for member in _members(command) if isinstance(member, AddObserverNow)]
        if added:
            # Compiling is not to stop the session: it is done apart, into the cache, where the session then finds it.
            spec = self._room.session.spec
            self._room.services.workshop(lambda: _compile(spec, added), lambda *_: self._carry_out(viewer, command))
        else:
            self._carry_out(viewer, command)

    def _carry_out(self, viewer: Viewer, command: Command) -> None:
        room = self._room
        room.prefetch_plan.disturbed()
        long = any(isinstance(member, _LONG) for member in _members(command))
        room.frozen = room.frozen or long
        room.queue.submit(
            lambda: self._job(command), lambda done, error: self._done(viewer, command, done, error), long, urgent=True
        )

    def _job(self, command: Command) -> CommandResult:
        """On the session, alone."""
        session = self._room.session
        session.drop_unseen_rows(self._room.shown)
        try:
            with session.transaction():
                return self._carried_out(command)
        except SpecError as error:
            refusal = messages.refused(command.id, error)
        except ValidationError as error:
            refusal = messages.refused_spec(command.id, error)
        except Exception:
            log.exception("session %s: %s failed", self._room.id, command.type)
            refusal = Refused(id=command.id, problem=_INSIDE, remedy="report it")
        return replace(self._carried_out(None), refusal=refusal)

    def _carried_out(self, command: Command | None) -> CommandResult:
        """The command done, and the rows that are shown with its answer."""
        room, session = self._room, self._room.session
        events = session.handle(command)[0] if command is not None else []
        row, columns, ended = session.row, session.columns, session.ended
        rows = room.prefetch_plan.soon(room.playback) if room.playback.moving else 0
        if row < room.shown or row == 0:
            rows = max(rows, 1)  # the row at the time that one went back to
        computed = compute(session, rows, room.services.past()) if rows else None
        return CommandResult(row, columns, ended, events, None, computed)

    def _done(self, viewer: Viewer, command: Command, done: CommandResult | None, error: Exception | None) -> None:
        room = self._room
        if done is None:
            log.error("session %s: %s failed", room.id, command.type, exc_info=error)
            room.broadcast.restart(room.session.columns, room.session.row)  # what was computed ahead is given up
            self._refuse(viewer, command, _INSIDE, "report it")
        else:
            self._take_over(viewer, command, done)
        room.frozen = False
        room.facts.changed(urgent=not isinstance(command, SetGainNow))  # a slider that is dragged sends many of these
        self._busy = False
        room.prefetch_rows()
        self._next()

    def _take_over(self, viewer: Viewer, command: Command, done: CommandResult) -> None:
        room, broadcast = self._room, self._room.broadcast
        back = done.row < broadcast.shown
        if done.refusal is not None:
            viewer.put(done.refusal.model_dump_json())
        else:
            self._ack(viewer, command, done.row)
        broadcast.restart(done.columns, done.row)
        room.finished = done.ended
        for event in done.events:
            broadcast.send(event)
        if done.computed is not None:
            room.accept_rows(done.computed)
        now = room.services.clock()
        if back or room.frozen:
            room.playback.anchor(room.shown, now)
        if back or room.playback.moving or room.shown == 0:
            # The first row that shows the command goes out with the answer, at most one row before its time.
            due = room.playback.due(now)
            room.show(max(due, 0 if room.shown > due and room.playback.moving else room.shown + 1), now)
        if done.refusal is None:  # after the frame: it is long, and nobody waits for it
            broadcast.send(Spec(spec=room.session.spec), "spec")
        if back:
            room.send_status()

    # ---- answers -------------------------------------------------------------------------------------------------------

    def _ack(self, viewer: Viewer, command: Command, row: int | None = None) -> None:
        row = self._room.shown if row is None else row
        viewer.put(Ack(id=command.id, row=row, t=row * self._room.session.record).model_dump_json())

    def _refuse(self, viewer: Viewer, command: Any, problem: str, remedy: str) -> None:
        viewer.put(Refused(id=command.id, problem=problem, remedy=remedy).model_dump_json())


def _compile(spec: Any, commands: list[AddObserverNow]) -> None:
    """Compile the kernels of observers into the cache. Errors are reported when the command is carried out."""
    from thetascope.assembly import prepare

    added = {command.observer.label: command.observer for command in commands}
    observers = (*(o for o in spec.observers if o.label not in added), *added.values())
    prepare(spec.model_copy(update={"observers": observers, "commands": ()})).run(None, lambda: True)
