"""A student in a room."""

from dataclasses import dataclass, field

from thetascope.classroom.curves import CurveSocket
from thetascope.classroom.people.listeners import Listener
from thetascope_schemas.service.classroom.requests import CLOSE_ELSEWHERE, Caption

ASLEEP_AFTER = 6.0
"""Seconds without a connection after which a student counts as asleep."""
_PAGES = 3
"""Pages of one student that may be connected; the oldest is closed for one more."""


@dataclass
class Student:
    """A student.

    Args:
        id: names the student on the wall; it opens nothing.
        digest: of the student's token.
        animal: the nickname.
        left: when the last connection ended, s.
        name: the name that the student has chosen.
        listeners: the student's connections.
        sockets: the student's connections for curves.
        came: whether there has been a connection.
    """

    id: str
    digest: bytes
    animal: Caption
    left: float
    name: str | None = None
    listeners: list[Listener] = field(default_factory=list)
    came: bool = False
    sockets: set[CurveSocket] = field(default_factory=set)

    def is_asleep(self, now: float) -> bool:
        """Return whether no page of the student is connected."""
        return not self.listeners and now - self.left > ASLEEP_AFTER

    def connected(self, listener: Listener) -> None:
        """Add a connection."""
        self.came = True
        self.listeners.append(listener)
        for old in self.listeners[:-_PAGES]:
            old.close(CLOSE_ELSEWHERE)

    def disconnected(self, listener: Listener, now: float) -> None:
        """Remove a connection."""
        if listener in self.listeners:
            self.listeners.remove(listener)
        self.left = now

    def changed(self) -> None:
        """Send the student's state to all connections."""
        for listener in self.listeners:
            listener.changed()
