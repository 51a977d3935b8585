"""The limits of one client. They keep one person from taking what is for all."""

from dataclasses import dataclass
from typing import TypeVar

from thetascope.access.principal import Principal
from thetascope.settings import Settings

Number = TypeVar("Number", int, float)

_RUNS, _SESSIONS, _SOCKETS, _CPU = 32, 50, 60, 180.0
"""Defaults for clients that need the access key. A browser has one websocket for each open live page."""


@dataclass(frozen=True)
class ClientLimits:
    """The most that a client may have; None: no limit.

    Args:
        runs: that wait or run.
        sessions: that are open.
        sockets: that are open.
        cpu: processor time in s of its computations within a minute.
    """

    runs: int | None = None
    sessions: int | None = None
    sockets: int | None = None
    cpu: float | None = None


def limits_of(settings: Settings, principal: Principal) -> ClientLimits:
    """Return the limits of a client: those that are set, else the defaults; none for the machine's owner."""
    guest = not principal.is_machine
    return ClientLimits(
        _limit(settings.client_runs, _RUNS, guest),
        _limit(settings.client_sessions, _SESSIONS, guest),
        _limit(settings.client_sockets, _SOCKETS, guest),
        _limit(settings.client_cpu, _CPU, guest),
    )


def _limit(value: Number | None, default: Number, guest: bool) -> Number | None:
    """Return a limit; a value of 0 means none."""
    if value is None:
        return default if guest else None
    return value or None
