"""/api/diagnosis and /api/records/…/diagnosis: diagnose a record; /api/observability: can faults be told apart?"""

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed
from thetascope.api.http.services import Services, Use
from thetascope.api.routes.record_files import record_bytes
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.resolve_spec import plant_of, resolved
from thetascope_schemas.experiment.diagnosis import Observability
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.record import Record
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis, RecordDiagnosisRequest, RecordFit

router = APIRouter(tags=["diagnosis"])


@router.post(
    "/diagnosis",
    response_model=RecordDiagnosis,
    openapi_extra=body_schema("Record"),
    responses=documented(404, 413, 415, 422),
)
async def diagnose_record(request: Request, services: Use, language: Language) -> Response:
    """Diagnose a record that is not stored: does the model fit, and which faults does it show?"""
    from thetascope.assembly.analyses.record_diagnosis import diagnose_file  # imports the engine

    record = await parsed(request, services.settings.max_record, lambda data: validated(Record, data))
    name, data = record_bytes(record)
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
    return await _computed(request, services, language, diagnose_file, *given)


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
    "/observability",
    response_model=Observability,
    openapi_extra=body_schema("Experiment"),
    responses=documented(404, 413, 415, 422),
)
async def observe(request: Request, services: Use, language: Language) -> Response:
    """Return how well the outputs determine states and faults: structural rank; rank and condition along the run."""
    from thetascope.assembly.analyses.observability_report import observability

    spec = await parsed(request, services.settings.max_body, lambda data: resolved(validated(Experiment, data)))
    try:
        report = await computed(request, services, observability, spec)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(report, language), media_type="application/json")


async def _given(request: Request, services: Services, id: str) -> tuple:
    """Return name and bytes of a stored record, and the plant, mapping and settings that were posted."""
    asked = await parsed(request, services.settings.max_body, lambda data: validated(RecordDiagnosisRequest, data))
    plant = plant_of(asked.plant)
    record = await run_in_threadpool(lambda: services.records.get(id, principal_of(request.scope)))
    return record.name, record.data, plant, asked.mapping, asked.settings


async def _computed(request: Request, services: Services, language: str, work, *given) -> Response:
    """Return the answer of work that is done in a worker process."""
    try:
        answer = await computed(request, services, work, *given)
    except SpecError as error:
        raise from_engine(error) from None
    return Response(encode(answer, language), media_type="application/json")
