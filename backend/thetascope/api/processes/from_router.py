"""The middleware that undoes what the router of `serve --processes` did to a request.

Whoever connects to the service connects to the router, and the router to a socket that only this service's user can
reach. Access is decided by where a request comes from and by whether a proxy passed it on, so the router's own headers
must neither be taken for those of a proxy nor hide them. It therefore sends what it replaces under names of its own.
"""

from collections.abc import MutableMapping
from typing import Any

from starlette.types import ASGIApp, Receive, Scope, Send

PREFIX = "X-Router-"
REPLACED = ("Forwarded", "Via", "X-Forwarded-For", "X-Forwarded-Host", "X-Forwarded-Proto", "X-Real-IP")
"""Headers that Caddy adds or replaces, or may do so in another version."""
CLIENT, PROTOCOL = "Client", "Protocol"
_AS_RECEIVED = "thetascope.as-received"
_REPLACED = {name.lower().encode() for name in REPLACED}
_PREFIX = PREFIX.lower().encode()

Headers = list[tuple[bytes, bytes]]


class FromRouter:
    """Gives each request the address, protocol and headers with which it came to the router."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request or a websocket."""
        await self._app(restored(scope) if scope["type"] in ("http", "websocket") else scope, receive, send)


def restored(scope: MutableMapping[str, Any]) -> MutableMapping[str, Any]:
    """Return the scope of a request as it came to the router."""
    headers: Headers = [(name.lower(), value) for name, value in scope["headers"]]
    sent = {name.removeprefix(_PREFIX): value for name, value in headers if name.startswith(_PREFIX)}
    kept = [(name, value) for name, value in headers if not name.startswith(_PREFIX) and name not in _REPLACED]
    came = [(name, sent[name]) for name in _REPLACED if sent.get(name)]
    version = sent.get(PROTOCOL.lower().encode(), b"").decode("latin-1").removeprefix("HTTP/")
    return {
        **scope,
        "headers": kept + came,
        "client": _address(sent.get(CLIENT.lower().encode(), b"").decode("latin-1")),
        "http_version": version or scope["http_version"],
        _AS_RECEIVED: headers,
    }


def as_received(scope: MutableMapping[str, Any]) -> Headers:
    """Return the headers of a request for another process of the service, which finds in them what this one found."""
    return scope.get(_AS_RECEIVED, scope["headers"])


def _address(text: str) -> tuple[str, int] | None:
    """Return host and port of `host:port`."""
    host, _, port = text.rpartition(":")
    return (host.strip("[]"), int(port)) if host and port.isdigit() else None
