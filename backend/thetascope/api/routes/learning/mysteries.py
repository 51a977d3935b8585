"""/api/mysteries: records with a hidden fault, or none. What is hidden is sent with the points of an answer only."""

import re
from typing import Annotated

from fastapi import APIRouter, Query, Request
from starlette.responses import Response

from thetascope import library
from thetascope.api.http.answers import json_response
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
from thetascope_schemas.service.learning.mystery import MYSTERY_SEED, Mystery, MysterySetups, MysterySolution

router = APIRouter(prefix="/mysteries", tags=["lessons"])
_LONGEST = 80
Setup = Annotated[str | None, Query(max_length=64, description="Id of a set-up; default: the seed draws it, too.")]


@router.get("", response_model=MysterySetups)
def list_mystery_setups() -> Response:
    """Return the plants with which mysteries are drawn, those with the fewest suspects first."""
    setups = sorted(library.mysteries().values(), key=lambda setup: len(setup.suspects))
    lines = [{"id": s.id, "title": s.title.model_dump(), "suspects": len(s.suspects)} for s in setups]
    return json_response({"setups": lines})


@router.get("/{seed}", response_model=Mystery, responses=documented(404, 422, 429))
async def get_mystery(request: Request, services: Use, seed: str, setup: Setup = None) -> Response:
    """Return the record of a seed, and what may have happened in it. The same seed returns the same record."""
    from thetascope.challenge.mystery import mystery_by

    _check(seed, setup)
    answer = await computed_for_library(request, services, mystery_by, seed, setup)
    return Response(encode(answer, "*"), media_type="application/json")


@router.post(
    "/{seed}/answer",
    response_model=MysterySolution,
    openapi_extra=body_schema("ChallengeAnswer"),
    responses=documented(404, 413, 415, 422, 429),
)
async def answer_mystery(
    request: Request, services: Use, language: Language, seed: str, setup: Setup = None
) -> Response:
    """Grade an answer, and return it with the truth, the detector's answer, and the experiment to open it live."""
    from thetascope.challenge.mystery import solution_by

    _check(seed, setup)
    given = await parsed_as(request, services, ChallengeAnswer)
    try:
        answer = await computed_for_library(request, services, solution_by, seed, setup, given)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(answer, language), media_type="application/json")


def _check(seed: str, setup: str | None) -> None:
    if not re.fullmatch(MYSTERY_SEED, seed):
        raise Unknown(Message("mystery.unknown", seed=seed[:_LONGEST]))
    if setup is not None and setup not in library.mysteries():
        raise Unknown(Message("mystery.setup.unknown", id=setup[:_LONGEST]))
