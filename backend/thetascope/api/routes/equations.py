"""/api/equations: the equations of a plant and of observers, as MathML."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.answers import json_response
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import parsed
from thetascope.api.http.services import Use
from thetascope.engine.language.render.mathml import math, plant_equations
from thetascope.engine.language.render.unicode_math import notation
from thetascope.engine.observers.registry import kinds, observer
from thetascope.messages import text_of
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.experiment.base import Strict
from thetascope_schemas.experiment.experiment import PlantChoice
from thetascope_schemas.experiment.observers import Kind
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.answers import Equations
from thetascope_schemas.texts.local_text import in_language

router = APIRouter(tags=["equations"])


class Question(Strict):
    """The plant and the observers whose equations are requested."""

    plant: PlantChoice
    observers: tuple[Kind, ...] | None = None


@router.get("/equations/{id}", response_model=Equations, responses=documented(404))
def get_equations(id: str, language: Language) -> Response:
    """Return the equations of a library plant and of every kind of observer."""
    return json_response(_answer(plant_of(id), kinds(), language))


@router.post("/equations", response_model=Equations, responses=documented(404, 413, 415, 422))
async def post_equations(request: Request, services: Use, language: Language) -> Response:
    """Return the equations of a plant (in full, or a library id) and of the named kinds of observers (default: all)."""

    def answer(data: Any) -> dict[str, Any]:
        question = validated(Question, data)
        plant = plant_of(question.plant)
        return _answer(plant, kinds() if question.observers is None else question.observers, language)

    return json_response(await parsed(request, services.settings.max_body, answer))


def _answer(plant: Plant, chosen: tuple[str, ...], language: str) -> dict[str, Any]:
    channels = [
        {"name": c.name, "title": in_language(c.title, language), "kind": c.kind, "unit": c.unit}
        for c in plant.channels
    ]
    return {
        "plant": {
            "id": plant.id,
            "title": in_language(plant.title, language),
            "source": in_language(plant.source, language),
            "time": plant.time.kind,
            "channels": channels,
            **plant_equations(plant.model_dump(mode="json", context={"language": language})),
        },
        "observers": {kind: _observer(kind, language) for kind in dict.fromkeys(chosen)},
    }


def _observer(kind: str, language: str) -> dict[str, Any]:
    made = observer(kind)
    return {
        "title": text_of(made.title, language),
        "source": text_of(made.source, language),
        "equations": [{"number": number, "math": math(notation(text))} for number, text in made.equations],
        "where": [{"math": math(notation(sign)), "text": text_of(text, language)} for sign, text in made.where],
    }
