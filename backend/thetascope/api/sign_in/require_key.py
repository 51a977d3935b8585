"""The middleware that admits requests. Whatever it lets pass has a principal; all addresses are closed but OPEN, and
those of guests.py, for students in a classroom.

A link with the key (`/?key=…`) is answered with a cookie and a redirect to the same address without the key, which so
stays in no address, history or referrer. The key in the address of the REST interface is not accepted.
"""

import asyncio
import logging
from urllib.parse import parse_qs, unquote_plus, urlencode

from starlette.requests import ClientDisconnect, Request
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from thetascope.access.client_limits import limits_of
from thetascope.access.gate import Gate, Presented, Refused, cookie_name
from thetascope.access.key_file import KeyFileError
from thetascope.access.principal import LOCAL, Principal, assign
from thetascope.access.tickets import KEPT
from thetascope.access.wrong_keys import WrongKeys
from thetascope.api.http.browser_security import close_socket
from thetascope.api.http.language import language_of
from thetascope.api.http.problems import problem_response
from thetascope.api.operation.request_log import audit
from thetascope.api.sign_in.guests import MOST_SOCKETS, guest, is_for_guests
from thetascope.api.sign_in.open_sockets import OpenSockets
from thetascope.api.sign_in.presented import is_https, presented
from thetascope.api.sign_in.sign_in_page import sign_in_page
from thetascope.messages import Message
from thetascope.runs.specs.problem_documents import problem
from thetascope.settings import Settings
from thetascope_schemas.service.session import CLOSE_SIGN_IN, CLOSE_SOCKETS

log = logging.getLogger(__name__)

OPEN = {"/api/health/live"}
"""Addresses that need no key."""
PAGE, LEAVE = "/sign-in", "/sign-out"
_FORM = 4096
"""Bytes of the largest form."""


class RequireKey:
    """Records for whom each request acts, and refuses those that need the key and do not show it."""

    def __init__(self, app: ASGIApp, gate: Gate, settings: Settings) -> None:
        self._app, self._gate, self._settings = app, gate, settings
        self._wrong = WrongKeys()
        self._sockets = OpenSockets(gate.seal)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request or a websocket."""
        if scope["type"] == "websocket":
            await self._websocket(scope, receive, send)
        elif scope["type"] == "http":
            await self._http(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    async def _http(self, scope: Scope, receive: Receive, send: Send) -> None:
        request = Request(scope, receive)
        try:
            answer = await self._answer(request)
        except KeyFileError as error:
            log.error("%s", error)
            answer = problem_response(problem(503, error.problem, language=language_of(request)))
        except ClientDisconnect:
            return
        await (answer or self._app)(scope, receive, send)

    async def _answer(self, request: Request) -> Response | None:
        """Return the answer of the gate; None if the request is admitted."""
        path = request.url.path
        if path in OPEN:
            assign(request.scope, LOCAL)
            return None
        shown = presented(request)
        admitted = self._gate.admit(shown)
        is_document = request.method in ("GET", "HEAD") and path != "/api" and not path.startswith("/api/")
        if is_document and "key" in request.query_params:
            return await self._by_link(request, shown, admitted)
        if path == PAGE:
            return await self._sign_in(request, shown, admitted)
        if path == LEAVE and request.method == "POST":
            return self._signed_out(request)
        if not isinstance(admitted, Principal) and is_for_guests(request.method, path):
            admitted = guest(shown.address)
        if isinstance(admitted, Principal):
            assign(request.scope, admitted)
            return None
        if is_document and "text/html" in request.headers.get("accept", ""):
            return _to(f"{PAGE}?{urlencode({'next': _address(request)})}")
        return await self._refusal(request, shown, admitted)

    async def _by_link(self, request: Request, shown: Presented, admitted: Principal | Refused) -> Response:
        """Answer a request with the key in its address: with the address without it, and a cookie if it is right."""
        goal = _local(request.query_params.get("next", "/")) if request.url.path == PAGE else _address(request)
        if isinstance(admitted, Principal) and admitted.is_machine:
            return _to(goal)
        ticket = self._gate.sign_in(shown, request.query_params["key"])
        if ticket is not None:
            return self._signed_in(request, ticket, goal)
        if isinstance(admitted, Principal):  # an old link in a browser that is signed in
            return _to(goal)
        status, _ = await self._slowed(shown)
        return _to(f"{PAGE}?{urlencode({'next': goal, 'wrong': status})}")

    async def _sign_in(self, request: Request, shown: Presented, admitted: Principal | Refused) -> Response:
        """Answer the sign-in page and its form."""
        goal = _local(request.query_params.get("next", "/"))
        language = language_of(request)
        if request.method in ("GET", "HEAD"):
            if isinstance(admitted, Principal):
                return _to(goal)
            wrong = request.query_params.get("wrong")
            why = Message("access.page.wrong-link") if wrong else None
            return sign_in_page(language, goal, why)
        if request.method != "POST":
            methods = ["GET", "POST"]
            why = Message("http.no-method", method=request.method[:20], path=PAGE, methods=methods)
            return problem_response(problem(405, why, language=language), {"Allow": "GET, POST"})
        body = await _read(request)
        key = parse_qs(body.decode(errors="replace")).get("key", [""])[0].strip() if body is not None else ""
        ticket = self._gate.sign_in(shown, key)
        if ticket is not None:
            return self._signed_in(request, ticket, goal)
        status, seconds = await self._slowed(shown)
        answer = sign_in_page(language, goal, Message("access.page.wrong"), status)
        if status == 429:
            answer.headers["Retry-After"] = str(seconds)
        return answer

    def _signed_in(self, request: Request, ticket: str, goal: str) -> Response:
        """Return the answer that gives a browser its ticket."""
        audit(request, "signed-in")
        answer = _to(goal)
        keys = self._gate.file.current()
        assert keys is not None
        answer.set_cookie(
            cookie_name(keys), ticket, max_age=KEPT, path="/", secure=is_https(request), httponly=True, samesite="lax"
        )
        return answer

    def _signed_out(self, request: Request) -> Response:
        """Return the answer that takes the ticket from a browser."""
        answer = _to(PAGE)
        keys = self._gate.file.current()
        if keys is not None:
            answer.delete_cookie(cookie_name(keys), path="/", secure=is_https(request), httponly=True, samesite="lax")
        return answer

    async def _refusal(self, request: Request, shown: Presented, why: Refused) -> Response:
        """Return the problem of a request that is not admitted."""
        status, headers = 401, {"WWW-Authenticate": 'Bearer realm="Thetascope"', "Cache-Control": "no-store"}
        if why is Refused.WRONG_KEY:
            status, seconds = await self._slowed(shown)
            headers |= {"Retry-After": str(seconds)} if status == 429 else {}
        return problem_response(problem(status, Message(why.value), language=language_of(request)), headers)

    async def _slowed(self, shown: Presented) -> tuple[int, int]:
        """Wait after a wrong key; return the status of the answer, and after how many seconds to try again."""
        seconds = self._wrong.count(shown.address)
        if not self._wrong.wait(shown.address):
            return 429, max(1, round(seconds))
        log.warning("A wrong access key from %s", shown.address)
        try:
            await asyncio.sleep(seconds)
        finally:
            self._wrong.answered(shown.address)
        return 401, 0

    async def _websocket(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a websocket of a client that may have one more; it is closed when the key is changed."""
        websocket = WebSocket(scope, receive, send)
        shown = presented(websocket)
        try:
            admitted = self._gate.admit(shown)
        except KeyFileError as error:
            log.error("%s", error)
            admitted = Refused.NO_KEY
        as_guest = isinstance(admitted, Refused) and is_for_guests("WEBSOCKET", scope["path"])
        if as_guest:
            admitted = guest(shown.address)
        if isinstance(admitted, Refused):
            if admitted is Refused.WRONG_KEY:
                await self._slowed(shown)
            await close_socket(websocket, CLOSE_SIGN_IN, Message(admitted.value))
            return
        most = MOST_SOCKETS if as_guest else limits_of(self._settings, admitted).sockets
        if not self._sockets.may_open(admitted.client, most):
            await close_socket(websocket, CLOSE_SOCKETS, Message("client.sockets", n=most))
            return

        async def end() -> None:
            why = Message(Refused.ENDED.value).text(language_of(websocket))
            await send({"type": "websocket.close", "code": CLOSE_SIGN_IN, "reason": why})

        assign(scope, admitted)
        with self._sockets.opened(admitted.client, None if admitted.is_machine or as_guest else end):
            await self._app(scope, receive, send)


def _to(address: str) -> Response:
    return RedirectResponse(address, 303, {"Cache-Control": "no-store"})


def _address(request: Request) -> str:
    """Return the address of a request on this service, without a key in its query."""
    path = request.scope.get("raw_path", b"").decode("latin-1").partition("?")[0]
    parts = [part for part in request.scope["query_string"].decode("latin-1").split("&") if part]
    kept = [part for part in parts if unquote_plus(part.partition("=")[0]) != "key"]
    return _local(path + (f"?{'&'.join(kept)}" if kept else ""))


def _local(address: str) -> str:
    """Return an address on this service, or that of the page for one that could lead elsewhere."""
    plain = all("!" <= character <= "~" for character in address)
    return address if plain and address.startswith("/") and not address.startswith(("//", "/\\")) else "/"


async def _read(request: Request) -> bytes | None:
    """Return the form that a request sends; None if it is larger than it may be."""
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > _FORM:
            return None
    return body
