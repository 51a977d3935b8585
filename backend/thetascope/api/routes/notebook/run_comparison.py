"""/api/runs/compare: settings in which runs differ, their measures, and their curves overlaid."""

import asyncio
from typing import Annotated, Literal
from urllib.parse import urlencode

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import principal_of
from thetascope.api.http.answers import from_result, in_turn, json_response
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.api.routes.figures.printed_figures import PRINTED, printed_answer
from thetascope.api.routes.notebook.run_lines import labelled, run_line
from thetascope.runs.jobs.job import Finished
from thetascope.runs.notebook.comparison import choices, compare_runs, differences, measures, parse_ids
from thetascope.runs.printed_figure import Print
from thetascope_schemas.service.answers import PlotlyFigure
from thetascope_schemas.service.figures.printed_figure import OverlaidPrintSettings, PrintedFigure
from thetascope_schemas.service.notebook.comparison import ComparisonNotes, RunComparison

router = APIRouter(prefix="/runs/compare", tags=["runs"])

Ids = Annotated[str, Query(max_length=400, description="Ids of two to six runs, separated by commas.")]
Observer = Annotated[
    str | None, Query(max_length=40, description="Label of the observer that is compared; default: the first.")
]

Less = Annotated[bool, Query(description="Whether curves are the differences from the first run.")]


@router.get("", response_model=RunComparison, responses=documented(404, 409, 422, 429))
async def compare(request: Request, services: Use, language: Language, ids: Ids, observer: Observer = None) -> Response:
    """Compare two to six runs: settings in which they differ from the first, and measures of an observer of each."""
    by = principal_of(request.scope)
    runs = await _finished(request, services, ids)
    asked = urlencode({"ids": ids} | ({} if observer is None else {"observer": observer}))

    def make() -> Response:
        compared = compare_runs([run.snapshot for run in runs], observer)
        lines = [services.notebook.line(run.snapshot.id, by) for run in runs]
        notes, damage = services.notebook.comparison_notes(parse_ids(ids), by)
        found = differences(compared)
        answer = {
            "runs": [run_line(services, line, by, language) for line in lines],
            "observers": compared.labels,
            "choices": choices(compared),
            "notes": notes,
            "warning": "" if damage is None else damage.text(language),
            "differences": [row | {"label": labelled(row["label"], language)} for row in found["differences"]],
            "same": found["same"],
            "measures": [row | {"label": labelled(row["label"], language)} for row in measures(compared)],
            "links": {"figure": f"/api/runs/compare/figure?{asked}"},
        }
        return json_response(answer)

    return await in_turn(request, make)


@router.get("/figure", response_model=PlotlyFigure, responses=documented(404, 409, 422, 429))
async def overlay_runs(
    request: Request,
    services: Use,
    language: Language,
    ids: Ids,
    observer: Observer = None,
    less: Less = False,
    theme: Literal["light", "dark"] = "light",
) -> Response:
    """Return faults and states that at least two runs have, each run in a colour, as Plotly's JSON.

    A run that shares nothing with the others has a strip of its own.
    """
    from thetascope.figures.strips import stack
    from thetascope.figures.style import theme_named
    from thetascope.runs.notebook.overlaid_runs import overlaid_runs

    runs = await _finished(request, services, ids)

    def draw() -> dict:
        names = _names(request, services, runs)
        return stack(overlaid_runs(runs, names, observer, less, theme, language), theme_named(theme))

    return json_response(await in_turn(request, draw))


@router.get("/figure/print", response_model=PrintedFigure, responses={**PRINTED, **documented(404, 409, 422, 429, 503)})
async def print_overlaid_runs(
    request: Request, services: Use, settings: Annotated[OverlaidPrintSettings, Query()]
) -> Response:
    """Return the same curves as a figure for print, or its description: as `/api/runs/{id}/figures/{name}/print`."""
    from thetascope.runs.notebook.overlaid_runs import prepare_overlaid

    runs = await _finished(request, services, settings.ids)

    def make() -> Print:
        return prepare_overlaid(runs, _names(request, services, runs), settings, settings.observer, settings.less)

    return await printed_answer(request, services, await in_turn(request, make), settings)


@router.put(
    "/notes",
    response_model=ComparisonNotes,
    openapi_extra=body_schema("ComparisonNotes"),
    responses=documented(404, 413, 415, 422),
)
async def keep_notes(request: Request, services: Use, ids: Ids) -> Response:
    """Keep notes with the comparison of these runs, in whichever order; an empty text removes them."""
    notes = await parsed_as(request, services, ComparisonNotes)
    by = principal_of(request.scope)
    await run_in_threadpool(services.notebook.keep_comparison_notes, parse_ids(ids), by, notes.text)
    return json_response(notes.model_dump())


def _names(request: Request, services: Services, runs: list[Finished]) -> list[str]:
    """Return the names of runs in legends, those that this client gave them first."""
    from thetascope.runs.notebook.overlaid_runs import names_of

    by = principal_of(request.scope)
    return names_of(runs, lambda id: services.notebook.line(id, by).name)


async def _finished(request: Request, services: Services, ids: str) -> list[Finished]:
    """Return the runs with their results; all that the store has dropped are computed again at the same time.

    Raises Unknown, InvalidSpec, or NotReady.
    """
    return await asyncio.gather(*(from_result(request, services, id, lambda run: run) for id in parse_ids(ids)))
