"""/api/equations: the equations of a plant and of observers, as MathML."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.request_bodies import EquationsRequest
from thetascope.api.http.services import Use
from thetascope.assembly.analyses.equations import equations_of
from thetascope.engine.observers.registry import kinds
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.service.answers import Equations

router = APIRouter(tags=["equations"])


@router.get("/equations/{id}", response_model=Equations, responses=documented(404))
def get_equations(id: str, language: Language) -> Response:
    """Return the equations of a library plant and of every kind of observer."""
    return json_response(equations_of(plant_of(id), kinds(), language))


@router.post(
    "/equations",
    response_model=Equations,
    openapi_extra=body_schema("EquationsRequest"),
    responses=documented(404, 413, 415, 422),
)
async def post_equations(request: Request, services: Use, language: Language) -> Response:
    """Return the equations of a plant (in full, or a library id) and of the named kinds of observers (default: all)."""
    asked = await parsed_as(request, services, EquationsRequest)
    chosen = kinds() if asked.observers is None else asked.observers
    return json_response(await computed(request, services, equations_of, plant_of(asked.plant), chosen, language))
