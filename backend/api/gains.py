"""/api/gains: the numbers that observers run with, their defaults filled in for the plant and its noise."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from backend.api.answers import json_response
from backend.api.bodies import body_schema, parsed
from backend.api.problems import documented
from backend.api.services import Use
from backend.runs.errors import validated
from shared.experiment import Experiment

router = APIRouter(tags=["catalogue"])


@router.post("/gains", response_model=None, openapi_extra=body_schema("Experiment"), responses=documented(413, 415, 422))
async def gains(request: Request, services: Use) -> Response:
    """Per observer of an experiment, every gain: what a form shows before anything is changed."""

    def answer(data: Any) -> dict[str, Any]:
        from backend.assembly.gains import present_gains  # SymPy comes with it, so the service starts without

        return {"gains": present_gains(validated(Experiment, data))}

    return json_response(await parsed(request, services.settings.max_body, answer))
