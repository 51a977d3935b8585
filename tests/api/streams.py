"""A client's end of a session's websocket, for tests."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from tests.live.stage import Frame, decoded
from tests.runs.samples import spec_data
from thetascope.client import Client
from thetascope_schemas.service.session import SUBPROTOCOL, TOKEN


@dataclass
class Page:
    """A connection and all messages received on it."""

    connection: ClientConnection
    texts: list[dict] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    number: int = 1000

    def receive(self, timeout: float = 20) -> dict | Frame:
        """Return the next message."""
        message = self.connection.recv(timeout)
        if isinstance(message, str):
            self.texts.append(json.loads(message))
            return self.texts[-1]
        self.frames.append(decoded(message))
        return self.frames[-1]

    def until(self, condition: Callable[[], object], seconds: float = 20) -> None:
        """Receive messages until a condition holds."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end
            self.receive()

    def say(self, type: str, **fields: object) -> dict:
        """Send a command and return its answer."""
        self.number += 1
        self.connection.send(json.dumps({"type": type, "id": self.number, **fields}))
        self.until(lambda: self.answers(self.number))
        (answer,) = self.answers(self.number)
        return answer

    def answers(self, id: int | None) -> list[dict]:
        return [text for text in self.texts if text["type"] in ("ack", "refused") and text["id"] == id]

    def of(self, kind: str) -> list[dict]:
        return [text for text in self.texts if text["type"] == kind]

    @property
    def end(self) -> int:
        """Return the number of rows received."""
        return self.frames[-1].end if self.frames else 0

    def rows(self) -> np.ndarray:
        """Return all rows, columns × rows; fail on a gap."""
        known = {f.first + i: f.samples[:, i] for f in self.frames for i in range(f.samples.shape[1])}
        assert sorted(known) == list(range(len(known)))
        return np.array([known[row] for row in sorted(known)]).T


@contextmanager
def watching(
    address: str, session: dict, token: str | None = None, query: str = "", also: str | None = None, **options: object
) -> Iterator[Page]:
    """Connect to a session with its own token, with another one, or with none (""). `also`: a further subprotocol."""
    token = session["token"] if token is None else token
    url = f"ws{address.removeprefix('http')}{session['links']['stream']}?{query}"
    offered = [Subprotocol(SUBPROTOCOL)] + ([Subprotocol(TOKEN + token)] if token else [])
    offered += [Subprotocol(also)] if also else []
    with connect(url, subprotocols=offered, max_size=None, compression=None, close_timeout=1, **options) as connection:
        yield Page(connection)


FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def opened(client: Client, **fields: object) -> dict:
    """Open a session on the small plant."""
    return client.post("/api/sessions", {"spec": spec_data(evaluate=0.01), **fields})


def delete(client: Client, session: dict, token: str) -> int:
    """Return the status of a DELETE with this control token."""
    client._connection.request("DELETE", session["links"]["self"], headers={"X-Control-Token": token})
    answer = client._connection.getresponse()
    answer.read()
    return answer.status


def closed(page: Page, reason: str = "") -> int:
    """Return the code with which the service closes a connection; its reason contains `reason`."""
    with pytest.raises(ConnectionClosed) as end:
        while True:
            page.receive()
    assert reason in end.value.rcvd.reason
    return end.value.rcvd.code


def spec_of(session: dict, client: Client) -> dict:
    return client.get(session["links"]["self"])["spec"]
