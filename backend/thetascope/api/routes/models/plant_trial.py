"""/api/plants/trial, …/ranking, …/fault-patterns: an experiment, observers and faults that suit a plant."""

from collections.abc import Callable
from typing import Any, TypeVar

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.runs.specs.refusals import from_engine
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.plants.trial import (
    FaultPatternRequest,
    FaultPatterns,
    ObserverRanking,
    PlantTrial,
    PlantTrialRequest,
)

router = APIRouter(prefix="/plants", tags=["plants"])
Answer = TypeVar("Answer", PlantTrial, ObserverRanking)

_BODY = body_schema("PlantTrialRequest")
_REFUSALS = documented(404, 413, 415, 422, 429)


@router.post("/trial", response_model=PlantTrial, openapi_extra=_BODY, responses=_REFUSALS)
async def try_plant(request: Request, services: Use, language: Language) -> Response:
    """Return an experiment that suits a plant, and simulations of it: healthy, and with each fault of usual size."""
    from thetascope.assembly.workshop.answers import trial_of

    return await _answer(request, services, language, trial_of)


@router.post("/ranking", response_model=ObserverRanking, openapi_extra=_BODY, responses=_REFUSALS)
async def rank_observers(request: Request, services: Use, language: Language) -> Response:
    """Run the observers that can be built for a plant on such an experiment, and return them, the best first."""
    from thetascope.assembly.workshop.answers import ranking_of

    return await _answer(request, services, language, ranking_of)


@router.post(
    "/fault-patterns",
    response_model=FaultPatterns,
    openapi_extra=body_schema("FaultPatternRequest"),
    responses=_REFUSALS,
)
async def suggest_faults(request: Request, services: Use, language: Language) -> Response:
    """Return the faults that may act in the equation of a state or output: loss, leak, bias, gain, lag."""
    from thetascope.assembly.workshop.answers import patterns_of

    asked = await parsed_as(request, services, FaultPatternRequest)
    try:
        answer = await computed(request, services, patterns_of, plant_of(asked.plant), asked.name)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(answer, language), media_type="application/json")


async def _answer(
    request: Request, services: Services, language: str, work: Callable[[Plant, dict[str, Any]], Answer]
) -> Response:
    """Return the answer of work in a worker process on the posted plant."""
    asked = await parsed_as(request, services, PlantTrialRequest)
    changes = {"parameters": asked.parameters, "initial": asked.initial, "inputs": asked.inputs}
    try:
        answer = await computed(request, services, work, plant_of(asked.plant), changes)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(answer, language), media_type="application/json")
