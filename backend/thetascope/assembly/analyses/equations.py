"""The equations of a plant and of observers, as MathML."""

from typing import Any

from thetascope.engine.language.render.mathml import math, plant_equations
from thetascope.engine.language.render.unicode_math import notation
from thetascope.engine.observers.registry import observer
from thetascope.messages import text_of
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.texts.local_text import in_language


def equations_of(plant: Plant, chosen: tuple[str, ...], language: str) -> dict[str, Any]:
    """Return the equations of a plant and of the chosen kinds of observers as data, with sentences in a language."""
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
