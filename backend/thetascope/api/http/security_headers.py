"""Headers that keep a browser from doing with this service what its user did not ask for."""

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from thetascope.api.http.problems import problem_response
from thetascope_schemas.service.run import Problem

POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'self'"
)
"""Everything from here. Plotly sets styles in the page, and makes images of figures as blobs; Redoc starts a worker."""

_HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_SAFE = {"GET", "HEAD", "OPTIONS"}


class Security:
    """Adds the headers that a response does not set itself, and refuses changes that another site's page asks for."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        if scope["method"] not in _SAFE and Headers(scope=scope).get("sec-fetch-site") == "cross-site":
            detail = "a page of another site may not change anything here; use this service's own page, or no browser"
            refusal = problem_response(Problem(title="Forbidden", status=403, detail=detail))
            await refusal(scope, receive, send_with_headers)
            return
        await self._app(scope, receive, send_with_headers)
