"""/api/records: upload records, inspect them, map their columns to a plant, draw them, and remove them."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from pydantic import JsonValue
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import check_cpu, computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, chosen_plant, parsed_as, read_body, read_bytes
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope.runs.records.record_files import RecordFile
from thetascope.runs.specs.refusals import Unknown, from_engine
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope.runs.specs.sent_texts import record_of
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.service.answers import RecordList
from thetascope_schemas.service.record import Record
from thetascope_schemas.service.record_inspection import MappingRequest, RecordInspection, RecordPreview
from thetascope_schemas.texts.local_text import ALL

router = APIRouter(prefix="/records", tags=["diagnosis"])

_BODY = body_schema("Record", yaml=False)
_BODY["requestBody"]["content"]["application/octet-stream"] = {"schema": {"type": "string", "format": "binary"}}
Intervals = Annotated[int, Query(ge=1, le=5000, description="Number of intervals of time.")]


@router.post(
    "",
    status_code=201,
    response_model=RecordInspection,
    openapi_extra=_BODY,
    responses=documented(404, 413, 415, 422, 429),
)
async def create_record(
    request: Request,
    services: Use,
    language: Language,
    name: Annotated[str | None, Query(max_length=200, description="Name of the file whose bytes are the body.")] = None,
    plant: Annotated[
        str | None, Query(max_length=80, description="Id of a library plant, or of a plant that this client has saved.")
    ] = None,
) -> Response:
    """Upload a record and inspect it: the bytes of a file with its `name`, or JSON with `columns` or `csv`.

    The id is the hash of the file. A plant that is not in the library is given with POST …/mapping.
    """
    check_cpu(request, services)
    by = principal_of(request.scope)
    mapping = ColumnMapping()
    if name is None:
        name, data, record = await record_in(request, services)
        choice, mapping = record.plant, record.mapping
    else:
        data, choice = await read_bytes(request, services.settings.max_record), plant
        if plant is not None:
            choice = await chosen_plant(request, services, plant)
    chosen = None if choice is None else plant_of(choice)
    inspection = await _inspection(request, services, RecordFile("", name, data, chosen, mapping))
    stored = await run_in_threadpool(lambda: services.records.put(name, data, choice, mapping, by))
    return _answer(_with_id(inspection, stored.id), language, 201)


async def record_in(request: Request, services: Services) -> tuple[str, bytes, Record]:
    """Return a record in JSON as the name and bytes of a file, and the record without its samples, its plant in full.

    It is read in a worker process: millions of samples take seconds.
    """
    body = await read_body(request, services.settings.max_record)
    name, data, record = await computed(request, services, record_of, body)
    plant = await chosen_plant(request, services, record.plant)
    return name, data, record.model_copy(update={"plant": plant})


@router.get("", response_model=RecordList)
def list_records(request: Request, services: Use, limit: Annotated[int, Query(ge=1, le=1000)] = 100) -> Response:
    """Return the records of this client, the last one that changed first."""
    lines = services.records.page(principal_of(request.scope), limit)
    return json_response(
        {
            "records": [
                {"id": line.id, "name": line.name, "size": line.size, "changed": line.changed, "links": links(line.id)}
                for line in lines
            ]
        }
    )


@router.get("/{id}", response_model=RecordInspection, responses=documented(404, 422))
async def get_record(request: Request, id: str, services: Use, language: Language) -> Response:
    """Return the inspection of a record with the plant and mapping that were chosen last."""
    record = await _found(request, services, id)
    return _answer(await _inspection(request, services, record), language)


@router.put(
    "/{id}/mapping",
    response_model=RecordInspection,
    openapi_extra=body_schema("MappingRequest"),
    responses=documented(404, 413, 415, 422),
)
@router.post(
    "/{id}/mapping",
    response_model=RecordInspection,
    openapi_extra=body_schema("MappingRequest"),
    responses=documented(404, 413, 415, 422),
)
async def map_record(request: Request, id: str, services: Use, language: Language) -> Response:
    """Choose a plant and change the mapping; return the inspection. What is not given is guessed again."""
    asked = await parsed_as(request, services, MappingRequest)
    known = await _found(request, services, id)
    plant = plant_of(asked.plant)
    changed = RecordFile(id, known.name, known.data, plant, asked.mapping)
    inspection = await _inspection(request, services, changed)
    by = principal_of(request.scope)
    await run_in_threadpool(lambda: services.records.change(id, asked.plant, asked.mapping, by))
    return _answer(inspection, language)


@router.get("/{id}/preview", response_model=RecordPreview, responses=documented(404, 422))
async def preview_record(
    request: Request,
    id: str,
    services: Use,
    intervals: Intervals = 600,
    file_units: Annotated[
        bool, Query(description="Whether values are the file's, before units are converted.")
    ] = False,
) -> Response:
    """Return the curves of a record for drawing: smallest and largest values in intervals of time."""
    from thetascope.assembly.analyses.record_inspection import preview_file  # imports the engine

    record = await _found(request, services, id)
    given = (record.name, record.data, record.plant, record.mapping, intervals, file_units)
    try:
        preview = await computed(request, services, preview_file, *given)
    except SpecError as error:
        raise from_engine(error) from None
    return Response(preview.model_dump_json(), media_type="application/json")


@router.get("/{id}/plant", response_model=dict[str, JsonValue], responses=documented(404))
async def get_record_plant(request: Request, id: str, services: Use) -> Response:
    """Return the plant that was chosen for a record last, in full, so that a plant of one's own is not lost.

    Its texts have all their languages, as in a body that defines a plant.
    """
    record = await _found(request, services, id)
    if record.plant is None:
        raise Unknown(Message("record.no-plant"))
    return json_response(record.plant.model_dump(mode="json", context={"language": ALL}))


@router.delete("/{id}", status_code=204, responses=documented(403, 404))
def delete_record(request: Request, id: str, services: Use) -> Response:
    """Remove a record of this client; the file goes with the last of its owners."""
    gone = services.records.remove(id, principal_of(request.scope))
    audit(request, "record.removed" if gone else "record.given-up", record=id)
    return Response(status_code=204)


async def _found(request: Request, services: Services, id: str) -> RecordFile:
    return await run_in_threadpool(lambda: services.records.get(id, principal_of(request.scope)))


async def _inspection(request: Request, services: Services, record: RecordFile) -> RecordInspection:
    """Return the inspection of a file, made in a worker process. Raises InvalidSpec with row, column and cell."""
    from thetascope.assembly.analyses.record_inspection import inspect_file  # imports the engine

    given = (record.name, record.data, record.plant, record.mapping, record.id)
    try:
        return await computed(request, services, inspect_file, *given)
    except SpecError as error:
        raise from_engine(error) from None


def links(id: str) -> dict[str, str]:
    """Return the addresses of a record's parts."""
    base = f"/api/records/{id}"
    return {"self": base} | {
        part: f"{base}/{part}" for part in ("mapping", "plant", "preview", "diagnosis", "fit", "runs")
    }


def _with_id(inspection: RecordInspection, id: str) -> RecordInspection:
    return inspection.model_copy(update={"id": id, "links": links(id)})


def _answer(inspection: RecordInspection, language: str, status: int = 200) -> Response:
    headers = {"Location": f"/api/records/{inspection.id}"}
    return Response(encode(inspection, language), status, headers, "application/json")
