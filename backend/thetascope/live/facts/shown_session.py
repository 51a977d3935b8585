"""A session and the row that is shown: the part of a room that facts need."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from thetascope_schemas.service.facts import Facts

if TYPE_CHECKING:
    from thetascope.live.session.session import Session


class Machine(Protocol):
    """The state of a room."""

    @property
    def held(self) -> bool:
        """Whether a long command is carried out."""
        ...

    @property
    def closed(self) -> bool:
        """Whether the room is closed."""
        ...

    @property
    def moving(self) -> bool:
        """Whether time runs."""
        ...


class Sender(Protocol):
    """Sends messages to all viewers."""

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns of the rows that are shown."""
        ...

    @property
    def send(self) -> Callable[..., Any]:
        """Send a message, as the newest of a key."""
        ...


class Services(Protocol):
    """The outside of a room."""

    @property
    def clock(self) -> Callable[[], float]:
        """The time in s."""
        ...


class ShownSession(Protocol):
    """A room as its facts see it."""

    @property
    def session(self) -> "Session":
        """The session, which may be ahead of the row that is shown."""
        ...

    @property
    def shown(self) -> int:
        """Rows shown so far."""
        ...

    @property
    def machine(self) -> Machine:
        """The state of the room."""
        ...

    @property
    def broadcast(self) -> Sender:
        """Sends messages to all viewers."""
        ...

    @property
    def services(self) -> Services:
        """The services that rooms share."""
        ...


class CurrentFacts(Protocol):
    """Keeps the newest facts."""

    @property
    def current(self) -> Facts:
        """The newest facts that were sent."""
        ...


class RecordedSession(ShownSession, Protocol):
    """A room whose past rows can be read."""

    @property
    def t(self) -> float:
        """Time of the last row that was shown, in s."""
        ...

    @property
    def oldest(self) -> int:
        """The first row that is still kept."""
        ...

    @property
    def facts(self) -> CurrentFacts:
        """The newest facts of the session."""
        ...

    def past_rows(self, columns: tuple[str, ...], first: int, last: int) -> Awaitable[np.ndarray]:
        """Return rows first … last − 1, columns × rows."""
        ...
