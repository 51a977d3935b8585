"""A learning platform for tests: it signs launches, and takes scores from whoever proves to be the registered tool."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, parse_qsl, urlencode, urlsplit

from joserfc import jwt
from joserfc.jwk import KeySet, RSAKey

CLAIM = "https://purl.imsglobal.org/spec/lti/claim/"
ROLE = "http://purl.imsglobal.org/vocab/lis/v2/membership#"
SCORE = "https://purl.imsglobal.org/spec/lti-ags/scope/score"
ENDPOINT = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"
LTI = "/api/classroom/lti"
CLIENT = "tool-1"


def new_key() -> RSAKey:
    return RSAKey.generate_key(2048, {"use": "sig", "alg": "RS256"}, private=True, auto_kid=True)


@dataclass
class PlatformStub:
    """The platform. `refuses` are statuses with which it answers the next scores."""

    address: str = ""
    key: RSAKey = field(default_factory=new_key)
    scores: list[dict[str, Any]] = field(default_factory=list)
    refuses: list[int] = field(default_factory=list)
    assertions: list[dict[str, Any]] = field(default_factory=list)
    tool_keys: str = ""

    def registered(self, file: Path) -> Path:
        """Write the platform's entry to a file, and return the file."""
        entry = {
            "issuer": self.address,
            "client_id": CLIENT,
            "deployments": ["7"],
            "login_url": f"{self.address}/auth?realm=x",
            "token_url": f"{self.address}/token",
            "keys_url": f"{self.address}/keys",
        }
        file.write_text(json.dumps({"platforms": [entry]}))
        return file

    def answer(self, method: str, path: str, headers: Any, body: bytes) -> tuple[int, Any]:
        """Return status and answer of a request."""
        if (method, path) == ("GET", "/keys"):
            return 200, KeySet([self.key]).as_dict(private=False)
        if (method, path) == ("POST", "/token"):
            return self._token({name: values[0] for name, values in parse_qs(body.decode()).items()})
        if method == "POST" and path == "/items/5/scores?type=1":
            if self.refuses:
                return self.refuses.pop(0), {}
            if headers["Authorization"] != "Bearer good" or headers["Content-Type"] != (
                "application/vnd.ims.lis.v1.score+json"
            ):
                return 401, {}
            self.scores.append(json.loads(body))
            return 200, {}
        return 404, {}

    def _token(self, form: dict[str, str]) -> tuple[int, Any]:
        """Return a token to whoever signs with the tool's key."""
        keys = KeySet.import_key_set(json.loads(fetched("GET", self.tool_keys)[2]))
        claims = jwt.decode(form["client_assertion"], keys, ["RS256"]).claims
        now = time.time()
        meant = claims["iss"] == claims["sub"] == CLIENT and claims["aud"] == f"{self.address}/token"
        fresh = claims["exp"] > now >= claims["iat"] - 5 and claims["jti"] not in [a["jti"] for a in self.assertions]
        if not (meant and fresh and form["grant_type"] == "client_credentials" and form["scope"] == SCORE):
            return 400, {"error": "invalid_client"}
        self.assertions.append(dict(claims))
        return 200, {"access_token": "good", "token_type": "Bearer", "expires_in": 3600}

    def claims(self, query: dict[str, str], **change: Any) -> dict[str, Any]:
        """Return the claims of a learner's launch; those that are None are left out."""
        now = int(time.time())
        claims = {
            "iss": self.address,
            "aud": CLIENT,
            "sub": "ada",
            "exp": now + 300,
            "iat": now,
            "nonce": query["nonce"],
            "name": "Ada Lovelace",
            f"{CLAIM}message_type": "LtiResourceLinkRequest",
            f"{CLAIM}version": "1.3.0",
            f"{CLAIM}deployment_id": "7",
            f"{CLAIM}target_link_uri": query["redirect_uri"],
            f"{CLAIM}resource_link": {"id": "activity"},
            f"{CLAIM}roles": [f"{ROLE}Learner"],
            ENDPOINT: {"scope": [SCORE], "lineitem": f"{self.address}/items/5?type=1"},
        }
        claims |= {name if name in claims or "/" in name else f"{CLAIM}{name}": v for name, v in change.items()}
        return {name: value for name, value in claims.items() if value is not None}

    def signed(self, claims: dict[str, Any], key: RSAKey | None = None) -> str:
        """Return a token with these claims."""
        return jwt.encode({"alg": "RS256", "kid": self.key.kid}, claims, key or self.key)


@contextmanager
def platform() -> Iterator[PlatformStub]:
    """Run a platform."""
    stub = PlatformStub()

    class Handler(BaseHTTPRequestHandler):
        def _serve(self) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            status, answer = stub.answer(self.command, self.path, self.headers, body)
            content = json.dumps(answer).encode()
            self.send_response(status)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        do_GET = do_POST = _serve

        def log_message(self, format: str, *args: Any) -> None:
            """Print nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    stub.address = f"http://127.0.0.1:{server.server_port}"
    thread = Thread(target=server.serve_forever, args=(0.05,), daemon=True)
    thread.start()
    try:
        yield stub
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def fetched(method: str, url: str, form: dict[str, str] | None = None, **headers: str) -> tuple[int, Any, str]:
    """Return status, headers and body of an answer; no redirect is followed."""
    parts = urlsplit(url)
    connection = HTTPConnection(parts.netloc, timeout=120)
    kind = {} if form is None else {"Content-Type": "application/x-www-form-urlencoded"}
    path = parts.path + (f"?{parts.query}" if parts.query else "")
    connection.request(method, path, None if form is None else urlencode(form), kind | headers)
    answer = connection.getresponse()
    body = answer.read().decode()
    connection.close()
    return answer.status, answer.headers, body


@dataclass
class Visitor:
    """A browser that comes from a platform."""

    tool: str
    stub: PlatformStub
    cookie: str = ""

    def login(self, **change: str) -> dict[str, str]:
        """Begin a login as the platform's page does; return the query with which the tool sends the browser back."""
        form = {
            "iss": self.stub.address,
            "client_id": CLIENT,
            "login_hint": "hint",
            "lti_deployment_id": "7",
            "target_link_uri": f"{self.tool}{LTI}/launch",
        }
        status, headers, body = fetched("POST", f"{self.tool}{LTI}/login", form | change, Origin=self.stub.address)
        assert status == 302, body
        self.cookie = headers["Set-Cookie"].partition(";")[0]
        assert headers["Location"].startswith(f"{self.stub.address}/auth?realm=x&scope=openid&")
        return dict(parse_qsl(urlsplit(headers["Location"]).query))

    def launch(self, token: str, state: str, cookie: str | None = None) -> tuple[int, Any, str]:
        """Send a token as the platform's page does."""
        sent = {"Cookie": self.cookie if cookie is None else cookie, "Origin": self.stub.address}
        return fetched("POST", f"{self.tool}{LTI}/launch", {"id_token": token, "state": state}, **sent)

    def came(self, **change: Any) -> str:
        """Log in and launch; return the address of the page to which that leads."""
        query = self.login()
        status, headers, body = self.launch(self.stub.signed(self.stub.claims(query, **change)), query["state"])
        assert status == 303, body
        return headers["Location"]

    def claim(self, page: str, what: str) -> tuple[int, Any]:
        """Claim a room or a seat as the page does."""
        body = json.dumps({"launch": page.partition("launch=")[2]})
        connection = HTTPConnection(urlsplit(self.tool).netloc, timeout=120)
        headers = {"Content-Type": "application/json", "Cookie": self.cookie, "Origin": self.tool}
        connection.request("POST", f"{LTI}/{what}", body, headers)
        answer = connection.getresponse()
        content = json.loads(answer.read())
        connection.close()
        return answer.status, content
