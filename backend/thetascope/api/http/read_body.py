"""Read the body of a request: check its type and size first, and parse it off the event loop."""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from fastapi import Request
from pydantic import BaseModel
from starlette.concurrency import run_in_threadpool

from thetascope.access.principal import principal_of
from thetascope.api.http.computed import computed
from thetascope.api.http.problems import BodyProblem
from thetascope.api.http.services import Services
from thetascope.messages import Message
from thetascope.runs.plants.my_plants import saved_data, saved_json
from thetascope.runs.specs.refusals import InvalidSpec, validated
from thetascope.runs.specs.sent_texts import json_of, valid_json, valid_yaml
from thetascope_schemas.experiment.plant import Plant

Value = TypeVar("Value")
Model = TypeVar("Model", bound=BaseModel)

_LARGE = 64 * 1024
"""Bytes above which a body is checked in a worker process. Python's lock is not released while it is parsed: the
largest that is allowed would take it from all others for a second."""


_SMALL_TEXT = 16 * 1024
"""Characters of a saved plant up to which it is read in a thread: YAML takes up to three microseconds for each."""
_YAML = ("application/yaml", "application/x-yaml", "text/yaml")


async def read_body(request: Request, limit: int) -> bytes:
    """Return the body if it is JSON of at most `limit` bytes. Raises :class:`BodyProblem` (413, 415)."""
    kind = _kind(request)
    if kind != "application/json" and not (kind.startswith("application/") and kind.endswith("+json")):
        raise BodyProblem(415, Message("body.type", type=kind[:80]) if kind else Message("body.no-type"))
    return await read_bytes(request, limit)


def _kind(request: Request) -> str:
    """Return the media type of a body, without its parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


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


async def parsed(
    request: Request,
    services: Services,
    read: Callable[[Any], Model],
    then: Callable[[Model], Value] = lambda value: value,
) -> Value:
    """Return the value of `then` for the model that `read` makes of a body in JSON or YAML, computed in a thread.

    Where the body names a plant that the client has saved, `read` gets it in full. It is a function of a module: a
    large body, and each in YAML, is checked in a worker process first, and what it says is short then.
    """
    if _kind(request) in _YAML:
        text = await read_bytes(request, services.settings.max_body)
        body = await computed(request, services, valid_yaml, text, read)
    else:
        body = await read_body(request, services.settings.max_body)
    if len(body) > _LARGE:
        body = await computed(request, services, valid_json, body, read)
    data = await with_plants(request, services, await run_in_threadpool(json_of, body))
    return await run_in_threadpool(lambda: then(read(data)))


async def parsed_as(request: Request, services: Services, model: type[Model]) -> Model:
    """Return the model of the body's JSON. Raises InvalidSpec, BodyProblem."""
    return await parsed(request, services, partial(validated, model))


async def with_plants(request: Request, services: Services, data: Any) -> Any:
    """Return the JSON data of a body with a saved plant in full where it names one, as `plant`, `spec.plant`
    or `experiment.plant`.

    Raises Unknown, InvalidSpec. It does not validate small plants.
    """
    for part in ("spec", "experiment"):
        if isinstance(data, dict) and isinstance(data.get(part), dict):
            data = data | {part: await _with_plant(request, services, data[part], f"{part}.plant")}
    return await _with_plant(request, services, data, "plant")


async def chosen_plant(request: Request, services: Services, choice: str | Plant) -> str | Plant:
    """Return a plant that a client names in full if it is a saved one, else the choice unchanged.

    Raises Unknown for a version that does not exist, and InvalidSpec for a draft with errors.
    """
    if not isinstance(choice, str):
        return choice
    data = (await _with_plant(request, services, {"plant": choice}, ""))["plant"]
    return choice if data is choice else await run_in_threadpool(validated, Plant, data)


async def _with_plant(request: Request, services: Services, holder: Any, field: str) -> Any:
    """Return data whose `plant` is a saved one's in full where it was its name; `field` leads there, for errors.

    A large text is read in a worker process.
    """
    name = holder.get("plant") if isinstance(holder, dict) else None
    if not isinstance(name, str):
        return holder
    saved = await run_in_threadpool(services.my_plants.named, name, principal_of(request.scope))
    if saved is None:
        return holder
    if len(saved.text) <= _SMALL_TEXT:
        return holder | {"plant": await run_in_threadpool(saved_data, saved)}
    try:
        body = await computed(request, services, saved_json, saved)
    except InvalidSpec as error:
        path = f"{field}." if field else ""
        raise InvalidSpec([one.model_copy(update={"field": path + one.field}) for one in error.errors]) from None
    return holder | {"plant": await run_in_threadpool(json_of, body)}


def _too_large(size: int, limit: int) -> BodyProblem:
    return BodyProblem(413, Message("body.too-large", size=size, limit=limit))


def body_schema(*models: str, yaml: bool = True) -> dict[str, Any]:
    """Return the `openapi_extra` of a route whose body has one of these schemas, in JSON or (with `yaml`) in YAML."""
    refs = [{"$ref": f"#/components/schemas/{model}"} for model in models]
    schema = refs[0] if len(refs) == 1 else {"anyOf": refs}
    kinds = ("application/json", _YAML[0]) if yaml else ("application/json",)
    return {"requestBody": {"required": True, "content": {kind: {"schema": schema} for kind in kinds}}}
