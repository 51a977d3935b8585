"""Every error as application/problem+json (RFC 9457), naming the field, the value and the remedy."""

import logging
import re
from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import Response

from thetascope.engine.errors import SpecError
from thetascope.runs.specs.refusals import Busy, InvalidSpec, NotReady, Refusal, Unknown, from_engine, refused
from thetascope.store import StoreError
from thetascope_schemas.experiment.base import FieldError, field_errors
from thetascope_schemas.service.run import Problem

log = logging.getLogger(__name__)

MEDIA_TYPE = "application/problem+json"

#: For the OpenAPI page: the problems that any operation on a spec or a run may answer with.
RESPONSES = {
    code: {"model": Problem, "description": text, "content": {MEDIA_TYPE: {}}}
    for code, text in {
        404: "There is no such thing; near matches are named.",
        409: "The run has no result (yet).",
        413: "The body is larger than the limit.",
        415: "The body is not JSON.",
        422: "The spec or a parameter is refused: field, value, remedy.",
        503: "The queue is full, or the store cannot be used.",
    }.items()
}


class BodyProblem(Exception):
    """A body that is not read: its status is 400, 413 or 415."""

    def __init__(self, status: int, detail: str, remedy: str) -> None:
        super().__init__(detail)
        self.problem = Problem(title=_phrase(status), status=status, detail=f"{detail}; {remedy}")


def documented(*codes: int) -> dict[int | str, dict]:
    """The `responses` of a route that may answer with these problems."""
    return {code: RESPONSES[code] for code in codes}


def problem_response(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """The answer that carries a problem."""
    body = problem.model_dump_json(exclude_none=True)
    return Response(body, problem.status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Make every exception a problem document."""
    for error, handler in {
        InvalidSpec: _invalid,
        SpecError: _engine,
        BodyProblem: _body,
        Refusal: _refusal,
        RequestValidationError: _parameters,
        HTTPException: _http,
        StoreError: _store,
        Exception: _unexpected,
    }.items():
        app.add_exception_handler(error, handler)


async def _invalid(request: Request, error: InvalidSpec) -> Response:
    return problem_response(refused(error))


async def _engine(request: Request, error: SpecError) -> Response:
    return problem_response(refused(from_engine(error)))


async def _body(request: Request, error: BodyProblem) -> Response:
    """The connection is closed: the rest of the body was not read."""
    return problem_response(error.problem, {"Connection": "close"})


async def _refusal(request: Request, error: Refusal) -> Response:
    status = {Unknown: 404, Busy: 503, NotReady: 409}.get(type(error), 409)
    title = {404: "Not found", 503: "The queue is full", 409: "The run has no result"}[status]
    problem = Problem(title=title, status=status, detail=f"{error.detail}; {error.remedy}", instance=request.url.path)
    return problem_response(problem, {"Retry-After": "2"} if status == 503 else None)


async def _parameters(request: Request, error: RequestValidationError) -> Response:
    """A query or path parameter of the wrong form."""
    errors = [
        FieldError(field=entry.field.partition(".")[2] or entry.field, **entry.model_dump(exclude={"field"}))
        for entry in field_errors(error.errors())
    ]
    return problem_response(refused(InvalidSpec(errors)))


async def _http(request: Request, error: HTTPException) -> Response:
    """What the framework refuses: unknown addresses and methods."""
    headers = dict(error.headers or {})
    detail = str(error.detail)
    if error.status_code == 404:
        detail = f"there is nothing at {request.url.path}; /docs lists the addresses of the interface"
    if error.status_code == 405:
        headers = {"Allow": ", ".join(methods_of(request)) or "GET"}
        detail = f"{request.method} is not possible here; use {headers['Allow']}"
    problem = Problem(title=_phrase(error.status_code), status=error.status_code, detail=detail)
    return problem_response(problem, headers)


def methods_of(request: Request) -> list[str]:
    """The methods that the interface knows for the request's address, over all its routes."""
    for template, operations in request.app.openapi()["paths"].items():
        if re.fullmatch(re.sub(r"\{[^}]*\}", "[^/]+", template), request.url.path):
            return sorted(method.upper() for method in operations)
    return []


async def _store(request: Request, error: StoreError) -> Response:
    log.error("%s", error)
    return problem_response(Problem(title="The store cannot be used", status=503, detail=str(error)))


async def _unexpected(request: Request, error: Exception) -> Response:
    """A fault of the program: the log has the traceback, the client a sentence."""
    detail = "An error inside the program; its log tells more. Report it with what was sent"
    return problem_response(Problem(title="Internal error", status=500, detail=detail))


def _phrase(status: int) -> str:
    return HTTPStatus(status).phrase
