"""A room: its students, its rounds, and who is sent its state. It has no input or output, and no clock of its own."""

from secrets import token_hex

from thetascope.classroom.curves import Curves, Shown
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.people import nicknames
from thetascope.classroom.people.codes import digest, new_token
from thetascope.classroom.people.listeners import Listener
from thetascope.classroom.people.students import Student
from thetascope.classroom.rounds import FollowRound
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotReady, OverLimit, Unknown
from thetascope_schemas.service.classroom.requests import (
    CLOSE_NO_ROOM,
    CLOSE_TOKEN,
    AnswerRequest,
    LeadRequest,
)
from thetascope_schemas.service.classroom.views import GradesView
from thetascope_schemas.service.learning.mystery import MysterySetup

_ROUNDS = 60
"""Past rounds that are kept for the results."""
_RETRY = 60.0
"""Seconds after which somebody may try again to join a full room."""


class Room:
    """A room.

    Args:
        code: with which students join.
        teacher: digest of the teacher's token.
        owner: the client that opened it.
        most: students that it may have.
        now: the time, s.
    """

    def __init__(self, code: str, teacher: bytes, owner: str, most: int, now: float) -> None:
        self.code, self.teacher, self.owner, self.most = code, teacher, owner, most
        self.opened = self.used = now
        self.now = now
        self.students: dict[str, Student] = {}
        self.round: FollowRound | OwnRound | None = None
        self.past: list[FollowRound | OwnRound] = []
        self.numbered = 0
        self.curves = Curves()
        self.grades: GradesView | None = None
        self._wall: list[Listener] = []
        self._asleep: frozenset[str] = frozenset()

    # ---- students ----------------------------------------------------------------------------------------------------

    def join(self, now: float) -> tuple[Student, str]:
        """Add a student; return it and its token. Raises OverLimit if the room is full."""
        if len(self.students) >= self.most:
            raise OverLimit(Message("classroom.full", n=self.most), _RETRY)
        token = new_token()
        animal = nicknames.free_animal([student.animal for student in self.students.values()])
        student = Student(token_hex(6), digest(token), animal, now)
        self.students[student.id] = student
        if isinstance(self.round, OwnRound) and not self.round.revealed:
            self.round.seat(student.id)
        self.touch(now)
        self.changed()
        return student, token

    def rename(self, student: Student, name: str | None, now: float) -> None:
        """Give a student a name, or another animal for None."""
        student.name = None if name is None else nicknames.harmless(name)
        if name is None:
            student.animal = nicknames.free_animal([one.animal for one in self.students.values()])
        self.touch(now)
        self.changed_for(student)

    def remove(self, id: str) -> Student:
        """Remove a student, and return it. Raises Unknown."""
        student = self.students.pop(id, None)
        if student is None:
            raise Unknown(Message("classroom.no-student"))
        for listener in student.listeners:
            listener.close(CLOSE_TOKEN)
        self.changed()
        return student

    # ---- rounds ------------------------------------------------------------------------------------------------------

    def begin(self, now: float) -> FollowRound:
        """Begin a round in which all see the teacher's session."""
        self.round = following = FollowRound(self._next_round())
        self._begun(now)
        return following

    def begin_own(self, setup: MysterySetup, seconds: float, now: float) -> OwnRound:
        """Begin a round of hidden faults; all students get a place in it."""
        self.round = own = OwnRound(self._next_round(), setup, seconds)
        for student in self.students:
            own.seat(student)
        self._begun(now)
        return own

    def _next_round(self) -> int:
        """Put the present round to the past ones; return the number of the next."""
        if self.round is not None:
            self.numbered = self.round.number
            if isinstance(self.round, OwnRound):
                self.round.stop()
            self.past = [*self.past, self.round][-_ROUNDS:]
        return self.numbered + 1

    def _begun(self, now: float) -> None:
        self.curves.show(None, None)
        self.touch(now)
        self.changed()
        self.restart_curves()

    def restart_curves(self) -> None:
        """Send heads and rows of the curves again: they are those of another round, or more of them are there."""
        for student in self.students.values():
            for socket in student.sockets:
                socket.restart()

    def own(self) -> OwnRound:
        """Return the present round, if it is one of hidden faults. Raises NotReady."""
        if not isinstance(self.round, OwnRound):
            raise NotReady(Message("classroom.no-faults"))
        return self.round

    def answer(self, student: Student, given: AnswerRequest, now: float) -> None:
        """Keep a student's answer. Raises NotReady, InvalidSpec."""
        self.own().answer(student.id, given, now)
        self.touch(now)
        self.changed_for(student)

    def reveal(self, now: float) -> None:
        """Show the hidden faults, and grade the answers. Raises NotReady."""
        self.own().shown.set()
        self.touch(now)
        self.changed()
        self.restart_curves()

    def following(self) -> FollowRound:
        """Return the present round, if all follow the teacher in it. Raises NotReady."""
        if not isinstance(self.round, FollowRound):
            raise NotReady(Message("classroom.not-following"))
        return self.round

    def show(self, lead: LeadRequest, now: float, session: Shown | None) -> None:
        """Show what the teacher shows, with the curves of a session. Raises NotReady."""
        self.following().show(lead, now)
        self.curves.show(session, lead.strip)
        self.touch(now)
        self.changed()

    def vote(self, student: Student, step: str, choice: int, now: float) -> None:
        """Count a student's vote. Raises NotReady if the step is not open for votes."""
        if not self.following().vote(student.id, step, choice, now):
            raise NotReady(Message("classroom.vote-closed"))
        self.touch(now)
        self.changed_for(student)

    # ---- who is sent the state ---------------------------------------------------------------------------------------

    def touch(self, now: float) -> None:
        """Note that the room is used."""
        self.now = self.used = max(now, self.used)

    def tick(self, now: float) -> None:
        """Note the time, and show who fell asleep or woke up."""
        self.now = now
        asleep = frozenset(id for id, student in self.students.items() if student.is_asleep(now))
        if asleep != self._asleep:
            self._asleep = asleep
            self._to_wall()
        if isinstance(self.round, OwnRound) and self.round.left(now) == 0.0:
            self.reveal(now)
        if self._wall or len(asleep) < len(self.students):
            self.used = now

    def arrive(self, student: Student, listener: Listener) -> None:
        """Add a connection of a student."""
        student.connected(listener)
        self._to_wall()

    def depart(self, student: Student, listener: Listener, now: float) -> None:
        """Remove a connection of a student, who keeps the place."""
        student.disconnected(listener, now)
        self._to_wall()

    def watch(self, listener: Listener) -> None:
        """Add a connection of the wall."""
        self._wall.append(listener)

    def unwatch(self, listener: Listener) -> None:
        """Remove a connection of the wall."""
        self._wall.remove(listener)

    def changed(self) -> None:
        """Send the state to everybody."""
        self._to_wall()
        for student in self.students.values():
            student.changed()

    def changed_for(self, student: Student) -> None:
        """Send the state to a student and the wall."""
        student.changed()
        self._to_wall()

    def _to_wall(self) -> None:
        for listener in self._wall:
            listener.changed()

    def close(self) -> None:
        """End all connections."""
        self.curves.show(None, None)
        if isinstance(self.round, OwnRound):
            self.round.stop()
        for listener in (*self._wall, *(one for student in self.students.values() for one in student.listeners)):
            listener.close(CLOSE_NO_ROOM)
