"""The service: `create_app(settings)` creates the ASGI application, `serve(settings)` runs it."""

import asyncio
import os
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from importlib import import_module
from socket import socket
from threading import Thread
from typing import TYPE_CHECKING

from fastapi import APIRouter, FastAPI
from starlette.concurrency import run_in_threadpool

from thetascope import __version__, library
from thetascope.access.gate import Gate
from thetascope.api.http import openapi, problems, static_pages
from thetascope.api.http.browser_security import Security
from thetascope.api.http.hosts import AllowedHosts
from thetascope.api.http.language import ContentLanguage
from thetascope.api.http.services import Services
from thetascope.api.operation import health, log_format
from thetascope.api.operation.metrics import Metrics
from thetascope.api.operation.request_log import RequestLog
from thetascope.api.processes.from_router import FromRouter
from thetascope.api.processes.others import port_of, socket_of
from thetascope.api.routes import (
    catalogue,
    messages,
    my_plants,
    plants,
    record_files,
    records,
    run_results,
    runs,
    sessions,
    studies,
)
from thetascope.api.routes.classroom import launches, seats, teacher
from thetascope.api.routes.figures import printed_figures
from thetascope.api.routes.learning import course, my_lessons, mysteries, papers, questions
from thetascope.api.routes.models import equations, gain_defaults, plant_trial, signal_curve
from thetascope.api.routes.notebook import run_comparison, run_lines
from thetascope.api.sign_in.require_key import RequireKey
from thetascope.classroom.lti.tool import prepared
from thetascope.engine.compiler import cache
from thetascope.server import connections, prewarm
from thetascope.server.started import Started, started_at
from thetascope.settings import Settings, load
from thetascope.store import Database

if TYPE_CHECKING:
    import uvicorn

DESCRIPTION = """Adaptive observers finding faults: plants as text, experiments as data, runs by the hash of their spec.

Start with `GET /api/experiments`, then `POST /api/runs` with `{"experiment": "zhao-2012"}`. Every error is a
problem document (RFC 9457) that names the field, the value and the remedy."""


_PATIENCE = 3
"""Seconds that open connections have at the end of the service."""
_WARM = 2
"""Workers that wait for their first computation."""


def create_app(settings: Settings | None = None, database: Database | None = None) -> FastAPI:
    """Return the application. Its store is opened at startup, if it is not given, and closed at shutdown.

    Raises SettingsError.
    """
    settings = settings or load()
    if settings.lti:
        prepared(settings)  # what is wrong is said before the service starts
    metrics = Metrics()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        app.state.services = Services.start(settings, database, metrics.run_ended)
        metrics.watch(app.state.services)
        Thread(target=_warm, args=(app.state.services,), name="warm", daemon=True).start()
        yield
        await run_in_threadpool(app.state.services.close)

    app = FastAPI(
        title="Thetascope",
        description=DESCRIPTION,
        version=__version__,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
    )
    app.state.gate = Gate(settings)
    app.add_middleware(RequireKey, gate=app.state.gate, settings=settings)
    app.add_middleware(ContentLanguage)
    app.state.hosts = AllowedHosts(settings.hosts, settings.host, settings.origins)
    forms = launches.CROSS_SITE if settings.lti else frozenset[str]()
    app.add_middleware(Security, hosts=app.state.hosts, forms=forms)
    app.add_middleware(RequestLog, metrics=metrics)  # the outermost: it sees every request and answer
    app.state.metrics = metrics
    problems.install(app)
    openapi.install(app)
    app.include_router(_api())
    app.include_router(health.metrics_router)
    app.include_router(static_pages.router)
    static_pages.serve_frontend(app)
    return app


def _warm(services: Services) -> None:
    """Load the modules of the first run after the service has started, so that its user does not wait for them."""
    time.sleep(0.3)
    if services.settings.prepare:
        services.workers.warm(_WARM)
    import_module("thetascope.assembly")
    library.experiments()


def _api() -> APIRouter:
    api = APIRouter(prefix="/api")

    for part in (
        health,
        catalogue,
        plants,
        plant_trial,
        equations,
        gain_defaults,
        signal_curve,
        questions,
        course,
        mysteries,
        papers,
        my_lessons,
        messages,
        my_plants,
        record_files,
        records,
        run_lines,
        run_comparison,
        runs,
        run_results,
        studies,
        printed_figures,
        sessions,
        teacher,
        seats,
        launches,
    ):
        api.include_router(part.router)

    return api


def serve(settings: Settings, ready: Callable[[Started], None] = lambda started: None) -> None:
    """Serve until interrupted; `ready` is called as soon as requests are answered.

    Raises StoreError, FolderRefused or SettingsError before listening if the store, the cache or the access key
    cannot be used.
    """
    import uvicorn

    log_format.install(settings)
    cache.folder()
    database = Database.for_service(settings.store, bool(settings.read_only))
    app = create_app(settings, database)
    gate: Gate = app.state.gate
    key = gate.file.ensured()[1] if gate.expects_others else None
    notes = connections.Notes()

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket] | None = None) -> None:
            connections.watch(asyncio.get_running_loop(), notes)
            await super().startup(sockets)
            if self.started:
                port = 0 if settings.sockets else self.servers[0].sockets[0].getsockname()[1]
                ready(started_at(settings, port, key, gate))

        async def shutdown(self, sockets: list[socket] | None = None) -> None:
            """End what is computed first, so that the requests that wait for it are answered."""
            app.state.services.live.stop()
            await run_in_threadpool(app.state.services.end_computations)
            await super().shutdown(sockets)

    beside = prewarm.begin() if settings.prepare and settings.owns_store else None
    try:
        Server(_configured(app, settings, notes)).run()
    finally:
        database.close()
        prewarm.end(beside)


def _configured(app: FastAPI, settings: Settings, notes: connections.Notes) -> "uvicorn.Config":
    """Return how the application is served: on a port, or behind the router on a socket."""
    import uvicorn
    from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

    number, behind_router = settings.process or 0, bool(settings.sockets)
    trusted = os.environ.get("FORWARDED_ALLOW_IPS", "127.0.0.1")  # uvicorn's own variable and default
    return uvicorn.Config(
        FromRouter(ProxyHeadersMiddleware(app, trusted)) if behind_router else app,  # type: ignore[arg-type]
        proxy_headers=not behind_router,
        http=connections.protocol(connections.allowed(settings.connections), notes),
        uds=socket_of(settings.sockets, number) if behind_router else None,
        host=settings.host,
        port=port_of(settings, number),
        log_config=None,
        access_log=False,
        server_header=False,
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        ws_max_size=4 * settings.max_message,
        timeout_graceful_shutdown=_PATIENCE,
    )
