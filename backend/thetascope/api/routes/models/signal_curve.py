"""/api/signals/curve: the curve of a signal, for pictures of inputs."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.answers import in_turn
from thetascope.api.http.computed import computed
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Use
from thetascope_schemas.service.figures.signal_curve import SignalCurve, SignalCurveRequest

router = APIRouter(tags=["catalogue"])


@router.post(
    "/signals/curve",
    response_model=SignalCurve,
    openapi_extra=body_schema("SignalCurveRequest"),
    responses=documented(413, 415, 422),
)
async def signal_curve(request: Request, services: Use) -> Response:
    """Return the points with which a figure draws a signal: an input, a reference or a known signal.

    The values are those that a run with this signal has.
    """

    from thetascope.assembly.build.signal_builder import (
        curve_of,
        takes_long,
    )  # imports SymPy, so the service starts without it

    asked = await parsed_as(request, services, SignalCurveRequest)
    if takes_long(asked):
        points = await computed(request, services, curve_of, asked)
    else:
        points = await in_turn(request, lambda: curve_of(asked))
    return Response(points.model_dump_json(), media_type="application/json")
