"""Restrict what browsers do with this service on behalf of other sites: headers, host names, origins."""

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from thetascope.api.http.hosts import AllowedHosts
from thetascope.api.http.language import language_of
from thetascope.api.http.problems import problem_response
from thetascope.messages import Message as Wording
from thetascope.runs.specs.problem_documents import problem
from thetascope_schemas.service.session import CLOSE_ORIGIN, SUBPROTOCOL

POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'self'"
)
"""All content comes from this service. Plotly sets inline styles and creates image blobs; Redoc starts a worker."""

_HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_SAFE = {"GET", "HEAD", "OPTIONS"}
_CROSS_SITE = {
    "Access-Control-Expose-Headers": "Location, ETag, Retry-After, Content-Disposition, X-Request-ID",
    "Cross-Origin-Resource-Policy": "cross-origin",
}
_PREFLIGHT = {
    "Access-Control-Allow-Methods": "GET, HEAD, POST, PUT, PATCH, DELETE",
    "Access-Control-Allow-Headers": (
        "Content-Type, Accept-Language, Authorization, If-None-Match, X-Access-Key, X-Client, X-Control-Token"
    ),
    "Access-Control-Max-Age": "600",
}


class Security:
    """Adds headers that a response does not set itself.

    Refuses requests under a name that is not this service's, and changes and websockets requested by pages of other
    sites. Pages of the origins in the setting may read answers and change things (CORS). They have no cookies here:
    what they ask for with credentials cannot be read, and a cookie that a browser sends with it is removed.
    """

    def __init__(self, app: ASGIApp, hosts: AllowedHosts, forms: frozenset[str] = frozenset()) -> None:
        """Take the application, and the addresses that accept a form which a page of any other site sends."""
        self._app, self._hosts, self._forms = app, hosts, forms

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, and add the headers to its answer; or a websocket."""
        if scope["type"] == "websocket":
            websocket = WebSocket(scope, receive, send)
            if not self._hosts.allows(websocket.headers.get("host", "")) or not self._hosts.may_change(
                websocket.headers
            ):
                await close_socket(websocket, CLOSE_ORIGIN, Wording("session.close.origin"))
                return
            if self._hosts.other_site(websocket.headers) is not None:
                scope = _without_cookies(scope)
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        other = None if self._is_form(scope) else self._hosts.other_site(Headers(scope=scope))

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if self._hosts.lists_origins:
                    headers.add_vary_header("Origin")
                if other is not None:
                    headers.update({"Access-Control-Allow-Origin": other} | _CROSS_SITE)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        if (refusal := self._refusal(scope)) is not None:
            document = problem(*refusal, language=language_of(Request(scope)))
            await problem_response(document)(scope, receive, send_with_headers)
            return
        if other is not None:
            scope = _without_cookies(scope)
            if _is_preflight(scope):
                await Response(status_code=204, headers=_PREFLIGHT)(scope, receive, send_with_headers)
                return
        await self._app(scope, receive, send_with_headers)

    def _refusal(self, scope: Scope) -> tuple[int, Wording] | None:
        """Return status and reason if a request is refused."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._hosts.allows(host):
            return 421, Wording("http.host.unknown", host=host[:100])
        if scope["method"] not in _SAFE and not self._is_form(scope) and not self._hosts.may_change(headers):
            return 403, Wording("http.cross-site")
        return None

    def _is_form(self, scope: Scope) -> bool:
        """Return whether a request is one of the forms that other sites may send; its address checks what it says."""
        return scope["method"] == "POST" and scope["path"] in self._forms


def _is_preflight(scope: Scope) -> bool:
    """Return whether a browser asks whether it may send a request. It shows no key with that."""
    return scope["method"] == "OPTIONS" and "access-control-request-method" in Headers(scope=scope)


def _without_cookies(scope: Scope) -> Scope:
    """Return the scope of a request or websocket without its cookies."""
    return {**scope, "headers": [(name, value) for name, value in scope["headers"] if name.lower() != b"cookie"]}


async def close_socket(websocket: WebSocket, code: int, reason: Wording) -> None:
    """Refuse a websocket with a code and the reason in the viewer's language.

    It is accepted before: otherwise browsers do not pass the code to the page.
    """
    offered = websocket.scope.get("subprotocols", [])
    await websocket.accept(SUBPROTOCOL if SUBPROTOCOL in offered else None)
    await websocket.close(code, reason.text(language_of(websocket)))
