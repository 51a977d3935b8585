"""/api/my-plants: the plants that this client has saved, with their versions; /api/plants/check-text: check a text."""

from contextlib import suppress
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import Principal, principal_of
from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language, Prose
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as, read_bytes
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.messages import Message
from thetascope.runs.plants.my_plants import check_id
from thetascope.runs.plants.plant_text import plant_data, yaml_text
from thetascope.runs.plants.text_check import TextFacts, check_text, facts_of_text, has_no_errors
from thetascope.runs.plants.text_edit import edited_as
from thetascope.runs.specs.refusals import Busy, OverLimit, invalid
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope.runs.workers.limits import Crashed, LimitReached
from thetascope.store import TextVersion
from thetascope_schemas.service.plants.saved import MyPlant, MyPlantList
from thetascope_schemas.service.plants.text import EditedText, PlantTextCheck, TextEdit

router = APIRouter(tags=["plants"])

_TEXT = {"schema": {"type": "string", "description": "A plant as YAML or JSON."}}
BODY = {"requestBody": {"required": True, "content": {"application/yaml": _TEXT, "application/json": _TEXT}}}
Version = Annotated[int | None, Query(ge=1, le=2**31 - 1, description="Number of the version; default: the latest.")]


@router.post(
    "/plants/check-text", response_model=PlantTextCheck, openapi_extra=BODY, responses=documented(413, 422, 429)
)
async def check_plant_text(request: Request, services: Use, language: Language) -> Response:
    """Check a plant as text, YAML or JSON: all errors with their places and the changes that correct them.

    Errors are the answer, and not a refusal. A text without errors is answered with the plant and its equations.
    """
    checked = await computed(request, services, check_text, await _text(request, services), language)
    return Response(checked.model_dump_json(context={"language": language}), media_type="application/json")


@router.post(
    "/plants/edit-text",
    response_model=EditedText,
    openapi_extra=body_schema("TextEdit"),
    responses=documented(413, 415, 422),
)
async def edit_plant_text(request: Request, services: Use) -> Response:
    """Change a plant's text without touching the rest: numbers, further items of lists, equations; or convert it."""
    changed = await computed(request, services, edited_as, await parsed_as(request, services, TextEdit))
    return json_response({"text": changed.text, "lines": changed.lines})


@router.get("/plants/{id}/text", response_model=EditedText, responses=documented(404))
def get_plant_text(id: str, language: Prose) -> Response:
    """Return a plant of the library as YAML for an editor, its prose in one language."""
    return json_response({"text": yaml_text(plant_data(plant_of(id), language)), "lines": []})


@router.get("/my-plants", response_model=MyPlantList)
def list_my_plants(request: Request, services: Use) -> Response:
    """Return the latest version of each plant that this client or another has saved, the last saved first."""
    by = principal_of(request.scope)
    return json_response({"plants": [line(plant, by) for plant in services.my_plants.latest(by)]})


@router.get("/my-plants/{id}", response_model=MyPlant, responses=documented(404))
def get_my_plant(request: Request, id: str, services: Use, version: Version = None) -> Response:
    """Return a version of a plant with its text."""
    by = principal_of(request.scope)
    return json_response(_whole(services.my_plants.get(id, version, by), by))


@router.put(
    "/my-plants/{id}",
    response_model=MyPlant,
    status_code=201,
    openapi_extra=BODY,
    responses={200: {"model": MyPlant, "description": "It is the latest version already."}, **documented(413, 422)},
)
async def save_my_plant(request: Request, id: str, services: Use) -> Response:
    """Save a text as the next version of a plant. The body is the text, YAML or JSON, also with errors: a draft."""
    check_id(id)
    text, by = await _text(request, services), principal_of(request.scope)
    facts, ready = TextFacts(), False
    with suppress(Busy, OverLimit, LimitReached, Crashed):  # it is saved in any case
        facts = await computed(request, services, facts_of_text, text)
        ready = facts.is_plant and await computed(request, services, has_no_errors, text)
    saved, is_new = await run_in_threadpool(lambda: services.my_plants.save(id, text, facts, ready, by))
    audit(request, "plant.saved", plant=id, version=saved.version)
    return json_response(_whole(saved, by), 201 if is_new else 200, {"Location": _address(saved)})


@router.delete("/my-plants/{id}", status_code=204, responses=documented(403, 404))
def delete_my_plant(request: Request, id: str, services: Use) -> Response:
    """Delete a plant with all its versions. POST …/restore brings it back within 30 days."""
    services.my_plants.remove(id, principal_of(request.scope))
    audit(request, "plant.removed", plant=id)
    return Response(status_code=204)


@router.post("/my-plants/{id}/restore", response_model=MyPlant, responses=documented(404))
def restore_my_plant(request: Request, id: str, services: Use) -> Response:
    """Bring back a plant that was deleted, with all its versions."""
    by = principal_of(request.scope)
    return json_response(_whole(services.my_plants.restore(id, by), by))


@router.get("/my-plants/{id}/versions", response_model=MyPlantList, responses=documented(404))
def list_versions(request: Request, id: str, services: Use) -> Response:
    """Return all versions of a plant, the latest first."""
    by = principal_of(request.scope)
    return json_response({"plants": [line(plant, by) for plant in services.my_plants.versions(id, by)]})


async def _text(request: Request, services: Services) -> str:
    body = await read_bytes(request, services.settings.max_body)
    try:
        return body.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise invalid("", None, Message("document.no-utf8", name="plant", byte=error.start)) from None


def line(plant: TextVersion, by: Principal) -> dict[str, Any]:
    """Return a version of a plant as an entry of a list."""
    names = ("id", "version", "title", "format", "faults", "ready", "saved")
    own = {"mine": by.acts_for(plant.owner), "href": _address(plant)}
    return {name: getattr(plant, name) for name in names} | own


def _whole(plant: TextVersion, by: Principal) -> dict[str, Any]:
    return line(plant, by) | {"text": plant.text}


def _address(plant: TextVersion) -> str:
    return f"/api/my-plants/{plant.id}?version={plant.version}"
