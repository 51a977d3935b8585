"""Choose the language of an answer: `?lang=`, then `Accept-Language`, then English."""

from typing import Annotated

from fastapi import Depends, Query, Request
from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from thetascope.messages.catalogue import negotiate
from thetascope_schemas.texts.local_text import ALL

_KEY = "thetascope.language"  # in the scope of a request: {"language": …} after the first call of language_of


def language_of(request: HTTPConnection) -> str:
    """Return the requested language of a request or websocket; its answer then has Content-Language and Vary."""
    chosen = request.scope.setdefault(_KEY, {})
    if "language" not in chosen:
        requested = request.query_params.get("lang")
        header = request.headers.get("accept-language", "")
        chosen["language"] = negotiate([requested[:40]] if requested else accepted(header))
    return chosen["language"]


def accepted(header: str) -> list[str]:
    """Return the tags of an Accept-Language header in order of preference, without those of quality 0."""
    weighed = []
    for part in header[:1000].split(","):
        tag, _, rest = part.partition(";")
        try:
            quality = float(rest.strip().removeprefix("q=")) if rest else 1.0
        except ValueError:
            quality = 0.0
        if tag.strip() and quality > 0:
            weighed.append((-quality, tag.strip()))
    return [tag for _, tag in sorted(weighed, key=lambda pair: pair[0])]


def _language(
    request: Request,
    lang: Annotated[
        str | None,
        Query(
            max_length=35, description="Language of the sentences in the answer: en or zh. Overrides Accept-Language."
        ),
    ] = None,
) -> str:
    return language_of(request)


Language = Annotated[str, Depends(_language)]
"""The language of the answer, for routes whose answers contain sentences."""


def _prose(request: Request, language: Language) -> str:
    return ALL if request.query_params.get("lang") == ALL else language


Prose = Annotated[str, Depends(_prose)]
"""The language of prose in data: one language, or all with `?lang=*`."""


class ContentLanguage:
    """Adds Content-Language and Vary to answers that were rendered in a language, and to no others."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, and add the chosen language to the headers of its answer."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        chosen: dict[str, str] = scope.setdefault(_KEY, {})

        async def send_with_language(message: Message) -> None:
            if message["type"] == "http.response.start" and chosen:
                headers = MutableHeaders(scope=message)
                headers["Content-Language"] = chosen["language"]
                headers.add_vary_header("Accept-Language")
            await send(message)

        await self._app(scope, receive, send_with_language)
