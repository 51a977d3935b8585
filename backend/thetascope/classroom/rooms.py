"""All rooms of the service: opened, found by their code or by a token, and ended when nobody uses them."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Protocol

from thetascope.classroom.faults.computing import Computing
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.people.codes import digest, new_code, new_token, read_code
from thetascope.classroom.people.students import Student
from thetascope.classroom.room import Room
from thetascope.classroom.session_elsewhere import SessionsElsewhere
from thetascope.messages import Message
from thetascope.runs.specs.refusals import OverLimit, Unknown
from thetascope_schemas.service.learning.mystery import MysterySetup

MOST_ROOMS, MOST_OF_ONE, MOST_STUDENTS = 40, 5, 120
"""Rooms that are open at a time, those of one client, and students of a room."""
LONGEST, IDLE = 6 * 3600.0, 1800.0
"""Seconds after which a room ends, and those without a connected page after which it does."""
_TICK = 1.0
_SHOWS_UP = 90.0
"""Seconds within which a student who has joined must connect; otherwise the place is free again."""
_RETRY = 600.0


_TOKENS = 12
"""Tokens of one room's teachers; for one more the oldest opens nothing any more."""


class Follower(Protocol):
    """What is done with the rooms of learning platforms beside."""

    def look(self, room: Room) -> None:
        """Notice what has changed in a room."""

    def forget(self, room: Room) -> None:
        """Notice that a room has ended."""


class Rooms:
    """The rooms. All methods are called on the event loop."""

    def __init__(self, computing: Computing, clock: Callable[[], float] | None = None) -> None:
        self._computing, self._clock = computing, clock
        self._rooms: dict[str, Room] = {}
        self._teachers: dict[bytes, Room] = {}
        self._seats: dict[bytes, tuple[Room, Student]] = {}
        self._timer: asyncio.TimerHandle | None = None
        self.follower: Follower | None = None
        self.elsewhere = SessionsElsewhere()

    def __len__(self) -> int:
        return len(self._rooms)

    def now(self) -> float:
        """Return the time in s."""
        return (self._clock or asyncio.get_running_loop().time)()

    def open(self, owner: str) -> tuple[Room, str]:
        """Open a room; return it and its teacher's token. Raises OverLimit."""
        self.sweep()
        own = sum(room.owner == owner for room in self._rooms.values())
        if len(self._rooms) >= MOST_ROOMS or own >= MOST_OF_ONE:
            raise OverLimit(Message("classroom.too-many", n=min(own, MOST_OF_ONE)), _RETRY)
        token = new_token()
        code = new_code(self._rooms)
        room = self._rooms[code] = Room(code, digest(token), owner, MOST_STUDENTS, self.now())
        self._teachers[room.teacher] = room
        if self._timer is None:
            self._tick()
        return room, token

    def close(self, room: Room) -> None:
        """End a room: its students, votes and answers are forgotten."""
        if self.follower is not None and room.code in self._rooms:
            self.follower.look(room)
            self.follower.forget(room)
        self._rooms.pop(room.code, None)
        self._teachers = {key: one for key, one in self._teachers.items() if one is not room}
        for student in room.students.values():
            self._seats.pop(student.digest, None)
        room.close()

    def stop(self) -> None:
        """End all rooms."""
        if self._timer is not None:
            self._timer.cancel()
        for room in list(self._rooms.values()):
            self.close(room)

    def with_code(self, text: str) -> Room | None:
        """Return the room with a code as it was typed; None if there is none."""
        code = read_code(text)
        return None if code is None else self._rooms.get(code)

    def of_teacher(self, token: str) -> Room:
        """Return the room of a teacher's token. Raises Unknown."""
        room = self._teachers.get(digest(token))
        if room is None:
            raise Unknown(Message("classroom.no-room"))
        return room

    def another_teacher(self, room: Room) -> str:
        """Return one more token of a room's teacher."""
        token = new_token()
        known = [key for key, one in self._teachers.items() if one is room]
        for key in known[: max(0, len(known) + 1 - _TOKENS)]:
            del self._teachers[key]
        self._teachers[digest(token)] = room
        return token

    def seat_again(self, room: Room, student: Student) -> str:
        """Return a new token of a student's seat; the one before opens nothing any more."""
        token = new_token()
        self._seats.pop(student.digest, None)
        student.digest = digest(token)
        self._seats[student.digest] = (room, student)
        return token

    def join(self, room: Room) -> tuple[Student, str]:
        """Add a student to a room; return it and its token. Raises OverLimit."""
        student, token = room.join(self.now())
        self._seats[student.digest] = (room, student)
        self._late(room, student)
        return student, token

    def seat(self, token: str) -> tuple[Room, Student]:
        """Return the room and the student of a student's token. Raises Unknown."""
        seat = self._seats.get(digest(token))
        if seat is None:
            raise Unknown(Message("classroom.no-seat"))
        return seat

    def begin_own(self, room: Room, setup: MysterySetup, seconds: float) -> None:
        """Begin a round of hidden faults, and prepare them."""
        round = room.begin_own(setup, seconds, self.now())
        self._task(round, self._prepare(room, round))

    def _task(self, round: OwnRound, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        round.tasks.add(task)
        task.add_done_callback(round.tasks.discard)

    async def _prepare(self, room: Room, round: OwnRound) -> None:
        """Compute records, which play as soon as they are there, then what answers are graded with."""
        places = sorted({seat.place for seat in round.seats.values()})
        await asyncio.gather(*(self._play(room, round, place) for place in places))
        await asyncio.gather(*(self._examine(room, round, place) for place in places))

    async def _play(self, room: Room, round: OwnRound, place: int) -> None:
        if await round.prepare(place, self._computing):
            self._begin_seats(room, round)

    async def _examine(self, room: Room, round: OwnRound, place: int) -> None:
        await round.examine(place, self._computing)
        if round.revealed:
            room.changed()

    def _begin_seats(self, room: Room, round: OwnRound) -> None:
        now = self.now()
        begun = [student for student in room.students.values() if round.begin_seat(student.id, now)]
        if not begun:
            return
        room.tick(now)
        room.changed()
        for student in begun:
            for socket in student.sockets:
                socket.restart()

    def _late(self, room: Room, student: Student) -> None:
        """Let a student who joins during a round of hidden faults take part."""
        round = room.round
        if not isinstance(round, OwnRound) or round.revealed:
            return
        place = round.seat(student.id).place
        if place in round.records:
            self._begin_seats(room, round)
        else:
            self._task(round, self._play(room, round, place))
        if place not in round.materials:
            self._task(round, self._examine(room, round, place))

    def remove(self, room: Room, id: str) -> None:
        """Remove a student. Raises Unknown."""
        self._seats.pop(room.remove(id).digest, None)

    def sweep(self) -> None:
        """End the rooms that are too old, or that nobody has used for long."""
        now = self.now()
        for room in list(self._rooms.values()):
            for student in [one for one in room.students.values() if not one.came and now - one.left > _SHOWS_UP]:
                self.remove(room, student.id)
            room.tick(now)
            if now - room.opened > LONGEST or now - room.used > IDLE:
                self.close(room)
            elif self.follower is not None:
                self.follower.look(room)

    def _tick(self) -> None:
        self._timer = None
        self.sweep()
        if self._rooms:
            self._timer = asyncio.get_running_loop().call_later(_TICK, self._tick)
