"""/api/messages: the catalogue of a language, for programs that render messages themselves."""

from functools import cache
from hashlib import sha256

import orjson
from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.messages.catalogue import catalogue, negotiate

router = APIRouter(tags=["messages"])


@router.get("/messages/{language}", response_model=None)
def get_messages(request: Request, language: str) -> Response:
    """Return the sentences of a language: code → template, or a list with one template for each plural form.

    `plural` lists the plural categories of Unicode's CLDR in the order of these forms. A language without a catalogue
    is answered in English; `language` is the language of the answer.
    """
    tag, body = _compiled(negotiate([language]))
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    return Response(body, 200, headers, "application/json")


@cache
def _compiled(language: str) -> tuple[str, bytes]:
    """Return the entity tag and the JSON of a catalogue."""
    body = orjson.dumps(catalogue(language).as_data(), option=orjson.OPT_SORT_KEYS)
    return f'"{sha256(body).hexdigest()[:20]}"', body
