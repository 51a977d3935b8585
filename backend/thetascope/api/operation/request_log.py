"""One log line and one observation of the metrics for every request, under an id that the answer carries."""

import logging
import re
import secrets
import time

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from thetascope.access.principal import is_admitted, principal_of
from thetascope.api.operation.log_format import request_id
from thetascope.api.operation.metrics import Metrics

log = logging.getLogger("thetascope.requests")
_audit = logging.getLogger("thetascope.audit")

HEADER = "X-Request-ID"
_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
_CLOSED = 499
"""The status in log and metrics of a request whose client went away before the answer began."""


class RequestLog:
    """Gives every request and websocket an id, writes a log line when it has ended, and counts it.

    A proxy's id (`X-Request-ID`) is kept if it has at most 64 letters, digits, points, underscores and hyphens.
    """

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app, self._metrics = app, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        sent = Headers(scope=scope).get(HEADER, "")
        id = sent if _ID.fullmatch(sent) else secrets.token_hex(8)
        token = request_id.set(id)
        begin, status = time.perf_counter(), _CLOSED

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                status = message["status"]
                MutableHeaders(scope=message)[HEADER] = id
            elif message["type"] == "websocket.accept":
                status = 101
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        except Exception:
            status = 500 if status == _CLOSED else status
            raise
        finally:
            self._ended(scope, status, time.perf_counter() - begin)
            request_id.reset(token)

    def _ended(self, scope: Scope, status: int, seconds: float) -> None:
        method = scope.get("method", "WEBSOCKET")
        if scope["type"] == "http":
            self._metrics.answered(route_of(scope), method, status, seconds)
        if log.isEnabledFor(logging.INFO):
            client = (scope.get("client") or ("", 0))[0]
            fields = {"method": method, "path": scope["path"], "status": status, "client": client}
            log.info("", extra={"fields": fields | {"ms": round(1000 * seconds, 1)}})


def route_of(scope: Scope) -> str:
    """Return the template of the address, as `/api/runs/{id}`; "other" where no route answered.

    Labels of metrics must be few, so no part of an address that a client chose is in it.
    """
    if scope.get("route") is None:
        return "other"
    path: str = scope["path"]
    for name, value in scope.get("path_params", {}).items():
        path = path.replace(f"/{value}", f"/{{{name}}}", 1)
    return path


def audit(connection: HTTPConnection, event: str, **fields: str | int | float | bool) -> None:
    """Write one line about a change that cannot be undone or that somebody may have to answer for.

    Args:
        connection: the request that asked for it.
        event: the event's name, as `run.removed`.
        fields: the things that it happened to.
    """
    client = connection.client.host if connection.client is not None else ""
    by = {"by": principal_of(connection.scope).owner} if is_admitted(connection.scope) else {}
    _audit.info("", extra={"fields": {"event": event, **fields, **by, "client": client}})
