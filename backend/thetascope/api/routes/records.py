"""/api/diagnosis and /api/records/…/diagnosis: diagnose a record; /api/observability: can faults be told apart?"""

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.computed import computed, limits_for
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.api.routes.record_files import record_in
from thetascope.api.routes.runs import Wait, answered
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.runs.records.record_answers import answer_key
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.resolve_spec import plant_of, resolved
from thetascope_schemas.experiment.diagnosis import Observability
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.record import RecordRunRequest
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis, RecordDiagnosisRequest, RecordFit
from thetascope_schemas.service.run import Progress, Run

router = APIRouter(tags=["diagnosis"])
Answer = TypeVar("Answer")


@router.post(
    "/diagnosis",
    response_model=RecordDiagnosis,
    openapi_extra=body_schema("Record", yaml=False),
    responses=documented(404, 413, 415, 422),
)
async def diagnose_record(request: Request, services: Use, language: Language) -> Response:
    """Diagnose a record that is not stored: does the model fit, and which faults does it show?"""
    from thetascope.assembly.analyses.record_diagnosis import diagnose_file  # imports the engine

    name, data, record = await record_in(request, services)
    given = (name, data, plant_of(record.plant), record.mapping, record.settings)
    return await _computed(request, services, language, diagnose_file, *given)


@router.post(
    "/records/{id}/diagnosis",
    response_model=RecordDiagnosis,
    openapi_extra=body_schema("RecordDiagnosisRequest"),
    responses=documented(404, 413, 415, 422),
)
async def diagnose_stored_record(request: Request, id: str, services: Use, language: Language) -> Response:
    """Diagnose a stored record: does the model fit, and which faults does it show?

    Faults are only named where the model fits the healthy stretch; else the answer says what would help.
    """
    from thetascope.assembly.analyses.record_diagnosis import diagnose_file  # imports the engine

    given = await _given(request, services, id)
    key = answer_key(id, *given[2:])
    known = services.records.answers.get(key)
    if known is None:
        known = await _answer(request, services, diagnose_file, *given)
        services.records.answers.put(key, known)
    return Response(encode(known, language), media_type="application/json")


@router.post(
    "/records/{id}/fit",
    response_model=RecordFit,
    openapi_extra=body_schema("RecordDiagnosisRequest"),
    responses=documented(404, 413, 415, 422),
)
async def fit_stored_record(request: Request, id: str, services: Use, language: Language) -> Response:
    """Fit parameters of the plant on the healthy stretch of a stored record; return the fitted plant."""
    from thetascope.assembly.analyses.record_diagnosis import fit_file  # imports the engine

    given = await _given(request, services, id)
    return await _computed(request, services, language, fit_file, *given)


@router.post(
    "/records/{id}/runs",
    status_code=201,
    response_model=Run,
    openapi_extra=body_schema("RecordRunRequest"),
    responses={
        200: {"model": Run, "description": "The same was run before: its run."},
        202: {"model": Progress},
        **documented(404, 413, 415, 422, 429, 503),
    },
)
async def run_observers(request: Request, id: str, services: Use, language: Language, wait: Wait = None) -> Response:
    """Run observers on a stored record. The run has the record's diagnosis, figures, report, exports and a link.

    Observers get the plant as the diagnosis fitted it, with the noise and the first state that it found.
    """
    from thetascope.assembly import RecordBytes, record_experiment  # imports the engine

    asked = await parsed_as(request, services, RecordRunRequest)
    by, most = principal_of(request.scope), limits_for(request, services).runs
    plant, record = plant_of(asked.plant), await run_in_threadpool(lambda: services.records.get(id, by))
    key = answer_key(id, plant, asked.mapping, asked.settings)
    file = RecordBytes(record.name, record.data, services.records.answers.get(key))
    given = (id, file, plant, asked.mapping, asked.settings, asked.observers)
    try:
        spec, diagnosis = await computed(request, services, record_experiment, *given)
    except SpecError as error:
        raise from_engine(error) from None
    services.records.answers.put(key, diagnosis)
    started = await run_in_threadpool(lambda: services.runs.submit(spec, by, most))
    return await answered(request, services, language, started, wait)


@router.post(
    "/observability",
    response_model=Observability,
    openapi_extra=body_schema("Experiment"),
    responses=documented(404, 413, 415, 422),
)
async def observe(request: Request, services: Use, language: Language) -> Response:
    """Return how well the outputs determine states and faults: structural rank; rank and condition along the run."""
    from thetascope.assembly.analyses.observability_report import observability

    spec = await parsed(request, services, partial(validated, Experiment), resolved)
    spec = await run_in_threadpool(services.with_record, spec)
    try:
        report = await computed(request, services, observability, spec)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(report, language), media_type="application/json")


async def _given(request: Request, services: Services, id: str) -> tuple:
    """Return name and bytes of a stored record, and the plant, mapping and settings that were posted."""
    asked = await parsed_as(request, services, RecordDiagnosisRequest)
    plant = plant_of(asked.plant)
    record = await run_in_threadpool(lambda: services.records.get(id, principal_of(request.scope)))
    return record.name, record.data, plant, asked.mapping, asked.settings


async def _computed(request: Request, services: Services, language: str, work, *given) -> Response:
    """Return the answer of work that is done in a worker process."""
    answer = await _answer(request, services, work, *given)
    return Response(encode(answer, language), media_type="application/json")


async def _answer(request: Request, services: Services, work: Callable[..., Answer], *given: object) -> Answer:
    """Return the value of work that is done in a worker process. Raises InvalidSpec."""
    try:
        return await computed(request, services, work, *given)
    except SpecError as error:
        raise from_engine(error) from None
