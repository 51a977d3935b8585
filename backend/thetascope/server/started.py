"""What is known of a service when it answers: its address, and how to get in."""

from dataclasses import dataclass
from urllib.parse import urlencode

from thetascope.access.gate import Gate
from thetascope.settings import Settings


@dataclass(frozen=True)
class Started:
    """A service that answers.

    Args:
        address: of the page, as seen from this machine.
        key: the access key if it was created now; it is shown this once.
        asks: whether the service asks for the key, also on this machine.
        unguarded: whether other machines may reach it, and nobody is asked.
    """

    address: str
    key: str | None = None
    asks: bool = False
    unguarded: bool = False

    @property
    def link(self) -> str:
        """Return the address that opens the page in a browser on this machine."""
        return f"{self.address}?{urlencode({'key': self.key})}" if self.key and self.asks else self.address


def started_at(settings: Settings, port: int, key: str | None, gate: Gate) -> Started:
    """Return what is known of a service that listens on a port."""
    host = "127.0.0.1" if settings.host in ("0.0.0.0", "::") else settings.host
    return Started(f"http://{host}:{port}/", key, gate.asks_everybody, gate.is_open and not gate.on_loopback)
