"""Whom a request acts for."""

from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any

MACHINE = "machine"
"""The owner of runs that are made on the machine itself: from a page or program on loopback, or on the command line."""
_KEY = "thetascope.principal"


@dataclass(frozen=True)
class Principal:
    """A client of the service.

    Args:
        client: whose turn its computations take, and whose limits they count towards.
        owner: the id under which its runs are owned.
        also: another owner in whose name it may act, too.
        is_machine: whether it is the machine's owner, who may change and remove every run.
    """

    client: str
    owner: str
    also: str = ""
    is_machine: bool = False

    def acts_for(self, owner: str) -> bool:
        """Return whether it may act in the name of an owner."""
        return self.is_machine or owner in (self.owner, self.also)


LOCAL = Principal("", MACHINE, is_machine=True)
"""The machine's owner, without an address."""


def assign(scope: MutableMapping[str, Any], principal: Principal) -> None:
    """Record for whom the request of an ASGI scope acts."""
    scope[_KEY] = principal


def is_admitted(scope: Mapping[str, Any]) -> bool:
    """Return whether a request has a principal."""
    return _KEY in scope


def principal_of(scope: Mapping[str, Any]) -> Principal:
    """Return for whom a request acts. Raises KeyError for one that nobody has admitted."""
    return scope[_KEY]
