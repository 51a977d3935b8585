"""/api/gains: the gains of observers, with defaults computed for the plant and its noise."""

from functools import partial

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import computed
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed
from thetascope.api.http.services import Use
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.resolve_spec import resolved
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.answers import PresentGains

router = APIRouter(tags=["catalogue"])


@router.post(
    "/gains", response_model=PresentGains, openapi_extra=body_schema("Experiment"), responses=documented(413, 415, 422)
)
async def gains(request: Request, services: Use) -> Response:
    """Return every gain of every observer of an experiment, defaults filled in, with labels of rows and columns."""

    from thetascope.assembly.analyses.gains import present_gains  # imports SymPy, so the service starts without it

    spec = await parsed(request, services, partial(validated, Experiment), resolved)
    spec = await run_in_threadpool(services.with_record, spec)
    gains, labels = await computed(request, services, present_gains, spec)
    return json_response({"gains": gains, "labels": labels})
