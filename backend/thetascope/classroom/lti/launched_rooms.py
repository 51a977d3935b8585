"""The rooms of activities: who came from a platform to which room, and what was sent to the gradebook. In memory only.

Of a student the platform's id is kept, as long as the room is open: the gradebook needs it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from thetascope.classroom.faults.outcomes import outcome_of
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.lti.id_token import Launch, Resource
from thetascope.classroom.lti.scores import Score
from thetascope.classroom.people.nicknames import harmless
from thetascope.classroom.people.students import Student
from thetascope.classroom.room import Room
from thetascope.classroom.rooms import Rooms
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotReady
from thetascope_schemas.service.classroom.views import GradesView

Send = Callable[[Score, Callable[[str], None]], None]


@dataclass
class Person:
    """A student who came from a platform: the student in the room, and the last score that was sent.

    Args:
        student: the id in the room.
        launch: the last one.
        sent: points, and the most there were.
        seen: what was graded when the points were counted last.
        state: of the last score.
        why: what went wrong.
    """

    student: str
    launch: Launch
    sent: tuple[float, float] | None = None
    seen: tuple[tuple[int, int], ...] = ()
    state: str = ""
    why: str = ""


@dataclass
class LaunchedRoom:
    """The room of an activity."""

    room: Room
    persons: dict[str, Person] = field(default_factory=dict)


class LaunchedRooms:
    """Used on the event loop only.

    Args:
        rooms: all rooms.
        send: sends a score, and says on the event loop what came of it.
    """

    def __init__(self, rooms: Rooms, send: Send) -> None:
        self._rooms, self._send = rooms, send
        self._of: dict[Resource, LaunchedRoom] = {}
        rooms.follower = self

    def open(self, launch: Launch, owner: str) -> tuple[Room, str]:
        """Return the room of an activity and a teacher's token, and open it if there is none. Raises OverLimit."""
        known = self._of.get(launch.resource)
        if known is not None:
            return known.room, self._rooms.another_teacher(known.room)
        room, token = self._rooms.open(owner)
        self._of[launch.resource] = LaunchedRoom(room)
        return room, token

    def is_open(self, launch: Launch) -> bool:
        """Return whether an activity has a room."""
        return launch.resource in self._of

    def seat(self, launch: Launch) -> tuple[Room, Student, str]:
        """Return the room, the student's own place in it, and a token. Raises NotReady, OverLimit."""
        known = self._of.get(launch.resource)
        if known is None:
            raise NotReady(Message("lti.no-room"))
        room, person = known.room, known.persons.get(launch.person)
        student = None if person is None else room.students.get(person.student)
        if person is not None and student is not None:
            person.launch, person.seen = launch, ()
            return room, student, self._rooms.seat_again(room, student)
        student, token = self._rooms.join(room)
        known.persons[launch.person] = Person(student.id, launch)
        if name := harmless(launch.name):
            room.rename(student, name, self._rooms.now())
        return room, student, token

    def look(self, room: Room) -> None:
        """Send the scores that are new; called every second and before a room ends."""
        known = next((one for one in self._of.values() if one.room is room), None)
        if known is None:
            return
        graded = _graded(room)
        for person in known.persons.values():
            if person.seen == graded:
                continue
            person.seen = graded
            score = score_of(room, person.student)
            if score is None or not person.launch.column or score == person.sent:
                continue
            person.sent, person.state = score, "waiting"
            points, most = score
            launch = person.launch
            self._send(Score(launch.platform, launch.column, launch.person, points, most), _came(known, person, score))
        _show(known)

    def forget(self, room: Room) -> None:
        """Forget who came to a room that has ended."""
        self._of = {resource: one for resource, one in self._of.items() if one.room is not room}


def _rounds(room: Room) -> list[OwnRound]:
    """Return the rounds of hidden faults whose truth is shown."""
    rounds = (*room.past, *((room.round,) if room.round is not None else ()))
    return [one for one in rounds if isinstance(one, OwnRound) and one.revealed]


def _graded(room: Room) -> tuple[tuple[int, int], ...]:
    """Return what changes when more can be graded: counting points anew each second would take time for nothing."""
    return tuple((one.number, len(one.materials)) for one in _rounds(room))


def score_of(room: Room, student: str) -> tuple[float, float] | None:
    """Return a student's points over the rounds of hidden faults that were graded, and the most that were possible.

    None: there is no answer in any. A round without an answer counts where there is one in another.
    """
    points, most, answered = 0, 0, False
    for one in _rounds(room):
        outcome = outcome_of(one, student)
        if outcome is not None:
            answered = answered or outcome.points is not None
            points, most = points + (outcome.points or 0), most + 100
    return (float(points), float(most)) if answered else None


def _came(known: LaunchedRoom, person: Person, score: tuple[float, float]) -> Callable[[str], None]:
    """Return what notes how the sending of a score has ended."""

    def note(why: str) -> None:
        if person.sent == score:
            person.state, person.why = ("failed" if why else "sent"), why
            _show(known)

    return note


def _show(known: LaunchedRoom) -> None:
    """Show on the wall how many scores were sent."""
    states = [person.state for person in known.persons.values()]
    failed = [person.why for person in known.persons.values() if person.state == "failed"]
    view = GradesView(
        sent=states.count("sent"),
        waiting=states.count("waiting"),
        failed=len(failed),
        why=failed[0] if failed else "",
    )
    if any(states) and known.room.grades != view:
        known.room.grades = view
        known.room.changed()
