"""The router of several processes: what it is told, and that nothing of it is taken for the client's."""

import json
import shutil
import subprocess
import time
from contextlib import suppress
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socket import create_connection, socket
from threading import Thread

import pytest

from thetascope.api.processes.from_router import as_received, restored
from thetascope.api.processes.others import elsewhere
from thetascope.live.scheduling.session_ids import new_id, process_of
from thetascope.server.processes.router import RouterAbsent, caddyfile
from thetascope.server.processes.supervisor import serve_processes
from thetascope.settings import SettingsError, load

ROOT = Path(__file__).parents[2]
needs_caddy = pytest.mark.skipif(shutil.which("caddy") is None, reason="needs Caddy")


def test_ids_name_a_process_where_there_are_several():
    """An id of a single process names none, whatever its random part begins with; neither does one of no process."""
    assert process_of(new_id(None)) is None and process_of(new_id(7)) == 7
    assert process_of("p01-abcdefghijkl") is None and process_of("p01-" + "a" * 17) is None
    second = load({}, process=1, processes=3)
    ids = [f"p{number:02}-{'a' * 16}" for number in range(4)]
    assert [elsewhere(second, id) for id in ids] == [0, None, 2, None]
    assert elsewhere(load({}), ids[1]) is None


def test_a_request_is_as_it_came_to_the_router():
    """The client's headers, address and protocol are restored; what the router added is gone."""
    sent = {
        "host": "lab.example.org",
        "x-forwarded-for": "127.0.0.1",
        "x-forwarded-proto": "http",
        "via": "1.1 Caddy",
        "x-router-x-forwarded-for": "192.0.2.1",
        "x-router-via": "",
        "x-router-client": "[::1]:4711",
        "x-router-protocol": "HTTP/1.0",
    }
    headers = [(name.encode(), value.encode()) for name, value in sent.items()]
    scope = restored({"type": "http", "headers": headers, "client": None, "http_version": "1.1"})
    assert scope["headers"] == [(b"host", b"lab.example.org"), (b"x-forwarded-for", b"192.0.2.1")]
    assert scope["client"] == ("::1", 4711) and scope["http_version"] == "1.0"
    assert as_received(scope) == headers and as_received({"headers": headers}) == headers


def test_what_cannot_be_served_is_refused_before_it_begins(monkeypatch):
    """No router, or more processes than ids can name: the reason and the way out."""
    for processes in (0, 65):
        with pytest.raises(SettingsError, match=f"{processes} processes"):
            serve_processes(load({}, processes=processes), "en", lambda started: None)
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(RouterAbsent, match="apt install caddy"):
        serve_processes(load({}, processes=2), "en", lambda started: None)


@needs_caddy
@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0", "::", "localhost"])
def test_the_configuration_is_valid_for_any_address(tmp_path, host):
    """Caddy says so."""
    file = tmp_path / "Caddyfile"
    file.write_text(caddyfile(host, 8000, str(tmp_path), 3))
    command = ["caddy", "validate", "--adapter", "caddyfile", "--config", str(file)]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr


class _Named(BaseHTTPRequestHandler):
    """Answers with the port of its server."""

    def do_GET(self) -> None:
        body = json.dumps(self.server.server_address[1]).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_POST = do_GET

    def log_message(self, format: str, *args: object) -> None:
        """Write nothing."""


def two_servers() -> list[ThreadingHTTPServer]:
    """Return servers on two free ports that processes of a container could have."""
    servers: list[ThreadingHTTPServer] = []
    for port in range(8063, 8009, -1):
        with suppress(OSError):
            servers.append(ThreadingHTTPServer(("127.0.0.1", port), _Named))
        if len(servers) == 2:
            return servers
    pytest.skip("no two ports are free")


@needs_caddy
def test_the_router_of_the_container_leads_sessions_to_their_process(tmp_path, monkeypatch):
    """deploy/Caddyfile: by the id, also one that is encoded; everything else to the first process, new ones to any."""
    servers = two_servers()
    first, second = (server.server_address[1] for server in servers)
    for server in servers:
        Thread(target=server.serve_forever, daemon=True).start()
    with socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    monkeypatch.setenv("THETASCOPE_SITE", f"http://127.0.0.1:{port}")
    monkeypatch.setenv("THETASCOPE_UPSTREAM", f"127.0.0.1:{first}")
    monkeypatch.setenv("THETASCOPE_UPSTREAMS", f"127.0.0.1:{first} 127.0.0.1:{second}")
    monkeypatch.setenv("THETASCOPE_UPSTREAM_HOST", "127.0.0.1")
    for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, str(tmp_path))
    text = (ROOT / "deploy/Caddyfile").read_text().replace("{\n", "{\n\tadmin off\n", 1)
    (tmp_path / "Caddyfile").write_text(text)
    command = ["caddy", "run", "--adapter", "caddyfile", "--config", str(tmp_path / "Caddyfile")]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as router:
        try:
            for _ in range(600):
                try:
                    create_connection(("127.0.0.1", port)).close()
                    break
                except OSError:
                    time.sleep(0.05)

            def asked(path: str, method: str = "GET") -> int:
                connection = HTTPConnection("127.0.0.1", port, timeout=60)
                connection.request(method, path, headers={"Content-Length": "0"})
                return json.loads(connection.getresponse().read())

            number = f"{second - 8000}-" + "a" * 16
            session = f"/api/sessions/p{number}"
            assert {asked(f"{session}{part}") for part in ("", "/stream", "/data?every=2", "/fork")} == {second}
            assert asked(f"/api/sessions/%70{number}") == second
            assert asked(f"{session}/save", "POST") == asked("/api/runs") == asked("/") == first
            assert asked("/api/sessions/p4-" + "a" * 16) == first
            assert {asked("/api/sessions", "POST") for _ in range(4)} == {first, second}
        finally:
            router.terminate()
            for server in servers:
                server.shutdown()
                server.server_close()
