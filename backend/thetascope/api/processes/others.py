"""The other processes of the service: where each listens, and requests to one in the name of a client.

A request carries the headers of the one that it is made for. So the other process admits it as it would admit the
client itself, and answers in the client's language.
"""

import socket
from contextlib import AbstractAsyncContextManager
from http.client import HTTPConnection, HTTPException
from typing import NamedTuple
from urllib.parse import quote

from starlette.requests import HTTPConnection as Asked
from websockets.asyncio.client import ClientConnection, connect, unix_connect
from websockets.typing import Subprotocol

from thetascope.api.processes.from_router import as_received
from thetascope.live.scheduling.session_ids import process_of
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy
from thetascope.settings import Settings
from thetascope_schemas.service.session import SUBPROTOCOL

_PATIENCE = 10.0
"""Seconds in which another process has to answer."""
_EVERYWHERE = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}
"""Where a process is reached that listens on all addresses."""
_OWN = {
    "host", "connection", "upgrade", "keep-alive", "te", "expect", "transfer-encoding", "accept-encoding",
    "content-length", "content-type", "content-encoding",
}  # fmt: skip
"""Headers that belong to one request and not to its client."""


class Answer(NamedTuple):
    """An answer of another process."""

    status: int
    media_type: str
    body: bytes


def socket_of(folder: str, process: int) -> str:
    """Return the path of a process's socket."""
    return f"{folder}/{process}.sock"


def port_of(settings: Settings, process: int) -> int:
    """Return the port of a process where each has its own."""
    return settings.port + process if settings.port else 0


def elsewhere(settings: Settings, id: str) -> int | None:
    """Return the other process in which a session lives by its id; None if there is none such."""
    process = process_of(id)
    there = process is not None and settings.process is not None and process < settings.processes
    return process if there and process != settings.process else None


def get(settings: Settings, process: int, path: str, asked: Asked) -> Answer:
    """Return what a process answers to GET of a path, asked in the name of a request. Raises Busy if it does not."""
    connection = _Connection(settings, process)
    try:
        connection.request("GET", path, headers={"Host": asked.headers.get("host", "")} | dict(_headers(asked)))
        answer = connection.getresponse()
        return Answer(answer.status, answer.headers.get("Content-Type", ""), answer.read())
    except (OSError, HTTPException):
        raise Busy(Message("session.elsewhere")) from None
    finally:
        connection.close()


def stream(settings: Settings, process: int, id: str, asked: Asked) -> AbstractAsyncContextManager[ClientConnection]:
    """Return the connection of a viewer to a session in another process, for the client of a request."""
    address = f"ws://{asked.headers.get('host', 'localhost')}/api/sessions/{quote(id)}/stream"
    headers = _headers(asked)
    protocols = [Subprotocol(SUBPROTOCOL)]
    if settings.sockets:
        path = socket_of(settings.sockets, process)
        return unix_connect(
            path, address, additional_headers=headers, subprotocols=protocols, compression=None, max_size=None
        )
    return connect(
        address,
        host=_host(settings),
        port=port_of(settings, process),
        proxy=None,
        additional_headers=headers,
        subprotocols=protocols,
        compression=None,
        max_size=None,
    )


class _Connection(HTTPConnection):
    """A connection to a process, on its socket or its port."""

    def __init__(self, settings: Settings, process: int) -> None:
        super().__init__(_host(settings), port_of(settings, process), timeout=_PATIENCE)
        self._path = socket_of(settings.sockets, process) if settings.sockets else ""

    def connect(self) -> None:
        """Connect."""
        if not self._path:
            super().connect()
            return
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(_PATIENCE)
        self.sock.connect(self._path)


def _host(settings: Settings) -> str:
    return _EVERYWHERE.get(settings.host, settings.host.strip("[]"))


def _headers(asked: Asked) -> list[tuple[str, str]]:
    decoded = [(name.decode("latin-1").lower(), value.decode("latin-1")) for name, value in as_received(asked.scope)]
    return [pair for pair in decoded if pair[0] not in _OWN and not pair[0].startswith("sec-websocket-")]
