"""Read many websocket connections in one process with little overhead, and record when frames arrive."""

import base64
import os
import selectors
import socket
import struct
import time
from collections.abc import Callable

from thetascope_schemas.service.session import SUBPROTOCOL, TOKEN


class Watcher:
    """One connection: the arrival times of frames, and when the last command took effect."""

    def __init__(self, connection: socket.socket) -> None:
        self.socket = connection
        self.clear()
        self._buffer = b""
        self._acts_at: int | None = None

    def clear(self) -> None:
        """Discard the frames so far."""
        self.times: list[float] = []
        self.bytes = self.texts = 0
        self.effect: float | None = None

    def command(self, text: str) -> None:
        """Send a command; `effect` becomes the time of the first frame with a row on which it acts."""
        self.effect, self._acts_at = None, None
        self._send(1, text.encode())

    def say(self, text: str) -> None:
        """Send a text."""
        self._send(1, text.encode())

    def _send(self, kind: int, data: bytes) -> None:
        mask = os.urandom(4)
        length = (
            struct.pack("!BBH", 0x80 | kind, 0xFE, len(data))
            if len(data) > 125
            else bytes([0x80 | kind, 0x80 | len(data)])
        )
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(data))
        self.socket.sendall(length + mask + masked)

    def read(self) -> None:
        """Read the data that have arrived."""
        now = time.perf_counter()
        data = self._buffer + self.socket.recv(1 << 20)
        place = 0
        while len(data) - place >= 2:
            size, start = data[place + 1], place + 2
            if size == 126:
                size, start = int.from_bytes(data[start : start + 2], "big"), start + 2
            elif size == 127:
                size, start = int.from_bytes(data[start : start + 8], "big"), start + 8
            if len(data) < start + size:
                break
            self._message(data[place] & 0x0F, data[start : start + size], now)
            place = start + size
        self._buffer = data[place:]

    def _message(self, kind: int, data: bytes, now: float) -> None:
        self.texts += kind == 1
        if kind == 2:
            self.times.append(now)
            self.bytes += len(data)
            if self._acts_at is not None:
                first, count = struct.unpack_from("<QI", data, 8)
                if first + count > self._acts_at:
                    self.effect, self._acts_at = now, None
        elif kind == 9:  # the server closes connections that do not answer pings
            self._send(10, data)
        elif kind == 1 and data.startswith(b'{"type":"ack"'):
            self._acts_at = int(data.partition(b'"row":')[2].partition(b",")[0])


class Watchers:
    """All connections, read as data arrive."""

    def __init__(self) -> None:
        self._selector = selectors.DefaultSelector()
        self._all: list[Watcher] = []

    def connect(self, port: int, path: str, token: str = "") -> Watcher:
        """Open a websocket to a local port and path, with a session's control token if given; return its watcher."""
        connection = socket.create_connection(("127.0.0.1", port))
        key = base64.b64encode(os.urandom(16)).decode()
        offered = f"Sec-WebSocket-Protocol: {SUBPROTOCOL}, {TOKEN}{token}\r\n" if token else ""
        connection.sendall(
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n{offered}\r\n".encode()
        )
        answer = b""
        while not answer.endswith(b"\r\n\r\n"):
            answer += connection.recv(1)
        assert b" 101 " in answer.splitlines()[0], answer
        connection.setblocking(False)
        watcher = Watcher(connection)
        self._selector.register(connection, selectors.EVENT_READ, watcher)
        self._all.append(watcher)
        return watcher

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
        """Read for a number of seconds, or until a condition holds."""
        end = time.perf_counter() + seconds
        while (left := end - time.perf_counter()) > 0 and not until():
            for key, _ in self._selector.select(left):
                key.data.read()

    def say(self, text: str) -> None:
        """Send a text on all connections."""
        for watcher in self._all:
            watcher.say(text)

    def close(self) -> None:
        """Close all connections."""
        for watcher in self._all:
            watcher.socket.close()
        self._selector.close()
