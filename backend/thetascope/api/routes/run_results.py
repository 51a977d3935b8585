"""/api/runs/{id}/data, /comparison, /figures and /report: the results of a run."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request
from starlette.responses import HTMLResponse, Response, StreamingResponse

from thetascope.api.http.answers import (
    from_result,
    in_pieces,
    in_turn,
    json_response,
    kept_until_sent,
    pieces_in_turn,
    run_links,
)
from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.services import Services, Use
from thetascope.api.routes import table_query
from thetascope.export import (
    MEDIA_TYPES,
    Table,
    comparison_csv,
    csv_chunks,
    json_chunks,
    matlab_bytes,
    notebook_bytes,
    parquet_bytes,
    select,
)
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished
from thetascope.runs.results.comparison_rows import compared
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.run_report import observed, report_with
from thetascope.runs.specs.refusals import Unknown, invalid
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope.runs.workers.limits import LimitReached
from thetascope_schemas.experiment.diagnosis import Observability
from thetascope_schemas.service.answers import FigureList, PlotlyFigure
from thetascope_schemas.service.comparison import Comparison
from thetascope_schemas.texts.refusal import suggestion

router = APIRouter(prefix="/runs/{id}", tags=["results"])

REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; font-src data:; "
    "frame-ancestors 'self'; sandbox allow-scripts allow-downloads"
)
"""The report contains its script. A sandbox separates it from the program's origin, which it cannot access."""


@router.get(
    "/data",
    response_class=Response,
    responses={
        200: table_query.tables("csv", "json", "mat", "parquet"),
        304: {"description": "Unchanged."},
        **documented(404, 409, 422, 429),
    },
)
async def get_data(
    request: Request,
    id: str,
    services: Use,
    format: Literal["csv", "json", "mat", "parquet"] = "csv",
    encoding: Annotated[Literal["plain", "bdata"], Query(description="json: numbers, or base64 of float64.")] = "plain",
    columns: table_query.Names = None,
    start: table_query.First = None,
    end: table_query.Last = None,
    every: Annotated[int, Query(ge=1, description="Return every n-th row.")] = 1,
    points: Annotated[int | None, Query(ge=1, description="Return at most this many rows, evenly spaced.")] = None,
) -> Response:
    """Return the recorded columns as CSV, JSON, Parquet or MATLAB .mat (where dots in names become underscores).

    Numbers read back to exactly the same float64. Missing values (after a divergence, in the gaps of a record) are
    `nan` in CSV and null in JSON and Parquet.
    """
    table_query.check(start, end)
    tag = f'"{id}-{engine_version()}"'
    headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
    names = columns.split(",") if columns else None

    def make(finished: Finished) -> Response:
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        table = select(finished.result, names, start, end, every, points)
        filename = f"{finished.snapshot.spec.id}-{id[:8]}.{format}"
        headers["Content-Disposition"] = f'attachment; filename="{filename}"'
        return _written(request, table, format, encoding, headers)

    if format in ("csv", "json"):
        return await from_result(request, services, id, make)
    return await kept_until_sent(request, lambda: from_result(request, services, id, make))


@router.get(
    "/comparison", response_model=Comparison, responses={200: table_query.tables("csv"), **documented(404, 409, 429)}
)
async def get_comparison(request: Request, id: str, services: Use, format: Literal["csv", "json"] = "json") -> Response:
    """Compare the observers on the same data: errors between fault events, settling, faults found and missed, cost.

    The CSV has one measure per line. The cost is measured each time the run is computed; all other values are
    reproducible.
    """

    def make(finished: Finished) -> Response:
        spec = finished.snapshot.spec
        found = compared(finished.result, spec)
        name = f'attachment; filename="{spec.id}-{id[:8]}-comparison.{format}"'
        content = found.model_dump_json() if format == "json" else comparison_csv(found, plant_of(spec.plant))
        return Response(content, 200, {"Content-Disposition": name, "Cache-Control": "no-cache"}, MEDIA_TYPES[format])

    return await from_result(request, services, id, make)


@router.get("/figures", response_model=FigureList, responses=documented(404, 409, 429))
async def list_figures(request: Request, id: str, services: Use, language: Language) -> Response:
    """Return the available figures of this run: name, title and address."""
    from thetascope import figures

    def make(finished: Finished) -> Response:
        entries = figures.figure_names(finished.snapshot.spec, finished.result.names, language)
        base = run_links(id)["figures"]
        return json_response({"figures": [{**entry, "href": f"{base}/{entry['name']}"} for entry in entries]})

    return await from_result(request, services, id, make)


@router.get("/figures/{name}", response_model=PlotlyFigure, responses=documented(404, 409, 429))
async def get_figure(
    request: Request, id: str, name: str, services: Use, language: Language, theme: Literal["light", "dark"] = "light"
) -> Response:
    """Return one figure as Plotly's JSON: `{"data": […], "layout": {…}}`, arrays as base64 (`bdata`)."""
    from thetascope import figures

    def make(finished: Finished) -> Response:
        spec = finished.snapshot.spec
        try:
            return json_response(figures.figure(finished.result, spec, plant_of(spec.plant), name, theme, language))
        except figures.UnknownFigure as error:
            hint = Message.from_data(suggestion(name[:80], error.names))
            raise Unknown(Message("figure.unknown", name=name[:80]), hint) from None

    return await from_result(request, services, id, make)


@router.get(
    "/notebook",
    response_class=Response,
    responses={200: table_query.tables("ipynb"), **documented(404, 409, 422, 429)},
)
async def get_notebook(request: Request, id: str, services: Use) -> Response:
    """Return a Jupyter notebook that computes the run again and compares the numbers. Records have none."""

    def make(finished: Finished) -> Response:
        snapshot = finished.snapshot
        if finished.result.record is not None:
            raise invalid("id", id, Message("notebook.record"))
        name = f'attachment; filename="{snapshot.spec.id}-{id[:8]}.ipynb"'
        content = notebook_bytes(finished.result, snapshot.spec, id)
        return Response(content, 200, {"Content-Disposition": name}, MEDIA_TYPES["ipynb"])

    return await from_result(request, services, id, make)


@router.get("/report", response_class=HTMLResponse, responses=documented(404, 409, 429, 503))
async def get_report(
    request: Request,
    id: str,
    services: Use,
    language: Language,
    download: Annotated[bool, Query(description="Send the report as a download.")] = False,
) -> Response:
    """Return the run as one HTML file that opens offline, in the requested language."""
    finished = await from_result(request, services, id, lambda run: run)
    seen = await _observability(request, services, finished)

    def make() -> Response:
        place = "attachment" if download else "inline"
        headers = {
            "Content-Security-Policy": REPORT_POLICY,
            "Content-Disposition": f'{place}; filename="{finished.snapshot.spec.id}-{id[:8]}.html"',
        }
        return in_pieces(report_with(finished, seen, language).encode(), headers, "text/html; charset=utf-8")

    return await kept_until_sent(request, lambda: in_turn(request, make))


async def _observability(request: Request, services: Services, finished: Finished) -> Observability | None:
    """Return the observability that a report shows, computed in a worker; None if it takes more than it may.

    It simulates the run several times and derives the plant's equations, which takes long for large plants.
    """
    task = await in_turn(request, lambda: observed(finished))
    if task is None:
        return None
    try:
        return await computed(request, services, *task)
    except LimitReached:
        return None


def _written(request: Request, table: Table, format: str, encoding: str, headers: dict[str, str]) -> Response:
    """Return the table in the requested format; CSV and JSON are made as they are sent, and never in memory in full."""
    kind = MEDIA_TYPES[format]
    if format in ("csv", "json"):
        chunks = csv_chunks(table) if format == "csv" else json_chunks(table, encoding)
        return StreamingResponse(pieces_in_turn(request, chunks), 200, headers, kind)
    return in_pieces(parquet_bytes(table) if format == "parquet" else matlab_bytes(table), headers, kind)
