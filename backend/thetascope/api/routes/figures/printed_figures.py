"""/api/runs/{id}/figures/{name}/print: a figure of a run for print, and its description."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from starlette.responses import Response

from thetascope.api.http.answers import from_result
from thetascope.api.http.computed import computed
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.runs.jobs.job import Finished
from thetascope.runs.printed_figure import MEDIA_TYPES, Print, drawn, prepare
from thetascope_schemas.service.figures.printed_figure import PrintedFigure, PrintSettings

router = APIRouter(prefix="/runs/{id}", tags=["results"])

PRINTED = {200: {"content": {kind: {} for format, kind in MEDIA_TYPES.items() if format != "json"}}}


@router.get(
    "/figures/{name}/print", response_model=PrintedFigure, responses={**PRINTED, **documented(404, 409, 422, 429, 503)}
)
async def get_printed_figure(
    request: Request, id: str, name: str, services: Use, settings: Annotated[PrintSettings, Query()]
) -> Response:
    """Return a figure for print as PDF with embedded fonts, SVG, PNG of 600 dpi, TikZ with its data, or described.

    `format=json` describes it: curves and panels with their names, line styles, a caption, and the command that draws
    it again.
    """
    return await _answer(request, services, id, name, settings)


@router.post(
    "/figures/{name}/print",
    response_model=PrintedFigure,
    openapi_extra=body_schema("PrintSettings"),
    responses={**PRINTED, **documented(404, 409, 413, 415, 422, 429, 503)},
)
async def post_printed_figure(request: Request, id: str, name: str, services: Use) -> Response:
    """Return the same for options in the body."""
    settings = await parsed_as(request, services, PrintSettings)
    return await _answer(request, services, id, name, settings)


async def _answer(request: Request, services: Services, id: str, name: str, settings: PrintSettings) -> Response:
    def make(finished: Finished) -> Print:
        return prepare(finished, name, settings)

    return await printed_answer(request, services, await from_result(request, services, id, make), settings)


async def printed_answer(request: Request, services: Services, ready: Print, settings: PrintSettings) -> Response:
    """Return a figure as a file of its format, or its description."""
    page, description, filename = ready
    headers = {"Cache-Control": "private, no-cache"}
    if settings.format == "json":
        return Response(description.model_dump_json(), 200, headers, MEDIA_TYPES["json"])
    content = await computed(request, services, drawn, page, settings.format, filename)
    headers["Content-Disposition"] = f'attachment; filename="{filename}"'
    return Response(content, 200, headers, MEDIA_TYPES[settings.format])
