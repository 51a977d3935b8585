"""/api/mysteries: records with a hidden fault, or none. What is hidden is sent with the points of an answer only."""

import re

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.computed import computed_for_library
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Use
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Unknown, from_engine
from thetascope_schemas.service.learning.challenge import ChallengeAnswer
from thetascope_schemas.service.learning.mystery import MYSTERY_SEED, Mystery, MysterySolution

router = APIRouter(prefix="/mysteries", tags=["lessons"])
_LONGEST = 80


@router.get("/{seed}", response_model=Mystery, responses=documented(404, 429))
async def get_mystery(request: Request, services: Use, seed: str) -> Response:
    """Return the record of a seed, and what may have happened in it. The same seed returns the same record."""
    from thetascope.challenge.mystery import mystery_by

    _check(seed)
    answer = await computed_for_library(request, services, mystery_by, seed)
    return Response(encode(answer, "*"), media_type="application/json")


@router.post(
    "/{seed}/answer",
    response_model=MysterySolution,
    openapi_extra=body_schema("ChallengeAnswer"),
    responses=documented(404, 413, 415, 422, 429),
)
async def answer_mystery(request: Request, services: Use, language: Language, seed: str) -> Response:
    """Grade an answer, and return it with the truth, the detector's answer, and the experiment to open it live."""
    from thetascope.challenge.mystery import solution_by

    _check(seed)
    given = await parsed_as(request, services, ChallengeAnswer)
    try:
        answer = await computed_for_library(request, services, solution_by, seed, given)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(answer, language), media_type="application/json")


def _check(seed: str) -> None:
    if not re.fullmatch(MYSTERY_SEED, seed):
        raise Unknown(Message("mystery.unknown", seed=seed[:_LONGEST]))
