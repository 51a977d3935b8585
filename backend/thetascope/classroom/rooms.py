"""All rooms of the service: opened, found by their code or by a token, and ended when nobody uses them."""

import asyncio
from collections.abc import Callable

from thetascope.classroom.codes import digest, new_code, new_token, read_code
from thetascope.classroom.room import Room
from thetascope.classroom.students import Student
from thetascope.messages import Message
from thetascope.runs.specs.refusals import OverLimit, Unknown

MOST_ROOMS, MOST_OF_ONE, MOST_STUDENTS = 40, 5, 120
"""Rooms that are open at a time, those of one client, and students of a room."""
LONGEST, IDLE = 6 * 3600.0, 1800.0
"""Seconds after which a room ends, and those without a connected page after which it does."""
_TICK = 1.0
_SHOWS_UP = 90.0
"""Seconds within which a student who has joined must connect; otherwise the place is free again."""
_RETRY = 600.0


class Rooms:
    """The rooms. All methods are called on the event loop."""

    def __init__(self, clock: Callable[[], float] | None = None) -> None:
        self._clock = clock
        self._rooms: dict[str, Room] = {}
        self._teachers: dict[bytes, Room] = {}
        self._seats: dict[bytes, tuple[Room, Student]] = {}
        self._timer: asyncio.TimerHandle | None = None

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
        self._rooms.pop(room.code, None)
        self._teachers.pop(room.teacher, None)
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

    def join(self, room: Room) -> tuple[Student, str]:
        """Add a student to a room; return it and its token. Raises OverLimit."""
        student, token = room.join(self.now())
        self._seats[student.digest] = (room, student)
        return student, token

    def seat(self, token: str) -> tuple[Room, Student]:
        """Return the room and the student of a student's token. Raises Unknown."""
        seat = self._seats.get(digest(token))
        if seat is None:
            raise Unknown(Message("classroom.no-seat"))
        return seat

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

    def _tick(self) -> None:
        self._timer = None
        self.sweep()
        if self._rooms:
            self._timer = asyncio.get_running_loop().call_later(_TICK, self._tick)
