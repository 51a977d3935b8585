"""The address at which students join, and its QR code."""

import socket
from contextlib import suppress

import segno
from fastapi import Request

from thetascope.access.gate import is_loopback
from thetascope.api.http.hosts import name_of
from thetascope.api.sign_in.presented import is_https
from thetascope.settings import Settings

_ANY = ("0.0.0.0", "::", "")
_ELSEWHERE = ("192.0.2.1", 9)
"""An address for documentation: a datagram socket that is connected to it tells which of the machine's own addresses
faces the network, and sends nothing."""


def join_address(request: Request, settings: Settings, code: str) -> tuple[str, bool]:
    """Return the address of a room for phones, and whether other machines can reach it.

    It has the name under which the teacher's browser addresses the service. Where that is a loopback name, it has the
    first name in the settings, or the machine's address if the service listens on all of them.
    """
    scheme = "https" if is_https(request) else "http"
    host = request.headers.get("host", "")
    reachable = not is_loopback(name_of(host) or "")
    if not reachable:
        port = f":{request.url.port}" if request.url.port else ""
        named = next((name.strip() for name in settings.hosts.split(",") if name.strip()), None)
        own = named or (machine_address() if (settings.published or settings.host) in _ANY else None)
        if own is not None:
            host, reachable = own if ":" in own else own + port, True
    return f"{scheme}://{host}/join/{code}", reachable


def machine_address() -> str | None:
    """Return the address of this machine in its network; None if it has none."""
    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(_ELSEWHERE)
        address = probe.getsockname()[0]
        return None if is_loopback(address) else address
    return None


def qr_rows(address: str) -> tuple[str, ...]:
    """Return the QR code of an address: a text of 0 and 1 for each row, without a margin."""
    code = segno.make(address, error="m", micro=False)
    return tuple("".join("1" if dark else "0" for dark in row) for row in code.matrix)
