"""What is found out about a session beside its rows: faults, in slices of free time, and whether assumptions hold, on a copy."""

import logging
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from thetascope.live.room.advice import diagnosis_of
from thetascope.live.room.serial_queue import Callback, Job
from thetascope.live.session import log_events
from thetascope.live.session.live_detector import DetectorProgress
from thetascope_schemas.service.session import Assumptions, DiagnosisNow, Event

if TYPE_CHECKING:
    from thetascope.diagnosis.monitor.monitor import MonitorState
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.session import Session

log = logging.getLogger(__name__)


class BackgroundChecks:
    """Of one room. Everything is called on the event loop."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._checked, self._checking = room.services.clock(), False
        room.session.detects_outside = True

    # ---- faults --------------------------------------------------------------------------------------------------------

    def detection_job(self) -> tuple[Job, Callback] | None:
        """Rows that are still to be watched, as a job; it does not touch the session. None: there are none."""
        seen = None if self._room.closed else pending_detection(self._room.session)
        if seen is None:
            return None
        return partial(self._room.session.detector.catch_up, seen), partial(self._watched, seen)

    def _watched(self, seen: DetectorProgress, after: "MonitorState | None", error: Exception | None) -> None:
        room = self._room
        if room.closed:
            return
        if error is not None:
            log.error("what session %s shows cannot be watched", room.id, exc_info=error)
            return
        room.queue.submit(partial(record_detection, room.session, seen, after), self._tell_found)

    def _tell_found(self, found: list[Event] | None, error: Exception | None) -> None:
        if error is not None:
            log.error("session %s: what was found is lost", self._room.id, exc_info=error)
        if found:
            self._room.broadcast.publish_findings(found)
            self._room.facts.changed()
            self.check(0.0)
        if not self._room.closed and pending_detection(self._room.session) is not None:
            self._room.services.request_detection(self._room)

    # ---- assumptions ---------------------------------------------------------------------------------------------------

    def check(self, spacing: float) -> None:
        """Let the assumptions be checked, if somebody is there to see it and it was not done for so many seconds."""
        room, now = self._room, self._room.services.clock()
        if not room.broadcast.viewers or self._checking or room.shown < 2 or now - self._checked < spacing:
            return
        if room.services.may_check() or not room.playback.moving:
            self._checking = True
            room.queue.submit(room.session.fork, self._check_copy)

    def _check_copy(self, copy: "Session | None", error: Exception | None) -> None:
        if copy is None:
            self._tell_checks(None, error)
        else:
            self._room.services.workshop(lambda: [*copy.assumptions(), diagnosis_of(copy)], self._tell_checks)

    def _tell_checks(self, found: list[Assumptions | DiagnosisNow] | None, error: Exception | None) -> None:
        self._checked, self._checking = self._room.services.clock(), False
        if error is not None:
            log.error("the assumptions of session %s cannot be checked", self._room.id, exc_info=error)
        for one in found or []:
            self._room.broadcast.send(one, one.type if isinstance(one, DiagnosisNow) else f"assumptions {one.observer}")
            if isinstance(one, DiagnosisNow):
                self._room.facts.learn(one.diagnosis)


def pending_detection(session: "Session") -> DetectorProgress | None:
    """What is to be watched of a session that leaves it to others: None if no rows wait."""
    seen = session.current.watched
    return seen if seen is not None and seen.waiting else None


def record_detection(session: "Session", seen: DetectorProgress, after: "MonitorState") -> list[Event]:
    """Tell a session what was found in rows that waited, unless it has gone back meanwhile; what is new in it."""
    if session.current.watched is None or not session.current.watched.follows(seen):
        return []
    found = log_events.unseen(session.detector.events(seen, after), session.log)
    session.log += found
    left = DetectorProgress(after, session.current.watched.waiting[len(seen.waiting) :])
    session.current = replace(session.current, watched=left, told=len(session.log))
    return found
