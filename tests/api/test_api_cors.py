"""Pages of other sites: none may read anything, but for the origins that the setting lists."""

from base64 import urlsafe_b64encode
from collections.abc import Iterator

import pytest

from tests.api.conftest import service
from tests.api.streams import closed, opened, watching
from tests.api.test_api_access import ask
from thetascope.api.http.hosts import origins_of
from thetascope.client import Client
from thetascope.settings import SettingsError
from thetascope_schemas.service.session import CLOSE_ORIGIN, CLOSE_SIGN_IN, KEY

LISTED = "https://lab.example.org"
SETTING = f"{LISTED}, http://localhost:8888"
SECRET = "a-key-that-no-page-can-guess"
NEAR = (
    *(
        "https://evil.example",
        "null",
        "http://lab.example.org",
        "https://lab.example.org:8443",
        "https://x.lab.example.org",
    ),
    *(
        "https://lab.example.org.evil.example",
        "https://LAB.example.org",
        "http://localhost",
        "https://lab.example.org/",
    ),
)
"""Origins that are not listed, most of them close to one that is."""
ALLOWS = ("access-control-allow-origin", "access-control-allow-credentials", "access-control-allow-headers")


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a service that lists two origins and asks everybody for the key."""
    settings = {"origins": SETTING, "published": "0.0.0.0", "key": SECRET}
    with service(tmp_path_factory.mktemp("cors"), **settings) as started:
        yield started


def allowed(answer) -> dict[str, str]:
    """Return the headers of an answer that open it to other pages."""
    return {name: answer.getheader(name) for name in ALLOWS if answer.getheader(name) is not None}


@pytest.mark.parametrize("origin", [*NEAR, LISTED])
def test_without_the_setting_no_page_of_another_site_reads_anything(address, origin):
    """The default answers every origin without a header of CORS, preflights included."""
    wish = {"Origin": origin, "Access-Control-Request-Method": "POST"}
    assert not allowed(ask(address, "/api/health", {"Origin": origin}))
    assert not allowed(ask(address, "/api/runs", wish, "OPTIONS"))
    assert ask(address, "/api/runs/none/cancel", {"Origin": origin}, "POST").status == 403


@pytest.mark.parametrize("origin", NEAR)
def test_an_origin_that_is_not_listed_gets_no_header_even_with_the_key(shared, origin):
    """Origins are compared as a whole: scheme, name and port."""
    headers = {"Origin": origin, "X-Access-Key": SECRET}
    answer = ask(shared, "/api/health", headers)
    assert answer.status == 200 and not allowed(answer) and "Origin" in answer.getheader("vary")
    assert answer.getheader("cross-origin-resource-policy") == "same-origin"
    preflight = ask(shared, "/api/runs", headers | {"Access-Control-Request-Method": "POST"}, "OPTIONS")
    assert not allowed(preflight)
    assert ask(shared, "/api/runs/none/cancel", headers, "POST").status == 403


def test_a_listed_origin_reads_and_changes_with_the_key(shared):
    """A preflight is answered without the key, and names the methods and headers of the interface."""
    wish = {"Origin": LISTED, "Access-Control-Request-Method": "PUT", "Access-Control-Request-Headers": "x-access-key"}
    preflight = ask(shared, "/api/my-plants/tank", wish, "OPTIONS")
    assert preflight.status == 204 and preflight.getheader("access-control-allow-origin") == LISTED
    assert "PUT" in preflight.getheader("access-control-allow-methods")
    assert "X-Access-Key" in preflight.getheader("access-control-allow-headers")
    assert ask(shared, "/api/health", {"Origin": LISTED}).status == 401
    answer = ask(shared, "/api/health", {"Origin": LISTED, "X-Access-Key": SECRET})
    assert answer.status == 200 and allowed(answer) == {"access-control-allow-origin": LISTED}
    assert answer.getheader("cross-origin-resource-policy") == "cross-origin"
    headers = {"Origin": LISTED, "X-Access-Key": SECRET}
    assert ask(shared, "/api/runs/none/cancel", headers, "POST").status == 404


def test_a_cookie_does_not_help_a_page_of_another_site(shared):
    """Credentials of the browser are neither allowed nor looked at: only the key that the page itself sends counts."""
    cookie = ask(shared, f"/?key={SECRET}").getheader("set-cookie").partition(";")[0]
    assert ask(shared, "/api/health", {"Cookie": cookie}).status == 200
    for path, method in (("/api/health", "GET"), ("/api/runs/none/cancel", "POST")):
        answer = ask(shared, path, {"Origin": LISTED, "Cookie": cookie}, method)
        assert answer.status == 401 and answer.getheader("access-control-allow-credentials") is None


def test_websockets_follow_the_same_list(shared):
    """An unlisted origin is closed; a listed one needs the key, in a subprotocol since scripts can set no header."""
    with Client(shared, key=SECRET) as client:
        session = opened(client)
    secret = KEY + urlsafe_b64encode(SECRET.encode()).decode().rstrip("=")
    wrong = KEY + urlsafe_b64encode(b"a key that somebody guessed").decode().rstrip("=")
    for origin, protocol, code in (
        ("https://evil.example", secret, CLOSE_ORIGIN),
        (LISTED, None, CLOSE_SIGN_IN),
        (LISTED, wrong, CLOSE_SIGN_IN),
    ):
        with watching(shared, session, origin=origin, also=protocol) as page:
            assert closed(page) == code, (origin, protocol)
    with watching(shared, session, origin=LISTED, also=secret) as page:
        assert page.receive()["type"] == "hello"


@pytest.mark.parametrize(
    "setting", ["*", "null", "lab.example.org", "https://*.example.org", "https://a.org/path", "file://", "https://a b"]
)
def test_a_setting_that_is_not_an_exact_origin_is_refused(setting):
    """A list that admits more than its reader thinks would be worse than none."""
    with pytest.raises(SettingsError, match="THETASCOPE_ORIGINS"):
        origins_of(setting)


def test_the_setting_is_read_as_browsers_write_origins():
    """Case, a final slash and the port of the scheme do not matter in the setting."""
    assert origins_of(" HTTPS://Lab.example.org:443/ ,http://[::1]:8888,") == {LISTED, "http://[::1]:8888"}
    assert origins_of("") == frozenset()
