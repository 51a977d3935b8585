"""Sends the viewers of a room the facts whenever they change: by a command, a finding, or time that passes."""

from thetascope.live.facts.past_facts import past_facts
from thetascope.live.facts.session_facts import FactsMemory, facts_of, judged_until, time_of_next_row
from thetascope.live.facts.shown_session import ShownSession
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis
from thetascope_schemas.service.facts import Facts
from thetascope_schemas.service.session import FactsNow

SPACING = 0.1
"""Seconds between two messages, at least, while time runs."""
_LATELY = 100  # newest events of the log, among which those are that are not shown yet


class FactsPublisher:
    """The facts of one room. All methods are called on the event loop."""

    def __init__(self, room: ShownSession) -> None:
        self._room = room
        self._memory = FactsMemory(room.session.record)
        self._diagnosis: ObserverDiagnosis | None = None
        self._sent: Facts | None = None
        self._due, self._at = True, -SPACING
        self._row, self._next = 0, 0.0  # rows for which the facts hold, and the time in s up to which nothing changes
        self._events = 0  # of the log, when the facts were made

    def facts(self) -> Facts:
        """Return the facts at the row that is shown, for a new viewer; the others get them too if they have changed."""
        room = self._room
        self._row, self._due = room.shown, False
        facts = facts_of(room.session, room.shown, self._memory, self._diagnosis)
        self._next, self._events = self._following(), len(room.session.log)
        if self._sent is None or facts != self._sent.model_copy(update={"t": facts.t}):
            self._sent, self._at = facts, room.services.clock()
            room.broadcast.send(FactsNow(row=room.shown, facts=facts), "facts")
        return facts

    @property
    def current(self) -> Facts:
        """Return the newest facts that were sent; those of now if none were."""
        return self._sent or self.facts()

    def past(self, row: int) -> Facts:
        """Return the facts as they were when rows 0 … row − 1 had been shown."""
        return past_facts(self._room.session, row, self._diagnosis)

    def _following(self) -> float:
        """Return the time in s of the next row at which the spec, or an event of a row computed ahead,
        changes the facts."""
        session, shown = self._room.session, self._room.shown
        times = [t for fault in session.spec.faults for t in (fault.onset, fault.end) if t is not None]
        times += [command.at for command in session.spec.commands]
        times += [(event.row + 1) * session.record for event in session.log[-_LATELY:]]
        if self._diagnosis is not None and self._diagnosis.calibration is not None:
            times.append(self._diagnosis.calibration.from_time)
        at = time_of_next_row(session.record, shown)
        return min((t for t in times if t > at), default=float("inf"))

    def _lag_changed(self) -> bool:
        """Return whether the detector has fallen behind, has caught up, or has judged more rows, since facts were
        sent."""
        room = self._room
        t = max(0, room.shown - 1) * room.session.record
        return self._sent is not None and judged_until(room.session, t) != self._sent.judged

    def learn(self, diagnosis: ObserverDiagnosis) -> None:
        """Take the newest report of the detector."""
        self._diagnosis = diagnosis
        self.changed()

    def changed(self, urgent: bool = False) -> None:
        """Publish after something has happened: now, or with the next rows if facts were sent a moment ago."""
        self._due = True
        self.publish(urgent)

    def publish(self, urgent: bool = False) -> None:
        """Send the facts if they have changed; `urgent`: however soon after the last ones."""
        room = self._room
        reached = time_of_next_row(room.session.record, room.shown) >= self._next
        happened = len(room.session.log) != self._events or room.shown < self._row
        if room.machine.held or room.machine.closed or not (self._due or reached or happened or self._lag_changed()):
            return
        now = room.services.clock()
        if not urgent and room.machine.moving and now - self._at < SPACING:
            self._due = True
            return
        self.facts()
