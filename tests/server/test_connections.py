"""Clients that keep a service waiting, or that are too many: connections are closed, others are answered."""

import asyncio
import logging
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
import uvicorn

from tests.api.conftest import process
from thetascope.server import connections
from thetascope.server.connections import Notes, allowed, protocol

ANSWER = b"x" * 50_000_000
HEAD = b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 1000\r\n\r\n"


async def application(scope, receive, send) -> None:
    """Read the body of a request, and answer with many bytes where the address is /much."""
    if scope["path"] == "/refused":
        await send({"type": "http.response.start", "status": 413, "headers": [(b"connection", b"close")]})
        await send({"type": "http.response.body", "body": b"too large"})
        return
    while (await receive()).get("more_body"):
        pass
    if scope["path"] == "/wait":
        await receive()
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": ANSWER if scope["path"] == "/much" else b"yes"})


class Service:
    """A server of `application` in a thread, with short limits."""

    def __init__(self, limit: int) -> None:
        import threading

        config = uvicorn.Config(application, port=0, log_config=None, lifespan="off", http=protocol(limit, Notes()))
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run)
        self._thread.start()
        _until(lambda: self._server.started)
        self.port = self._server.servers[0].sockets[0].getsockname()[1]

    def connect(self, data: bytes = b"") -> socket.socket:
        """Return a connection on which some bytes were sent."""
        made = socket.create_connection(("127.0.0.1", self.port), timeout=60)
        made.sendall(data)
        return made

    @property
    def waiting(self) -> int:
        """How many requests are being answered."""
        return len(self._server.server_state.tasks)

    def close(self) -> None:
        self._server.should_exit = True
        self._thread.join(60)


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Service]]:
    monkeypatch.setattr(connections, "_LOOK", 0.05)
    running: list[Service] = []

    def begin(limit: int = 50, **seconds: float) -> Service:
        for name, value in seconds.items():
            monkeypatch.setattr(connections, name.upper(), value)
        running.append(Service(limit))
        return running[-1]

    yield begin
    for service in running:
        service.close()


def closed(one: socket.socket) -> bool:
    """Return True when the other side has closed a connection."""
    with suppress(ConnectionResetError):
        while one.recv(1000):
            pass
    return True


@pytest.mark.parametrize(
    "sent",
    [b"", b"GET / HTTP/1.1\r\nHost:", b"GET / HTTP/1.1\r\nHost: a\r\n\r\nGET /again", HEAD, HEAD + b"x" * 999],
    ids=["nothing", "half a head", "half a second head", "no body", "nearly a body"],
)
def test_a_client_that_does_not_finish_its_request_is_cut_off(start, sent: bytes):
    """Whatever part of a request it has sent."""
    service = start(head_seconds=0.3, body_seconds=0.3)
    one = service.connect(sent)
    if b"again" in sent:
        assert one.recv(1000).startswith(b"HTTP/1.1 200")
    assert closed(one)
    other = service.connect(b"GET / HTTP/1.1\r\nHost: a\r\n\r\n")
    assert other.recv(1000).startswith(b"HTTP/1.1 200")


def test_a_drip_of_bytes_does_not_keep_a_body_open(start):
    """A byte now and then is below the least rate; a body that arrives at that rate is read to its end."""
    service = start(body_seconds=0.3, body_rate=10)
    slow = service.connect(HEAD)
    with pytest.raises((ConnectionError, BrokenPipeError)):
        for _ in range(400):
            time.sleep(0.15)
            slow.sendall(b"x")
    fast = service.connect(HEAD)
    for _ in range(10):
        fast.sendall(b"x" * 100)
        time.sleep(0.1)
    assert fast.recv(1000).startswith(b"HTTP/1.1 200")


def test_a_client_that_does_not_read_its_answer_is_cut_off(start):
    """Its answer is not kept in memory for ever; one that reads slowly gets all of it."""
    service = start(answer_seconds=0.5)
    deaf, slow = (service.connect(b"GET /much HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n") for _ in range(2))
    received = 0
    while part := slow.recv(1_000_000):
        received += len(part)
    assert received > len(ANSWER)
    time.sleep(1.0)
    received = 0
    with suppress(ConnectionResetError):
        while part := deaf.recv(1_000_000):
            received += len(part)
    assert received < len(ANSWER)


def test_too_many_connections_are_refused_and_those_that_are_open_go_on(start, caplog):
    """503 for those beyond the limit, in one line of the log for all; when some have left, others may come."""
    service = start(limit=5)
    held = [service.connect(b"GET /wait HTTP/1.1\r\nHost: a\r\n\r\n") for _ in range(5)]
    _until(lambda: service.waiting == 5)
    with caplog.at_level(logging.WARNING):
        for _ in range(20):
            refused = service.connect()
            assert refused.recv(1000).startswith(b"HTTP/1.1 503") and closed(refused)
    assert [record.message for record in caplog.records] == ["Too many connections"]
    for one in held:
        one.close()

    def answered() -> bool:
        return service.connect(b"GET / HTTP/1.1\r\nHost: a\r\n\r\n").recv(1000).startswith(b"HTTP/1.1 200")

    _until(answered)


@pytest.mark.parametrize("sent", [b"", b"GET / HTTP/1.1\r\nHost:", HEAD], ids=["nothing", "half a head", "no body"])
def test_connections_that_wait_for_their_client_give_way(start, sent: bytes, monkeypatch):
    """A thousand of them, opened again and again, keep nobody out; whoever waits for an answer gets it."""
    monkeypatch.setattr(connections, "_PATIENCE", 0.0)
    service = start(limit=50)
    busy = service.connect(b"GET /wait HTTP/1.1\r\nHost: a\r\n\r\n")
    _until(lambda: service.waiting == 1)
    held = []
    for _ in range(6):
        held += [service.connect(sent) for _ in range(49)]
        one = service.connect(b"GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        assert one.recv(1000).startswith(b"HTTP/1.1 200")
    busy.setblocking(False)
    with pytest.raises(BlockingIOError):  # neither an answer nor its end
        busy.recv(1)
    for one in (busy, *held):
        one.close()


def test_a_client_reads_why_its_body_was_refused(start):
    """It sends all of it before it reads, as most do, and is not cut off meanwhile; without end it is."""
    service = start(limit=5, rest_seconds=0.5)
    one = service.connect(b"POST /refused HTTP/1.1\r\nHost: a\r\nContent-Length: 20000000\r\n\r\n")
    for _ in range(200):
        one.sendall(b"x" * 100_000)
    answer = b""
    while part := one.recv(1000):
        answer += part
    assert answer.startswith(b"HTTP/1.1 413") and b"too large" in answer
    endless = service.connect(b"POST /refused HTTP/1.1\r\nHost: a\r\nContent-Length: 20000000\r\n\r\n")
    with pytest.raises((ConnectionError, BrokenPipeError)):
        for _ in range(400):
            time.sleep(0.05)
            endless.sendall(b"x")


def test_equal_trouble_is_one_line_in_ten_seconds(caplog):
    """The next line says how many were left out; errors that are not of connections keep their traceback."""
    now = [0.0]
    notes = Notes(lambda: now[0])
    loop = asyncio.new_event_loop()
    connections.watch(loop, notes)
    with caplog.at_level(logging.WARNING):
        for second in (0.0, 1.0, 2.0, 11.0):
            now[0] = second
            loop.call_exception_handler({"message": "accept", "exception": OSError(24, "Too many open files")})
        loop.call_exception_handler({"message": "broken", "exception": ValueError("a real error")})
    loop.close()
    first, second, third = caplog.records
    assert (first.message, second.fields["more"], first.exc_info) == ("accept", 2, None)
    assert third.exc_info is not None


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")
def test_file_handles_limit_the_connections():
    """The limit is raised as far as it may; with a low one half of the handles are left to other things."""
    code = (
        "import resource as r; r.setrlimit(r.RLIMIT_NOFILE, ({0}, {1}));"
        "from thetascope.server.connections import allowed; print(allowed(2000), r.getrlimit(r.RLIMIT_NOFILE)[0])"
    )
    hard = min(allowed(10**6) + 256, 8192)
    for soft, most, expected in ((64, 64, "32 64"), (100, 1024, "768 1024"), (100, hard, f"2000 {hard}")):
        line = subprocess.check_output([sys.executable, "-c", code.format(soft, most)], text=True)
        assert line.strip() == expected


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")
def test_the_end_of_file_handles_does_not_fill_the_log(tmp_path: Path):
    """Many connections beyond the handles leave little in the log; the service answers when they have gone."""
    with (
        (tmp_path / "log").open("wb") as log,
        process(tmp_path / "data", log, connections=1000) as (started, address),
    ):
        import resource

        resource.prlimit(started.pid, resource.RLIMIT_NOFILE, (80, 80))
        port = int(address.rpartition(":")[2])
        held = []
        for _ in range(150):
            try:
                held.append(socket.create_connection(("127.0.0.1", port), timeout=0.2))
            except OSError:
                break
        time.sleep(2.5)
        for one in held:
            one.close()

        def answered() -> bool:
            try:
                with socket.create_connection(("127.0.0.1", port), timeout=5) as one:
                    one.sendall(b"GET /api/health/live HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
                    return one.recv(100).startswith(b"HTTP/1.1 200")
            except OSError:
                return False

        _until(answered)
        assert (tmp_path / "log").stat().st_size < 20_000


def _until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)
