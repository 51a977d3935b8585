"""/api/health: versions and usage; /live and /ready for whoever restarts or routes; /metrics for Prometheus."""

import shutil
from typing import Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope import __version__
from thetascope.api.http.answers import json_response
from thetascope.api.http.language import Language
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.metrics import CONTENT_TYPE, Metrics
from thetascope.messages import Message
from thetascope.runs.results.engine_version import engine_version
from thetascope.store import StoreError
from thetascope_schemas.experiment.base import SCHEMA_VERSION
from thetascope_schemas.service.health import Alive, Health, Ready

router = APIRouter(prefix="/health", tags=["service"])
metrics_router = APIRouter(tags=["service"])

_LEAST_DISK = 64 * 1024**2
"""Free bytes in the folder of the store below which the service is not ready."""


@router.get("", response_model=Health)
def health(services: Use) -> Response:
    """Return the versions of program, schemas and numbers, and how much is stored and computed."""
    versions = {"version": __version__, "schema_version": SCHEMA_VERSION, "engine": engine_version()}
    usage = {"runs": services.runs.usage(), "workers": services.workers.usage()}
    return json_response({"status": "ok", **versions, **usage})


@router.get("/live", response_model=Alive)
async def live() -> Response:
    """Return that the service answers. Where it does not, restart it."""
    return json_response({"status": "alive"})


@router.get("/ready", response_model=Ready, responses={503: {"model": Ready}})
async def ready(services: Use, language: Language) -> Response:
    """Return whether the service accepts work: the store can be used, the disk has space, the queue has room."""
    checks, free = await run_in_threadpool(_checks, services, language)
    well = all(check["ok"] for check in checks)
    body = {"status": "ready" if well else "not ready", "checks": checks, "free": free}
    return json_response(body, 200 if well else 503)


@metrics_router.get("/metrics", response_class=Response, responses={200: {"content": {"text/plain": {}}}})
async def metrics(request: Request) -> Response:
    """Return queue, runs and computations by outcome, latencies, sessions, late frames and memory, for Prometheus."""
    collected: Metrics = request.app.state.metrics
    return Response(await run_in_threadpool(collected.text), media_type=CONTENT_TYPE)


def _checks(services: Services, language: str) -> tuple[list[dict[str, Any]], int]:
    """Return the conditions for accepting work, and the free bytes of the disk."""
    data = services.settings.data.absolute()
    free = shutil.disk_usage(next(place for place in (data, *data.parents) if place.exists())).free
    active, room = services.runs.queue()
    try:
        if services.database.read_only:
            with services.database.reading():
                stored = Message("health.store.readable")
        else:
            with services.database.writing():
                stored = Message("health.store.writable")
        usable = True
    except StoreError as error:
        stored, usable = error.problem, False
    return [
        {"name": "store", "ok": usable, "detail": stored.text(language)},
        {"name": "disk", "ok": free >= _LEAST_DISK, "detail": Message("health.disk", bytes=free).text(language)},
        {"name": "queue", "ok": active < room, "detail": Message("health.queue", n=active, room=room).text(language)},
    ], free
