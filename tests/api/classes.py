"""A teacher and students of a classroom over HTTP, for tests and for the benchmark."""

import json
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from typing import Any
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from thetascope_schemas.service.session import SUBPROTOCOL, TOKEN

CARD = {
    "place": 2,
    "of": 4,
    "title": {"en": "The copy", "zh": "副本"},
    "ask": {"en": "What will it do?", "zh": "它会怎样?"},
    "options": [{"en": "Stay wrong", "zh": "一直不对"}, {"en": "Find it", "zh": "找到"}],
}
STEP = {"step": "lesson 2", "card": CARD}


@dataclass
class Person:
    """Somebody with a token."""

    address: str
    header: str
    token: str
    code: str = ""

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """Return status and answer of a request."""
        return send(self.address, method, f"/api/classroom{path}", body, {self.header: self.token})

    def got(self, method: str, path: str, body: Any = None) -> Any:
        """Return the answer of a request that succeeds."""
        status, answer = self.ask(method, path, body)
        assert status < 300, answer
        return answer

    @contextmanager
    def stream(self, path: str):
        """Yield a websocket with the token."""
        url = f"ws{self.address.removeprefix('http')}/api/classroom{path}"
        offered = [Subprotocol(SUBPROTOCOL), Subprotocol(TOKEN + self.token)]
        with connect(url, subprotocols=offered, compression=None, close_timeout=1) as connection:
            yield connection


def send(address: str, method: str, path: str, body: Any = None, headers: dict | None = None) -> tuple[int, Any]:
    """Return status and answer of a request: JSON, else text."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    text = None if body is None else json.dumps(body)
    kind = {} if body is None else {"Content-Type": "application/json"}
    connection.request(method, path, text, kind | (headers or {}))
    answer = connection.getresponse()
    content = answer.read().decode()
    connection.close()
    is_json = "json" in answer.getheader("content-type", "")
    return answer.status, json.loads(content) if is_json else content


def teacher(address: str, headers: dict | None = None) -> Person:
    """Open a room, and return its teacher."""
    status, room = send(address, "POST", "/api/classroom", {}, headers)
    assert status == 201, room
    return Person(address, "X-Teacher-Token", room["token"], room["code"])


def student(address: str, code: str) -> Person:
    """Join a room."""
    status, joined = send(address, "POST", "/api/classroom/join", {"code": code})
    assert status == 201, joined
    return Person(address, "X-Seat-Token", joined["token"], code)


def until(connection: ClientConnection, condition: Callable[[dict], object], seconds: float = 60) -> dict:
    """Return the first state that meets a condition."""
    while True:
        message = connection.recv(seconds)
        if isinstance(message, str) and condition(state := json.loads(message)):
            return state


def close_code(connection: ClientConnection) -> int:
    """Return the code with which the service closes a connection."""
    try:
        while True:
            connection.recv(60)
    except ConnectionClosed as end:
        assert end.rcvd is not None
        return end.rcvd.code
