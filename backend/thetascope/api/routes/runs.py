"""/api/runs: start runs, follow their progress, cancel, pin and remove them. The list is in notebook/."""

import asyncio
from contextlib import suppress
from typing import Annotated

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.answers import ended, progress_response, run_response
from thetascope.api.http.computed import check_cpu, first_of, limits_for
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.runs.jobs.job import Job, Snapshot
from thetascope.runs.specs.run_requests import parse_request
from thetascope.store import Damaged
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.run import Progress, Run

router = APIRouter(prefix="/runs", tags=["runs"])

Wait = Annotated[
    float | None, Query(ge=0, description="Longest wait in s for the run's end; the server has a default.")
]


@router.post(
    "",
    status_code=201,
    response_model=Run,
    openapi_extra=body_schema("Experiment", "RunRequest"),
    responses={
        200: {"model": Run, "description": "The same spec was run before: its run."},
        201: {"description": "The run is done."},
        202: {
            "model": Progress,
            "description": "The run takes longer: `Location` is the run, `links.progress` how far.",
        },
        **documented(404, 413, 415, 422, 429, 503),
    },
)
async def create_run(request: Request, services: Use, language: Language, wait: Wait = None) -> Response:
    """Run an experiment: a full spec, or `{"experiment": id, "set": {path: value}}`.

    The run's id is the hash of the spec, so posting the same spec again returns the stored run.
    """
    check_cpu(request, services)
    by, most = principal_of(request.scope), limits_for(request, services).runs

    def submit(spec: Experiment) -> Snapshot | Job:
        return services.runs.submit(spec, by, most)

    return await answered(request, services, language, await parsed(request, services, parse_request, submit), wait)


async def answered(
    request: Request, services: Services, language: str, started: Snapshot | Job, wait: float | None = None
) -> Response:
    """Return the answer to a request for a run that was submitted: the run, or its progress if it takes longer."""
    settings = services.settings
    if isinstance(started, Snapshot):
        return run_response(started, language)
    try:
        future = asyncio.wrap_future(started.done)
        if await first_of(request, future, settings.wait if wait is None else min(wait, settings.max_wait)):
            return run_response(await run_in_threadpool(services.runs.written, future.result()), language, 201)
        await run_in_threadpool(services.runs.announce, started)
    finally:
        await run_in_threadpool(services.runs.leave, started)
    return progress_response(started.snapshot(), language, 202)


@router.get("/{id}", response_model=Run, responses=documented(404))
def get_run(id: str, services: Use, language: Language) -> Response:
    """Return a run: its status, spec and summary."""
    return run_response(services.runs.get(id), language)


@router.get("/{id}/progress", response_model=Progress, responses=documented(404))
async def get_progress(id: str, services: Use, language: Language, wait: Wait = 0.0) -> Response:
    """Return the progress of a run. With `wait`, the answer is delayed until the run ends or the time has passed."""
    job = services.runs.job(id)
    if job is not None and wait:
        await ended(job, min(wait, services.settings.max_wait))
    return progress_response(await run_in_threadpool(services.runs.get, id), language)


@router.post("/{id}/cancel", response_model=Run, responses=documented(403, 404, 409))
def cancel_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Request an active run to stop. It goes on while others own it; a run that has ended stays unchanged."""
    snapshot = services.runs.cancel(id, principal_of(request.scope))
    audit(request, "run.cancelled", run=id, status=snapshot.status)
    return run_response(snapshot, language)


_STAYS = {"model": Run, "description": "It stays for others who asked for the same experiment."}


@router.delete("/{id}", status_code=204, responses={200: _STAYS, 202: {"model": Run}, **documented(403, 404, 409)})
def delete_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Cancel an active run (202), or remove one that has ended, with its spec and result (204).

    All who asked for the same experiment own its run; it goes when the last of them removes it. POST …/restore brings
    it back within ten minutes.
    """
    by = principal_of(request.scope)
    snapshot = None
    with suppress(Damaged):  # a run that cannot be read is not active, and can be removed
        snapshot = services.runs.cancel(id, by)
    if snapshot is not None and snapshot.active:
        audit(request, "run.cancelled", run=id, status=snapshot.status)
        return run_response(snapshot, language, 202)
    gone = services.notebook.remove(id, by)
    audit(request, "run.removed" if gone else "run.given-up", run=id)
    return Response(status_code=204) if gone else run_response(services.runs.get(id), language)


@router.put("/{id}/pin", response_model=Run, responses=documented(403, 404, 409))
@router.post("/{id}/pin", response_model=Run, responses=documented(403, 404, 409))
def pin_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Keep the run's result even when the store needs space."""
    pinned = services.runs.pin(id, True, principal_of(request.scope))
    audit(request, "run.pinned", run=id)
    return run_response(pinned, language)


@router.delete("/{id}/pin", response_model=Run, responses=documented(403, 404, 409))
def unpin_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Allow the store to drop the run's result when it needs space, if nobody else owns the run."""
    unpinned = services.runs.pin(id, False, principal_of(request.scope))
    audit(request, "run.unpinned", run=id)
    return run_response(unpinned, language)
