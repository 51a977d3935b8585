"""Results about a session that come beside its rows: faults, in slices of free time, and assumptions, on a copy."""

import logging
from functools import partial
from typing import TYPE_CHECKING

from thetascope.diagnosis.yield_points import Steps
from thetascope.live.room.advice import diagnosis_of
from thetascope.live.room.serial_queue import Callback
from thetascope.live.session.live_detector import DetectorProgress
from thetascope_schemas.service.session import Assumptions, DiagnosisNow, Event

if TYPE_CHECKING:
    from thetascope.diagnosis.monitor.monitor import MonitorState
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.session import Session

log = logging.getLogger(__name__)

TESTED_TOGETHER = 500
"""Rows of one test for faults, about: when it ends, alarms are sent and viewers learn up to where rows are judged."""
MOST_BEHIND, MOST_ROWS_BEHIND = 2.0, 2000
"""Seconds of real time (as fast as possible: rows) that the diagnosis may be behind the rows shown; then time waits."""


class BackgroundChecks:
    """The checks of one room. All methods are called on the event loop."""

    def __init__(self, room: "RoomParts") -> None:
        self._room = room
        self._checked, self._checking = room.services.clock(), False
        self._again = False  # rows came to rest while a check was made of earlier ones
        self._failed = False  # the test for faults: rows do not wait for it any more
        room.session.leave_detection()

    # ---- faults ------------------------------------------------------------------------------------------------------

    def detection_job(self) -> tuple[Steps["MonitorState"], Callback] | None:
        """Return the steps that test the waiting rows for faults, and their callback; None if no rows wait.

        The steps do not touch the session.
        """
        progress = None if self._room.machine.closed else self._room.session.pending_detection()
        if progress is None:
            return None
        progress = progress.beginning(TESTED_TOGETHER)
        return self._room.session.detector.catch_up(progress), partial(self._tested, progress)

    def too_far_behind(self) -> bool:
        """Return whether the diagnosis is so far behind the rows shown that no more rows should be computed yet."""
        room = self._room
        progress = None if self._failed or not room.machine.playing else room.session.pending_detection()
        if progress is None:
            return False
        most = MOST_ROWS_BEHIND if room.playback.speed is None else room.playback.rows_in(MOST_BEHIND)
        return progress.rows - room.broadcast.left > most

    def _tested(self, progress: DetectorProgress, after: "MonitorState", error: Exception | None) -> None:
        room = self._room
        if room.machine.closed:
            return
        if error is not None:
            self._failed = True
            log.error("session %s: the test for faults failed", room.id, exc_info=error)
            return
        room.queue.submit(partial(room.session.add_detection, progress, after), self._publish)

    def _publish(self, alarms: list[Event] | None, error: Exception | None) -> None:
        room = self._room
        if error is not None:
            log.error("session %s: alarms are lost", room.id, exc_info=error)
        if alarms:
            room.broadcast.publish_findings(alarms)
            self.check(0.0)
        if alarms is not None:  # without new alarms, too: a command takes the detector back to earlier rows
            room.facts.changed()
        if not room.machine.closed and room.session.pending_detection() is not None:
            room.request_detection()
            if room.machine.playing and room.playback.speed is None:
                room.request_prefetch(False)  # it may have waited for this

    # ---- assumptions -------------------------------------------------------------------------------------------------

    def check(self, spacing: float) -> None:
        """Check the assumptions if a viewer is there and the last check is `spacing` seconds ago or more."""
        room, now = self._room, self._room.services.clock()
        self._again |= self._checking and spacing == 0.0
        if not room.broadcast.viewers or self._checking or room.shown < 2 or now - self._checked < spacing:
            return
        if room.services.may_check() or not room.machine.moving:
            self._checking = True
            room.queue.submit(room.session.fork, self._check_copy)

    def _check_copy(self, copy: "Session | None", error: Exception | None) -> None:
        if copy is None:
            self._send_checks(None, error)
        else:
            self._room.services.workshop(lambda: [*copy.assumptions(), diagnosis_of(copy)], self._send_checks)

    def _send_checks(self, results: list[Assumptions | DiagnosisNow] | None, error: Exception | None) -> None:
        self._checked, self._checking = self._room.services.clock(), False
        again, self._again = self._again, False
        if error is not None:
            log.error("session %s: checking the assumptions failed", self._room.id, exc_info=error)
        for result in results or []:
            key = result.type if isinstance(result, DiagnosisNow) else f"assumptions {result.observer}"
            self._room.broadcast.send(result, key)
            if isinstance(result, DiagnosisNow):
                self._room.facts.learn(result.diagnosis)
        if again:
            self.check(0.0)
