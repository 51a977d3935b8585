"""Live sessions in several processes, as users run them: `thetascope serve --processes 2` with Caddy in front."""

import os
import shutil
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed

from tests.api.classes import send, student, teacher
from tests.api.classes import until as received
from tests.api.conftest import Started, process, until
from tests.api.streams import FAULT, Page, closed, delete, opened, watching
from tests.api.test_api_classroom import binary
from thetascope.client import Client, ServiceError
from thetascope_schemas.service.session import CLOSE_NO_SESSION

pytestmark = pytest.mark.skipif(
    shutil.which("caddy") is None or sys.platform != "linux", reason="needs Caddy, and /proc to find processes"
)

PREFIXES = ("p00-", "p01-")


@pytest.fixture(scope="module")
def spread(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Started]:
    """Yield the supervisor and the address of the router. The last test ends them."""
    with process(tmp_path_factory.mktemp("spread"), processes=2, wait=60) as started:
        yield started


@pytest.fixture
def client(spread) -> Iterator[Client]:
    with Client(spread[1], timeout=120) as made:
        yield made


def environment_of(pid: int) -> dict[str, str]:
    """Return the environment with which a process was started."""
    try:
        data = Path(f"/proc/{pid}/environ").read_bytes()
    except OSError:  # it ended
        return {}
    return dict(pair.decode().split("=", 1) for pair in data.split(b"\0") if b"=" in pair)


def parent_of(pid: int) -> int:
    """Return the parent of a process; 0 for one that ended."""
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return 0


def children(pid: int) -> list[int]:
    """Return the processes that a process has started."""
    return [child for child in map(int, filter(str.isdigit, os.listdir("/proc"))) if parent_of(child) == pid]


def worker(supervisor: int, number: int) -> int | None:
    """Return the process with a number."""
    found = [p for p in children(supervisor) if environment_of(p).get("THETASCOPE_PROCESS") == str(number)]
    return found[0] if found else None


@contextmanager
def one_in_each(client: Client, address: str) -> Iterator[list]:
    """Open a session in each process and yield both with a page that watches it; end them afterwards."""
    with ExitStack() as stack:
        pairs: dict[str, tuple[dict, Page]] = {}
        while len(pairs) < len(PREFIXES):
            session = opened(client, speed=2)
            stack.callback(delete, client, session, session["token"])
            if (prefix := session["id"][:4]) not in pairs:
                page = stack.enter_context(watching(address, session))
                pairs[prefix] = session, page
                page.until(lambda page=page: page.end > 0)  # it counts as a connection: the next one goes elsewhere
        yield [pairs[prefix] for prefix in PREFIXES]


def test_sessions_play_obey_and_are_saved_wherever_they_live(spread, client):
    """Both processes get one; commands work, a fork stays, and a saved one has the numbers that were shown."""
    with one_in_each(client, spread[1]) as pairs:
        saved = set()
        for session, page in pairs:
            page.until(lambda page=page: page.end > 20)
            assert page.say("inject", fault=FAULT)["type"] == "ack"
            page.until(lambda page=page: page.end > 60)
            page.say("pause")
            fork = client.post(session["links"]["fork"])
            assert fork["id"][:4] == session["id"][:4] and fork["parent"] == session["id"]
            assert delete(client, fork, "wrong") == 403 and delete(client, fork, fork["token"]) == 204
            row = client.get(session["links"]["self"])["row"]
            page.until(lambda page=page, row=row: page.end == row)
            with pytest.raises(ServiceError) as refused:
                client.post(session["links"]["save"], headers={"X-Control-Token": "wrong"})
            assert refused.value.status == 403
            run = client.post(session["links"]["save"], headers={"X-Control-Token": session["token"]})
            saved.add(run["id"])
            data, rows, columns = client.data(run["id"]), page.rows(), page.of("hello")[0]["columns"]
            assert all(data[name].astype("<f4").tobytes() == rows[i].tobytes() for i, name in enumerate(columns))
        assert {run["id"] for run in client.get("/api/runs")["runs"]} == saved
        for number in range(2):
            status, text = send(spread[1], "GET", f"/metrics?process={number}")
            assert status == 200 and "\nthetascope_sessions " in text and "\nthetascope_sessions 0.0\n" not in text


def test_a_class_follows_a_session_of_another_process(spread, client):
    """Rooms live in process 0; phones get the rows of a session of process 1, also after a rewind."""
    with one_in_each(client, spread[1]) as ((_, _), (session, page)):
        room = teacher(spread[1])
        ada = student(spread[1], room.code)
        room.got("POST", "/room/rounds", {"kind": "follow"})
        strip = {"symbol": "y", "lines": [{"column": "y.y"}]}
        for _ in range(2):  # as when a lesson goes on
            room.got("POST", "/room/lead", {"session": session["id"], "strip": strip})
        with ada.stream("/seat/curves") as phone:
            received(phone, lambda message: message["strip"])
            frames = binary(phone, 1)
            while (end := frames[-1].end) < 20:
                frames += binary(phone, 1)
            page.until(lambda: page.end > end)
            page.say("seek", t=0.1)
            again = received(phone, lambda message: message["strip"] and message["epoch"] > frames[0].epoch)
            assert binary(phone, 1)[0].first == again["row"]
        known = {frame.first + i: y for frame in frames for i, y in enumerate(frame.samples[0])}
        table = client.get(f"{session['links']['data']}?columns=y.y")["columns"]["y.y"]
        assert all(known[row] == np.float32(table[row]) for row in range(10) if row in known)  # older ones are dropped
        room.ask("DELETE", "/room")


def test_the_router_is_no_proxy_for_the_gate(spread):
    """Who comes through a proxy needs the key, as without a router; headers of the router cannot be forged."""

    def status(version: int = 11, **headers: str) -> int:
        connection = HTTPConnection(urlsplit(spread[1]).netloc, timeout=60)
        connection._http_vsn, connection._http_vsn_str = version, f"HTTP/{version // 10}.{version % 10}"
        connection.request("GET", "/api/plants", headers={k.replace("_", "-"): v for k, v in headers.items()})
        return connection.getresponse().status

    assert status() == 200
    assert (
        status(10, Host="localhost") == 401
        and status(Via="1.1 other") == 401
        and status(X_Forwarded_For="192.0.2.1") == 401
    )
    assert status(X_Forwarded_For="192.0.2.1", X_Router_X_Forwarded_For="", X_Router_Client="127.0.0.1:1") == 401
    assert status(Host="lab.example.org") == 421


def test_a_killed_process_takes_its_own_sessions_alone(spread, client):
    """The other's go on; its own are unknown afterwards, with a close code that pages know, and new ones open there."""
    supervisor, address = spread
    with one_in_each(client, address) as ((kept, page), (lost, broken)):
        killed = worker(supervisor.pid, 1)
        os.kill(killed, signal.SIGKILL)
        with pytest.raises(ConnectionClosed):
            broken.until(lambda: False, 60)
        seen = page.end
        page.until(lambda: page.end > seen + 20)
        assert page.say("pause")["type"] == "ack" and client.get(kept["links"]["self"])["playing"] is False
        until(lambda: worker(supervisor.pid, 1) not in (None, killed))
        until(lambda: send(address, "GET", lost["links"]["self"])[0] == 404)
        with watching(address, lost) as late:
            assert closed(late) == CLOSE_NO_SESSION
        until(lambda: opened(client)["id"].startswith("p01-"))


def test_sigterm_ends_everything(spread, client):
    """All processes and the router are gone when the supervisor has ended, which is a success."""
    supervisor, address = spread
    with watching(address, opened(client)) as page:
        page.until(lambda: page.end > 0)
        everything = [p for child in children(supervisor.pid) for p in (child, *children(child))]
        assert len(everything) >= 3
        supervisor.terminate()
        assert supervisor.wait(60) == 0
    until(lambda: not any(Path(f"/proc/{p}").exists() for p in everything))
