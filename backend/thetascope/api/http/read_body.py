"""Read the body of a request: check its type and size first, and parse it off the event loop."""

from collections.abc import Callable
from typing import Any, TypeVar

import orjson
from fastapi import Request
from starlette.concurrency import run_in_threadpool

from thetascope.access.principal import principal_of
from thetascope.api.http.problems import BodyProblem
from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid

Value = TypeVar("Value")


async def read_body(request: Request, limit: int) -> bytes:
    """Return the body if it is JSON of at most `limit` bytes. Raises :class:`BodyProblem` (413, 415)."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json" and not (kind.startswith("application/") and kind.endswith("+json")):
        raise BodyProblem(415, Message("body.type", type=kind[:80]) if kind else Message("body.no-type"))
    return await read_bytes(request, limit)


async def read_bytes(request: Request, limit: int) -> bytes:
    """Return the body, of any type, if it has at most `limit` bytes. Raises :class:`BodyProblem` (413)."""
    announced = request.headers.get("content-length", "")
    if announced.isdigit() and int(announced) > limit:
        raise _too_large(int(announced), limit)
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise _too_large(len(body), limit)
    return bytes(body)


async def parsed(request: Request, limit: int, parse: Callable[[Any], Value]) -> Value:
    """Return the value of `parse` for the body's JSON, computed in a worker thread.

    Where the body names a plant that the client has saved, `parse` gets it in full.
    """
    body = await read_body(request, limit)
    return await run_in_threadpool(lambda: parse(with_plants(request, json_of(body))))


def with_plants(request: Request, data: Any) -> Any:
    """Return the JSON data of a body with the client's saved plants in full. Raises Unknown, InvalidSpec."""
    return request.app.state.services.my_plants.in_full(data, principal_of(request.scope))


def json_of(body: bytes) -> Any:
    """Return the JSON data of a body. Raises InvalidSpec with the place of the error."""
    try:
        return orjson.loads(body)
    except orjson.JSONDecodeError as error:
        problem = Message("body.json", line=error.lineno, column=error.colno, detail=error.msg)
        raise invalid("", body[:60].decode(errors="replace"), problem) from None


def _too_large(size: int, limit: int) -> BodyProblem:
    return BodyProblem(413, Message("body.too-large", size=size, limit=limit))


def body_schema(*models: str) -> dict[str, Any]:
    """Return the `openapi_extra` of a route whose body has one of these schemas of the contract."""
    refs = [{"$ref": f"#/components/schemas/{model}"} for model in models]
    schema = refs[0] if len(refs) == 1 else {"anyOf": refs}
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema}}}}
