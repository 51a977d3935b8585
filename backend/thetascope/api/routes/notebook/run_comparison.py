"""/api/runs/compare: settings in which runs differ, their measures, and their curves overlaid."""

from typing import Annotated, Literal
from urllib.parse import urlencode

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.answers import from_result, json_response
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.services import Services, Use
from thetascope.api.routes.notebook.run_lines import labelled, run_line
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished
from thetascope.runs.notebook.comparison import compare_runs, differences, measures, parse_ids
from thetascope.runs.specs.refusals import NotReady
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.service.answers import PlotlyFigure
from thetascope_schemas.service.notebook.comparison import RunComparison

router = APIRouter(prefix="/runs/compare", tags=["runs"])

Ids = Annotated[str, Query(max_length=400, description="Ids of two to six runs, separated by commas.")]
Observer = Annotated[
    str | None, Query(max_length=40, description="Label of the observer that is compared; default: the first.")
]


@router.get("", response_model=RunComparison, responses=documented(404, 409, 422, 429))
async def compare(request: Request, services: Use, language: Language, ids: Ids, observer: Observer = None) -> Response:
    """Compare two to six runs: settings in which they differ from the first, and measures of an observer of each."""
    by = principal_of(request.scope)
    runs = await _finished(request, services, ids)
    compared = compare_runs([run.snapshot for run in runs], observer)
    lines = [await run_in_threadpool(services.notebook.line, run.snapshot.id, by) for run in runs]
    found = differences(compared)
    asked = urlencode({"ids": ids} | ({} if observer is None else {"observer": observer}))
    return json_response(
        {
            "runs": [run_line(services, line, by, language) for line in lines],
            "observers": compared.labels,
            "differences": [row | {"label": labelled(row["label"], language)} for row in found["differences"]],
            "same": found["same"],
            "measures": [row | {"label": labelled(row["label"], language)} for row in measures(compared)],
            "links": {"figure": f"/api/runs/compare/figure?{asked}"},
        }
    )


@router.get("/figure", response_model=PlotlyFigure, responses=documented(404, 409, 422, 429))
async def overlay_runs(
    request: Request,
    services: Use,
    language: Language,
    ids: Ids,
    observer: Observer = None,
    theme: Literal["light", "dark"] = "light",
) -> Response:
    """Return faults and states that all runs have, each run in a colour, as Plotly's JSON."""
    from thetascope.figures.figure_data import FigureData
    from thetascope.figures.overlaid import NothingInCommon, OverlaidRun, overlay

    by = principal_of(request.scope)
    runs = await _finished(request, services, ids)
    compared = compare_runs([run.snapshot for run in runs], observer)

    def draw() -> dict:
        drawn = []
        for run, label in zip(runs, compared.labels, strict=True):
            line = services.notebook.line(run.snapshot.id, by)
            spec = run.snapshot.spec
            record = spec.truth.record.name if spec.truth.record is not None else ""
            data = FigureData(run.result, spec, plant_of(spec.plant), theme, language)
            drawn.append(OverlaidRun(data, line.name or record or f"r-{run.snapshot.id[:4]}", label))
        try:
            return overlay(drawn, theme)
        except NothingInCommon:
            raise NotReady(Message("run.compare-no-curves")) from None

    return json_response(await run_in_threadpool(draw))


async def _finished(request: Request, services: Services, ids: str) -> list[Finished]:
    """Return the runs with their results. Raises Unknown, InvalidSpec, or NotReady."""
    return [await from_result(request, services, id, lambda run: run) for id in parse_ids(ids)]
