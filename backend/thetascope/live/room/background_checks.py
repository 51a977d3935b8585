"""What is found out about a session beside its rows: faults, in slices of free time, and whether assumptions hold, on a copy."""

import logging
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from thetascope.live.room.advice import diagnosis
from thetascope.live.room.serial_queue import Job, Then
from thetascope.live.session import log_events
from thetascope.live.session.live_detector import Seen
from thetascope_schemas.service.session import Assumptions, DiagnosisNow, Event

if TYPE_CHECKING:
    from thetascope.diagnosis.monitor.monitor import MonitorState
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.session import Session

log = logging.getLogger(__name__)


class Inspection:
    """Of one room. Everything is called on the event loop."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._checked, self._checking = room.house.clock(), False
        room.session.leaves_watching = True

    # ---- faults --------------------------------------------------------------------------------------------------------

    def watching(self) -> tuple[Job, Then] | None:
        """Rows that are still to be watched, as a job; it does not touch the session. None: there are none."""
        seen = None if self._room.closed else unwatched(self._room.session)
        if seen is None:
            return None
        return partial(self._room.session.watch.caught_up, seen), partial(self._watched, seen)

    def _watched(self, seen: Seen, after: "MonitorState | None", error: Exception | None) -> None:
        room = self._room
        if room.closed:
            return
        if error is not None:
            log.error("what session %s shows cannot be watched", room.id, exc_info=error)
            return
        room.turns.do(partial(take_watched, room.session, seen, after), self._tell_found)

    def _tell_found(self, found: list[Event] | None, error: Exception | None) -> None:
        if error is not None:
            log.error("session %s: what was found is lost", self._room.id, exc_info=error)
        if found:
            self._room.screen.found(found)
            self.check(0.0)
        if not self._room.closed and unwatched(self._room.session) is not None:
            self._room.house.watch(self._room)

    # ---- assumptions ---------------------------------------------------------------------------------------------------

    def check(self, spacing: float) -> None:
        """Let the assumptions be checked, if somebody is there to see it and it was not done for so many seconds."""
        room, now = self._room, self._room.house.clock()
        if not room.screen.viewers or self._checking or room.shown < 2 or now - self._checked < spacing:
            return
        if room.house.may_check() or not room.pace.moving:
            self._checking = True
            room.turns.do(room.session.fork, self._check_copy)

    def _check_copy(self, copy: "Session | None", error: Exception | None) -> None:
        if copy is None:
            self._tell_checks(None, error)
        else:
            self._room.house.workshop(lambda: [*copy.assumptions(), diagnosis(copy)], self._tell_checks)

    def _tell_checks(self, found: list[Assumptions | DiagnosisNow] | None, error: Exception | None) -> None:
        self._checked, self._checking = self._room.house.clock(), False
        if error is not None:
            log.error("the assumptions of session %s cannot be checked", self._room.id, exc_info=error)
        for one in found or []:
            self._room.screen.tell(one, one.type if isinstance(one, DiagnosisNow) else f"assumptions {one.observer}")


def unwatched(session: "Session") -> Seen | None:
    """What is to be watched of a session that leaves it to others: None if no rows wait."""
    seen = session.now.watched
    return seen if seen is not None and seen.waiting else None


def take_watched(session: "Session", seen: Seen, after: "MonitorState") -> list[Event]:
    """Tell a session what was found in rows that waited, unless it has gone back meanwhile; what is new in it."""
    if session.now.watched is None or not session.now.watched.follows(seen):
        return []
    found = log_events.new(session.watch.events(seen, after), session.log)
    session.log += found
    left = Seen(after, session.now.watched.waiting[len(seen.waiting) :])
    session.now = replace(session.now, watched=left, told=len(session.log))
    return found
