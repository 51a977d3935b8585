"""/api/equations: a plant's equations, and those of observers, as MathML."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.answers import json_response
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import parsed
from thetascope.api.http.services import Use
from thetascope.engine.language.render.mathml import math, plant_equations
from thetascope.engine.language.render.unicode_math import notation
from thetascope.engine.observers.registry import kinds, observer
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.experiment.base import Strict
from thetascope_schemas.experiment.experiment import PlantChoice
from thetascope_schemas.experiment.observers import Kind
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.answers import Equations

router = APIRouter(tags=["equations"])


class Question(Strict):
    """Whose equations are asked for."""

    plant: PlantChoice
    observers: tuple[Kind, ...] | None = None


@router.get("/equations/{id}", response_model=Equations, responses=documented(404))
def get_equations(id: str) -> Response:
    """The equations of a library plant and of every kind of observer."""
    return json_response(_answer(plant_of(id), kinds()))


@router.post("/equations", response_model=Equations, responses=documented(404, 413, 415, 422))
async def post_equations(request: Request, services: Use) -> Response:
    """The equations of a plant (in full, or a library id) and of the kinds of observers that are named (all, if none)."""

    def answer(data: Any) -> dict[str, Any]:
        asked = validated(Question, data)
        plant = plant_of(asked.plant)
        return _answer(plant, kinds() if asked.observers is None else asked.observers)

    return json_response(await parsed(request, services.settings.max_body, answer))


def _answer(plant: Plant, chosen: tuple[str, ...]) -> dict[str, Any]:
    channels = [{"name": c.name, "title": c.title, "kind": c.kind, "unit": c.unit} for c in plant.channels]
    return {
        "plant": {
            "id": plant.id,
            "title": plant.title,
            "source": plant.source,
            "time": plant.time.kind,
            "channels": channels,
            **plant_equations(plant.model_dump(mode="json")),
        },
        "observers": {kind: _observer(kind) for kind in dict.fromkeys(chosen)},
    }


def _observer(kind: str) -> dict[str, Any]:
    made = observer(kind)
    return {
        "title": made.title,
        "source": made.source,
        "equations": [{"number": number, "math": math(notation(text))} for number, text in made.equations],
        "where": [{"math": math(notation(sign)), "text": text} for sign, text in made.where],
    }
