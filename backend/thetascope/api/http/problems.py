"""Return every error as application/problem+json (RFC 9457) with the field, the value and the remedy."""

import logging
import re
from math import ceil

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response

from thetascope.api.http.language import language_of
from thetascope.engine.errors import SpecError
from thetascope.messages import Message, words
from thetascope.runs.records.record_files import NoRoom
from thetascope.runs.saved_texts import NoRoomForTexts
from thetascope.runs.specs.problem_documents import problem, refused
from thetascope.runs.specs.refusals import (
    Busy,
    InvalidSpec,
    NotOwner,
    NotReady,
    OverLimit,
    Refusal,
    Unknown,
    from_engine,
)
from thetascope.runs.workers.limits import Crashed, LimitReached
from thetascope.store import Damaged, StoreError
from thetascope_schemas.service.field_error import field_errors
from thetascope_schemas.service.run import Problem

log = logging.getLogger(__name__)

MEDIA_TYPE = "application/problem+json"

PROBLEM = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
"""The content of a refusal in the OpenAPI document."""

#: For the OpenAPI page: the problems that any operation on a spec or a run may return.
RESPONSES = {
    code: {"description": text, "content": PROBLEM}
    for code, text in {
        401: "The access key is missing or wrong.",
        403: "It belongs to another client.",
        404: "Nothing has this id; near matches are named.",
        409: "The run has no result (yet).",
        413: "The body is larger than the limit.",
        415: "The body is neither JSON nor YAML.",
        422: "The spec or a parameter is refused: field, value, remedy.",
        429: "This client has or uses as much as one client may; `Retry-After` says when to try again.",
        503: "The queue is full, or the store cannot be used.",
    }.items()
}


class BodyProblem(Exception):
    """A body that was not read: status 400, 413 or 415."""

    def __init__(self, status: int, why: Message) -> None:
        super().__init__(status, why)
        self.status, self.why = status, why


def documented(*codes: int) -> dict[int | str, dict]:
    """Return the `responses` of a route that may return these problems."""
    return {code: RESPONSES[code] for code in codes}


def problem_response(document: Problem, headers: dict[str, str] | None = None) -> Response:
    """Return the answer with a problem."""
    body = document.model_dump_json(exclude_none=True)
    return Response(body, document.status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Turn every exception into a problem document in the language of the request."""
    for error, handler in {
        InvalidSpec: _invalid,
        SpecError: _engine,
        BodyProblem: _body,
        Refusal: _refusal,
        RequestValidationError: _parameters,
        HTTPException: _http,
        StoreError: _store,
        ClientDisconnect: _gone,
        Exception: _unexpected,
    }.items():
        app.add_exception_handler(error, handler)


async def _invalid(request: Request, error: InvalidSpec) -> Response:
    return problem_response(refused(error, language_of(request)))


async def _engine(request: Request, error: SpecError) -> Response:
    return problem_response(refused(from_engine(error), language_of(request)))


async def _body(request: Request, error: BodyProblem) -> Response:
    """Return the problem and close the connection, since the rest of the body was not read."""
    document = problem(error.status, error.why, language=language_of(request))
    return problem_response(document, {"Connection": "close"})


async def _refusal(request: Request, error: Refusal) -> Response:
    statuses = {
        Unknown: 404,
        Busy: 503,
        OverLimit: 429,
        NotOwner: 403,
        NoRoom: 413,
        NoRoomForTexts: 413,
        NotReady: 409,
        LimitReached: 422,
        Crashed: 500,
    }
    status = statuses.get(type(error), 409)
    document = problem(status, error.problem, error.remedy, language_of(request), request.url.path)
    wait = error.retry if isinstance(error, OverLimit) else 2
    return problem_response(document, {"Retry-After": str(ceil(wait))} if status in (429, 503) else None)


async def _parameters(request: Request, error: RequestValidationError) -> Response:
    """Return the problem of an invalid query or path parameter."""
    errors = [
        entry.model_copy(update={"field": entry.field.partition(".")[2] or entry.field})
        for entry in field_errors(error.errors(), None, words())
    ]
    return problem_response(refused(InvalidSpec(errors), language_of(request)))


async def _http(request: Request, error: HTTPException) -> Response:
    """Return the problem of a request that the framework refuses: an unknown address or method."""
    headers, status, path = dict(error.headers or {}), error.status_code, request.url.path[:200]
    why = Message("http.refused", status=status, detail=str(error.detail))
    if status == 404:
        why = Message("http.no-address", path=path)
    if status == 405:
        methods = methods_of(request) or ["GET"]
        headers = {"Allow": ", ".join(methods)}
        why = Message("http.no-method", method=request.method[:20], path=path, methods=methods)
    return problem_response(problem(status, why, language=language_of(request)), headers)


def methods_of(request: Request) -> list[str]:
    """Return the methods that the interface allows for the request's address, over all its routes."""
    for template, operations in request.app.openapi()["paths"].items():
        if re.fullmatch(re.sub(r"\{[^}]*\}", "[^/]+", template), request.url.path):
            return sorted(method.upper() for method in operations)
    return []


async def _store(request: Request, error: StoreError) -> Response:
    log.error("%s", error)
    status = 403 if error.problem.code == "store.joined" else 500 if isinstance(error, Damaged) else 503
    return problem_response(problem(status, error.problem, language=language_of(request)))


async def _gone(request: Request, error: ClientDisconnect) -> Response:
    """Return an answer that nobody reads: the client has closed the connection."""
    return Response(status_code=499)


async def _unexpected(request: Request, error: Exception) -> Response:
    """Return the problem of an internal error; the traceback is in the log only."""
    return problem_response(problem(500, Message("http.internal-error"), language=language_of(request)))
