"""A service that other machines can reach: nothing without the access key, and the key in no address."""

import json
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPResponse
from itertools import count
from pathlib import Path
from select import select
from urllib.parse import parse_qs, urlencode, urlsplit

import pytest
from websockets.exceptions import ConnectionClosed

from tests.api.conftest import process, service
from tests.api.streams import closed, opened, watching
from thetascope.access import tickets
from thetascope.access.gate import FILE, cookie_name
from thetascope.access.key_file import KeyFile
from thetascope.api.http.openapi import SCHEMES
from thetascope.client import Client, ServiceError
from thetascope.server.app import create_app
from thetascope.settings import Settings
from thetascope_schemas.service.session import CLOSE_SIGN_IN

HTML = {"Accept": "text/html,*/*"}


ADDRESSES = (f"10.{n // 65536 % 256}.{n // 256 % 256}.{n % 256}" for n in count(1))
"""Addresses of clients, a new one for each request: the server believes a proxy on its machine, and wrong keys are
slowed down by address."""


@dataclass
class Shared:
    """A service bound to all addresses, its access key and its data folder."""

    address: str
    key: str
    data: Path

    def get(self, path: str, headers: dict | None = None, method: str = "GET", body: str | None = None) -> HTTPResponse:
        return ask(self.address, path, {"X-Forwarded-For": next(ADDRESSES)} | (headers or {}), method, body)

    def cookie(self) -> str:
        """Return the header value of a browser that signed in by the link."""
        return self.get(f"/?key={self.key}").getheader("set-cookie").partition(";")[0]


def ask(
    address: str, path: str, headers: dict[str, str] | None = None, method: str = "GET", body: str | None = None
) -> HTTPResponse:
    """Return the answer to a request, its body read into `content`."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=60)
    connection.request(method, path, body, headers or {})
    answer = connection.getresponse()
    answer.content = answer.read()
    connection.close()
    return answer


@pytest.fixture(scope="module")
def shared(tmp_path_factory) -> Iterator[Shared]:
    """A service as `THETASCOPE_HOST=0.0.0.0 thetascope serve` starts it for the first time."""
    data = tmp_path_factory.mktemp("shared")
    with process(data, host="0.0.0.0") as (started, address):
        key = started.stdout.readline().rpartition(" ")[2].strip()
        link = urlsplit(started.stdout.readline().rpartition(" ")[2].strip())
        assert parse_qs(link.query) == {"key": [key]} and link.port == urlsplit(address).port
        yield Shared(address, key, data)


def test_every_address_is_closed_without_the_key(shared):
    """Every route of the interface, the page, its files, and addresses that do not exist; only health/live answers, and
    the seats of classrooms, which ask for the student's own token."""
    paths = create_app(Settings(data=shared.data)).openapi()["paths"]
    routes = {(path.replace("{", "").replace("}", ""), method.upper()) for path in paths for method in paths[path]}
    routes |= {
        (path, "GET") for path in ("/docs", "/redoc", "/openapi.json", "/assets/plotly.min.js", "/assets/docs.js")
    }
    files = {(path, "GET") for path in ("/", "/runs/", "/workshop/", "/icon.svg", "/common/api.js", "/no-file")}
    strange = {(path, "GET") for path in ("//api/runs", "/api/../api/runs", "/api/health/live/", "/%61pi/runs", "/API")}
    assert len(routes) > 30
    passed = {
        (path, method)
        for path, method in routes | files | strange
        if shared.get(path, method=method).status != 401 and (path, method) != ("/api/health/live", "GET")
    }
    assert passed == {
        ("/api/messages/language", "GET"),
        ("/api/classroom/join", "POST"),
        *(("/api/classroom/seat", method) for method in ("GET", "DELETE")),
        *((f"/api/classroom/seat/{part}", "PUT") for part in ("name", "vote", "answer")),
        ("/api/classroom/lti/seat", "POST"),
        ("/api/classroom/lti/keys", "GET"),
    }
    seats = {shared.get(path, method=method).status for path, method in passed if "classroom" in path}
    assert seats <= {404, 415}
    live = shared.get("/api/health/live")
    assert (live.status, live.content) == (200, b'{"status":"alive"}')


@pytest.mark.parametrize(
    "headers",
    [
        {"X-Access-Key": "wrong"},
        {"Authorization": "Bearer wrong"},
        {"Authorization": "Basic d3Jvbmc6d3Jvbmc="},
        {"Authorization": "Bearer"},
        {"X-Client": "machine"},
        {"Cookie": "thetascope=1"},
        {"Host": "localhost"},
        {"X-Forwarded-For": "127.0.0.1", "Host": "127.0.0.1"},
        {"X-Real-IP": "127.0.0.1", "Forwarded": "for=127.0.0.1"},
        {"X-Access-Key": "x" * 10_000},
        {"X-Access-Key": "Schlüssel"},
    ],
)
def test_nothing_else_opens(shared, headers):
    """A wrong key, another scheme, a claimed name, host or address."""
    answer = shared.get("/api/runs", {name: value.encode("latin-1") for name, value in headers.items()})
    problem = json.loads(answer.content)
    assert answer.status in (401, 429) and problem["code"].startswith("access.") and ";" in problem["detail"]
    assert answer.status == 429 or answer.getheader("www-authenticate").startswith("Bearer ")


@pytest.mark.parametrize(
    "header", [{"Authorization": "Bearer {}"}, {"authorization": "bearer {}"}, {"X-Access-Key": "{}"}]
)
def test_a_script_sends_the_key_in_a_header(shared, header):
    """Both headers open the interface."""
    ((name, form),) = header.items()
    assert shared.get("/api/runs", {name: form.format(shared.key)}).status == 200


def test_the_client_sends_the_key(shared):
    """As an argument, or in the link that signs in; without it the problem says what is missing."""
    for client in (Client(shared.address, key=shared.key), Client(f"{shared.address}/?key={shared.key}")):
        with client:
            assert client.health()["status"] == "ok"
    with Client(shared.address) as client, pytest.raises(ServiceError, match="asks for its access key") as refusal:
        client.health()
    assert refusal.value.status == 401


def test_the_link_leaves_the_key_in_no_address(shared):
    """It sets a cookie that scripts cannot read, and leads to the same address without the key."""
    answer = shared.get(f"/runs/?experiment=zhao-2012&key={shared.key}&set=a%3D1", HTML)
    assert (answer.status, answer.getheader("location")) == (303, "/runs/?experiment=zhao-2012&set=a%3D1")
    assert answer.getheader("referrer-policy") == "no-referrer" and answer.getheader("cache-control") == "no-store"
    value, *attributes = answer.getheader("set-cookie").split("; ")
    assert {"httponly", "samesite=lax", "path=/"} <= {text.lower() for text in attributes}
    assert shared.key not in str(answer.headers) and "Secure" not in attributes
    page = shared.get("/", {"Cookie": value} | HTML)
    assert page.status == 200 and shared.key.encode() not in page.content
    tls = shared.get(f"/?key={shared.key}", {"X-Forwarded-Proto": "https"})
    assert "Secure" in tls.getheader("set-cookie").split("; ")


def test_a_wrong_link_leads_to_the_sign_in_page(shared):
    """Its key is not repeated, and the page says that the link is wrong."""
    answer = shared.get("/plants/?a=b&key=wrong", HTML)
    goal = answer.getheader("location")
    assert answer.status == 303 and answer.getheader("set-cookie") is None
    assert parse_qs(urlsplit(goal).query)["next"] == ["/plants/?a=b"] and "key=" not in goal
    page = shared.get(goal, HTML)
    assert b"key in the link is not correct" in page.content and "no-referrer" not in page.getheader("referrer-policy")


def test_the_interface_takes_no_key_from_an_address(shared):
    """Addresses are written into logs."""
    answer = shared.get(f"/api/runs?key={shared.key}")
    assert answer.status == 401 and answer.getheader("set-cookie") is None


@pytest.mark.parametrize(
    ("goal", "reached"),
    [
        ("/runs/?run=1#x", "/runs/?run=1#x"),
        *((goal, "/") for goal in ("//evil.example", "https://evil.example", "/\\evil.example", "javascript:alert(1)")),
        *((goal, "/") for goal in ("", "evil", "/\r\nSet-Cookie: a=b", "/\tx", "\\\\evil.example", "/é")),
    ],
)
def test_the_form_signs_in_and_leads_to_this_service_only(shared, goal, reached):
    """The form works without scripts; the address to go to cannot lead to another site."""
    page = f"/sign-in?{urlencode({'next': goal})}"
    form = urlencode({"key": f" {shared.key} "})
    answer = shared.get(page, HTML | {"Content-Type": "application/x-www-form-urlencoded"}, "POST", form)
    assert (answer.status, answer.getheader("location")) == (303, reached)
    cookie = answer.getheader("set-cookie").partition(";")[0]
    assert shared.get("/api/runs", {"Cookie": cookie}).status == 200


def test_the_form_of_another_site_is_refused(shared):
    """Nobody is signed in by a foreign page; the sign-in page itself sends its origin."""
    form = urlencode({"key": shared.key})
    foreign = shared.get("/sign-in", {"Origin": "https://evil.example"}, "POST", form)
    assert foreign.status == 403 and foreign.getheader("set-cookie") is None
    assert shared.get("/sign-in", {"Origin": shared.address}, "POST", form).status == 303
    assert shared.get("/sign-in", HTML).getheader("referrer-policy") == "same-origin"


@pytest.mark.parametrize("body", ["", "key=", "key=wrong", "key=%ff", "other=1", "key=" + "x" * 5000, '{"key": 1}'])
def test_a_wrong_form_shows_the_page_again(shared, body):
    """With the reason, without the key, and without a cookie; never an error of the program."""
    answer = shared.get("/sign-in?next=/runs/", HTML, "POST", body)
    assert answer.status in (401, 429) and answer.getheader("set-cookie") is None
    assert b'role="alert"' in answer.content and b"wrong" not in answer.content


def test_a_document_leads_to_the_sign_in_page_and_back(shared):
    """Pages do; files and the interface are refused plainly. Signed in, the page leads on."""
    answer = shared.get("/runs/?run=1", HTML)
    assert (answer.status, answer.getheader("location")) == (303, "/sign-in?next=%2Fruns%2F%3Frun%3D1")
    assert shared.get("/common/api.js").status == shared.get("/api/runs", HTML).status == 401
    again = shared.get("/sign-in?next=/runs/", HTML | {"Cookie": shared.cookie()})
    assert (again.status, again.getheader("location")) == (303, "/runs/")
    chinese = shared.get("/sign-in", HTML | {"Accept-Language": "zh-CN"})
    assert "访问密钥" in chinese.content.decode() and chinese.getheader("content-language") == "zh"
    assert "script" not in chinese.content.decode() and "default-src 'none'" in chinese.getheader(
        "content-security-policy"
    )


def test_signing_out_takes_the_cookie(shared):
    """The answer makes the browser drop it."""
    answer = shared.get("/sign-out", {"Cookie": shared.cookie()}, "POST")
    assert answer.status == 303 and "Max-Age=0" in answer.getheader("set-cookie")


def test_forged_and_ended_cookies_are_refused(shared):
    """An ended one is named as such; one that was made with another secret is nothing."""
    keys = KeyFile(shared.data / FILE).current()
    name, ended = cookie_name(keys), tickets.issue(keys, now=time.time() - tickets.LASTS - 60)
    answer = shared.get("/api/runs", {"Cookie": f"{name}={ended}"})
    assert answer.status == 401 and json.loads(answer.content)["code"] == "access.ended"
    good = shared.cookie()
    forged = good[:-1] + ("A" if good[-1] != "A" else "Q")
    id, _, rest = good.partition("=")[2].partition(".")
    later = f"{name}={id}.9{rest.partition('.')[0]}.{rest.partition('.')[2]}"
    for cookie in (forged, later, f"{name}={id}"):
        assert shared.get("/api/runs", {"Cookie": cookie}).status == 401
    assert shared.get("/api/runs", {"Cookie": f"a=b; {forged}; {good}"}).status in (200, 401)
    assert shared.get("/api/runs", {"Cookie": f"a=b; {good}; c=d"}).status == 200


def test_a_websocket_needs_the_cookie(shared):
    """Without it, or with the control token alone, it is closed with a code of its own."""
    with Client(shared.address, key=shared.key) as client:
        session = opened(client)
    for headers in ({}, {"Cookie": "thetascope=1"}, {"X-Access-Key": "wrong", "X-Forwarded-For": next(ADDRESSES)}):
        with watching(shared.address, session, additional_headers=headers) as page:
            assert closed(page) == CLOSE_SIGN_IN
    for headers in ({"Cookie": shared.cookie()}, {"X-Access-Key": shared.key}):
        with watching(shared.address, session, additional_headers=headers) as page:
            assert page.receive()["type"] == "hello"


def test_wrong_keys_are_slowed_down_and_lock_nobody_out(shared):
    """While many wrong ones wait for their answers, further ones are refused, and the right one is accepted."""
    here = {"X-Forwarded-For": next(ADDRESSES)}
    waiting = [HTTPConnection(urlsplit(shared.address).netloc, timeout=60) for _ in range(20)]
    for connection in waiting:
        connection.request("GET", "/api/runs", headers=here | {"X-Access-Key": "guess"})
    left, answers = list(waiting), []
    while not any(answer.status == 429 for answer in answers):
        ready = select([connection.sock for connection in left], [], [], 60)[0]
        answered = [connection for connection in left if connection.sock in ready]
        left = [connection for connection in left if connection not in answered]
        answers += [connection.getresponse() for connection in answered]
    assert all(int(answer.getheader("retry-after")) >= 1 for answer in answers if answer.status == 429)
    assert shared.get("/api/runs", here | {"X-Access-Key": shared.key}).status == 200
    assert shared.get(f"/?key={shared.key}", here).getheader("set-cookie")
    assert shared.get("/api/runs", here | {"Cookie": shared.cookie()}).status == 200
    assert shared.get("/api/runs", {"X-Access-Key": "guess"}).status == 401
    for connection in waiting:
        connection.close()


def test_another_key_signs_everybody_out(tmp_path):
    """`thetascope key --new` beside the running service: cookie, header and open websocket end; the new key opens."""
    with process(tmp_path, host="0.0.0.0") as (started, address):
        shared = Shared(address, started.stdout.readline().rpartition(" ")[2].strip(), tmp_path)
        cookie = {"Cookie": shared.cookie()}
        with Client(address, key=shared.key) as client:
            session = opened(client)
        with watching(address, session, additional_headers=cookie) as page:
            assert page.receive()["type"] == "hello"
            new = KeyFile(tmp_path / FILE).renew()
            assert shared.get("/api/runs", cookie).status == 401
            assert shared.get("/api/runs", {"X-Access-Key": shared.key}).status == 401
            with pytest.raises(ConnectionClosed) as end:
                while True:
                    page.receive()
            assert end.value.rcvd.code == CLOSE_SIGN_IN
        assert shared.get("/api/runs", {"X-Access-Key": new}).status == 200


def test_a_proxy_in_front_of_loopback_needs_the_key_and_a_local_program_does_not(tmp_path):
    """Names of the setting make the service expect others, so the key is created at the start."""
    with process(tmp_path, hosts="lab.example.org") as (started, address):
        key = started.stdout.readline().rpartition(" ")[2].strip()
        assert ask(address, "/api/runs").status == 200
        for headers in ({"Host": "lab.example.org"}, {"X-Forwarded-For": "10.0.0.1"}, {"Via": "1.1 proxy"}):
            assert ask(address, "/api/runs", headers).status == 401
            assert ask(address, "/api/runs", headers | {"X-Access-Key": key}).status == 200
        with socket.create_connection(("127.0.0.1", urlsplit(address).port), timeout=60) as connection:
            connection.sendall(b"GET /api/runs HTTP/1.0\r\nHost: 127.0.0.1\r\n\r\n")
            assert connection.recv(1000).split()[1] == b"401"


def test_open_asks_nobody_and_warns(tmp_path):
    """THETASCOPE_OPEN=1 on all addresses: as before there was a key, with a warning at the start."""
    with service(tmp_path, host="0.0.0.0", open=1) as address:
        assert ask(address, "/api/runs").status == ask(address, "/", HTML).status == 200
        left = ask(address, "/?key=old&a=b", HTML)
        assert (left.status, left.getheader("location")) == (303, "/?a=b")
    assert not (tmp_path / FILE).exists()


def test_the_interface_documents_its_keys(client):
    """The schemes are in the OpenAPI document, `{}` for a service that asks for none."""
    document = client.get("/openapi.json")
    assert document["components"]["securitySchemes"].keys() == SCHEMES.keys()
    assert document["security"] == [{}, {"bearer": []}, {"key": []}, {"browser": []}]
    assert document["paths"]["/api/health/live"]["get"]["security"] == []
