"""Requests under other names and from pages of other sites."""

import json
import socket
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest
from starlette.datastructures import Headers

from tests.api.conftest import service
from tests.api.streams import closed, opened, watching
from thetascope.api.http.hosts import AllowedHosts
from thetascope.client import ServiceError
from thetascope.server.app import create_app
from thetascope.settings import Settings
from thetascope_schemas.service.session import CLOSE_ORIGIN


def status(address: str, method: str, path: str, host: str | None = None, **headers: str) -> tuple[int, dict]:
    """Return the status and the JSON of an answer to a request with these headers and without a body."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, path, headers={**headers, **({} if host is None else {"Host": host})})
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, json.loads(content) if content.startswith(b"{") else {}


@pytest.mark.parametrize("path", ["/", "/api/health", "/api/runs", "/runs/"])
def test_a_name_that_was_rebound_to_this_machine_is_refused(address, path):
    """A page of another host name that resolves to 127.0.0.1 reads nothing; the refusal names the setting."""
    code, problem = status(address, "GET", path, host="evil.example")
    assert code == 421 and "evil.example" in problem["detail"] and "THETASCOPE_HOSTS" in problem["detail"]


@pytest.mark.parametrize("action", ["fork", "save"])
def test_bodyless_changes_are_checked_like_others(client, address, action):
    """A form of another site can send a POST without a body and without a preflight."""
    path = opened(client)["links"][action]
    own = address
    for origin in ("https://evil.example", "null", "http://127.0.0.1:1", f"{own}.evil.example"):
        assert status(address, "POST", path, Origin=origin)[0] == 403, origin
    assert status(address, "POST", path, Sec_Fetch_Site="same-site")[0] == 403
    assert status(address, "POST", path, Origin=own)[0] == (201 if action == "fork" else 403)


def test_only_the_token_saves_a_session(client):
    """A viewer, who knows the address without the token, cannot store a run."""
    session = opened(client, t=1)
    for headers in ({}, {"X-Control-Token": "guess"}):
        with pytest.raises(ServiceError) as refusal:
            client.post(session["links"]["save"], headers=headers)
        assert refusal.value.status == 403
    assert client.post(session["links"]["save"], headers={"X-Control-Token": session["token"]})["id"]


def test_a_websocket_under_another_name_is_closed(client, address):
    """Host and Origin agree after a rebinding, so the name itself is checked."""
    session = opened(client)
    port = urlsplit(address).port
    rebound = f"http://evil.example:{port}"
    sock = socket.create_connection(("127.0.0.1", port))
    with watching(rebound, session, sock=sock, origin=rebound) as page:
        assert closed(page) == CLOSE_ORIGIN


def test_names_of_the_setting_are_accepted(tmp_path):
    """The service answers under them, also from a page behind a proxy that replaces the host."""
    with service(tmp_path, hosts="lab.example.org, *.school.example", open=1) as address:
        for host in ("lab.example.org", "LAB.example.org:8000", "room7.school.example"):
            assert status(address, "GET", "/api/health", host=host)[0] == 200
        assert status(address, "GET", "/api/health", host="example.org")[0] == 421
        path = "/api/runs/none"
        assert status(address, "DELETE", path, Origin="https://lab.example.org")[0] == 404
        assert status(address, "DELETE", path, Origin="https://school.example")[0] == 403


@pytest.mark.parametrize(
    ("host", "allowed"),
    [
        *((host, True) for host in ("localhost", "localhost:8000", "127.0.0.1", "127.3.2.1:80", "[::1]:8000", "::1")),
        *((host, True) for host in ("LOCALHOST.", "room.localhost", "192.168.1.20:8000", "[fe80::1]")),
        *((host, False) for host in ("", " ", "evil.example", "127.0.0.1.evil.example", "localhost.evil.example")),
        *((host, False) for host in ("127.0.0.1@evil.example", "notlocalhost", "1.2.3", "[evil]", "localhost:port")),
    ],
)
def test_loopback_names_and_numbers_are_allowed(host, allowed):
    """Without a setting only names that no name server can change are accepted."""
    assert AllowedHosts().allows(host) is (allowed and host != "::1")


def test_a_service_answers_to_the_name_on_which_it_listens(tmp_path):
    """`thetascope serve --host lab-pc` prints the address http://lab-pc:8000/, which has to work."""
    hosts = create_app(Settings(data=tmp_path, host="lab-pc")).state.hosts
    assert hosts.allows("lab-pc:8000") and not hosts.allows("evil.example")


def test_clients_that_are_no_browsers_send_no_origin():
    """They may change something; a browser says from where the request comes."""
    hosts = AllowedHosts()
    assert hosts.may_change(Headers({"host": "localhost"}))
    assert hosts.may_change(Headers({"host": "localhost:8000", "origin": "https://localhost:8000"}))
    for origin in ("null", "", "http://[", "http://localhost:8001", "file://", "http://localhost:8000@evil.example"):
        assert not hosts.may_change(Headers({"host": "localhost:8000", "origin": origin})), origin
