"""Decide for whom a request acts, or that it needs the access key.

| The service listens on | A request                                              | acts for                        |
|------------------------|--------------------------------------------------------|---------------------------------|
| anything, OPEN=1       | any                                                    | the machine's owner             |
| loopback               | under a loopback name, not passed on by a proxy        | the machine's owner             |
| loopback               | any other, as from a proxy                             | the holder of the key or ticket |
| anything else          | any, also one that comes from the machine itself       | the holder of the key or ticket |

A container listens on all of its own addresses; there the address counts under which its port is published.
"""

import hmac
from base64 import b32encode
from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum
from ipaddress import ip_address

from thetascope.access import tickets
from thetascope.access.key_file import KeyFile, Keys
from thetascope.access.principal import MACHINE, Principal
from thetascope.settings import Settings

FILE = "access.json"
HOLDER = "key"
"""The owner of runs of scripts that send the key and no name of their own. Everybody who has the key may act for it."""
_LONGEST = 200


class Refused(Enum):
    """Why a request has no principal."""

    NO_KEY = "access.no-key"
    """It carries neither a key nor a ticket."""
    WRONG_KEY = "access.wrong-key"
    """It carries a wrong key."""
    ENDED = "access.ended"
    """It carries a ticket that no longer holds."""


@dataclass(frozen=True)
class Presented:
    """What a request shows.

    Args:
        address: of the client, as the server knows it.
        loopback_name: whether it addresses the service by a loopback name.
        proxied: whether a proxy passed it on.
        keys: keys in its headers.
        tickets: cookies by name.
        script: the name that a script gives itself, or "".
    """

    address: str = ""
    loopback_name: bool = True
    proxied: bool = False
    keys: Collection[str] = ()
    tickets: tuple[tuple[str, str], ...] = ()
    script: str = ""


class Gate:
    """Admits requests, or says why not.

    Raises SettingsError if the chosen key is unsuitable; nothing is read or written before it is needed.
    """

    def __init__(self, settings: Settings) -> None:
        self.file = KeyFile(settings.data / FILE, settings.key)
        self.is_open = bool(settings.open)
        self.on_loopback = is_loopback(settings.published or settings.host)
        self.has_names = bool(settings.hosts.strip())

    @property
    def asks_everybody(self) -> bool:
        """Return whether even a request from the machine itself needs the key."""
        return not self.is_open and not self.on_loopback

    @property
    def expects_others(self) -> bool:
        """Return whether requests that need the key are expected, so that it is created at the start."""
        return not self.is_open and (not self.on_loopback or self.has_names or self.file.is_chosen)

    def admit(self, request: Presented) -> Principal | Refused:
        """Return for whom a request acts. Raises KeyFileError."""
        local = self.on_loopback and request.loopback_name and not request.proxied
        if self.is_open or local:
            return Principal(request.address, MACHINE, is_machine=True)
        keys = self.file.current()
        if keys is None:
            return Refused.WRONG_KEY if request.keys else Refused.NO_KEY
        ticket = self.ticket_in(request, keys)
        holder = tickets.holder(keys, ticket) if ticket else None
        if holder is not None:
            return Principal(f"browser {holder}", f"browser-{holder}", HOLDER)
        if any(opens(keys, key) for key in request.keys):
            owner = _script(keys, request.script) if request.script else HOLDER
            return Principal(f"{owner} {request.address}", owner, HOLDER)
        if request.keys:
            return Refused.WRONG_KEY
        return Refused.ENDED if ticket and tickets.owner_id(keys, ticket) else Refused.NO_KEY

    def sign_in(self, request: Presented, key: str) -> str | None:
        """Return a new ticket for a browser that gives a key; None if the key is wrong. Raises KeyFileError."""
        keys = self.file.current()
        if keys is None or not opens(keys, key):
            return None
        return tickets.issue(keys, self.ticket_in(request, keys))

    def ticket_in(self, request: Presented, keys: Keys) -> str | None:
        """Return the ticket of this installation among the cookies of a request."""
        name = cookie_name(keys)
        return next((value for key, value in request.tickets if key == name), None)

    def seal(self) -> bytes | None:
        """Return the digest of the present key: while it is the same, those who were admitted stay so."""
        keys = self.file.current()
        return None if keys is None else keys.digest


def opens(keys: Keys, key: str) -> bool:
    """Return whether a key is the right one, in a time that does not depend on where it differs."""
    if keys.digest is None or not key or len(key) > _LONGEST:
        return False
    return hmac.compare_digest(keys.digest_of(key), keys.digest)


def cookie_name(keys: Keys) -> str:
    """Return the name of the cookie that holds a ticket of an installation."""
    return f"thetascope-{keys.installation}"


def is_loopback(name: str) -> bool:
    """Return whether a host name or address is this machine's own for sure."""
    name = name.lower().strip("[]")
    try:
        return ip_address(name).is_loopback
    except ValueError:
        return name == "localhost" or name.endswith(".localhost")


def _script(keys: Keys, name: str) -> str:
    """Return the owner that a script's name stands for. Others cannot compute names from it."""
    return f"script-{b32encode(keys.sign('script', name[:_LONGEST])[:15]).decode().lower()}"
