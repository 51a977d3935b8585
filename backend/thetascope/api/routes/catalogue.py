"""/api/catalogue: everything a form needs to know, from the schemas and the observers themselves."""

from functools import cache
from typing import Any, get_args

import orjson
from fastapi import APIRouter
from pydantic import BaseModel
from starlette.responses import Response

from thetascope import library
from thetascope.api.routes.plants import experiment_line, plant_line
from thetascope_schemas.experiment.faults import ChannelFault, Fault
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.answers import Catalogue

router = APIRouter(tags=["catalogue"])


@router.get("/catalogue", response_model=Catalogue)
def get_catalogue() -> Response:
    """Plants, experiments, observers with their gains, fault shapes and signals with their fields."""
    return Response(_catalogue(), media_type="application/json", headers={"Cache-Control": "no-cache"})


@cache
def _catalogue() -> bytes:
    from thetascope import assembly  # SymPy comes with it, so the service starts without

    return orjson.dumps(
        {
            "plants": [plant_line(plant) for plant in library.plants().values()],
            "experiments": [experiment_line(item) for item in library.experiments().values()],
            "observers": assembly.observer_kinds(),
            "faults": [
                {**_form(model, "shape"), "on": "channel" if issubclass(model, ChannelFault) else "output"}
                for model in members(Fault)
            ],
            "signals": [_form(model, "kind") for model in members(Signal)],
        },
        option=orjson.OPT_SERIALIZE_NUMPY,
    )


def members(union: object) -> tuple[type[BaseModel], ...]:
    """The models of a discriminated union of the contract."""
    return get_args(get_args(union)[0])  # of Annotated[A | B, Field(discriminator=…)]


def _form(model: type[BaseModel], tag: str) -> dict[str, Any]:
    """One member of a union as a form: its kind, what it means, its fields and an example."""
    schema = model.model_json_schema()
    properties = schema["properties"]
    required = schema.get("required", [])
    fields = [_field(name, properties[name], name in required) for name in properties if name != tag]
    return {
        tag: properties[tag]["const"],
        "description": schema.get("description", ""),
        "fields": fields,
        "example": schema["examples"][0],
    }


def _field(name: str, schema: dict[str, Any], required: bool) -> dict[str, Any]:
    """A field of a form: its type as the form knows it, its default and bounds."""
    options = schema.get("anyOf", [schema])
    kinds = [option.get("type") for option in options]
    typed = next(option for option in options if option.get("type") != "null")
    field = {
        "name": name,
        "type": "choice" if "enum" in typed else typed.get("type", "any"),
        "required": required,
        "nullable": "null" in kinds,
        "description": schema.get("description", ""),
    }
    if not required:
        field["default"] = schema.get("default")
    names = {"minimum": "minimum", "exclusiveMinimum": "above", "maximum": "maximum", "enum": "choices"}
    return field | {names[key]: typed[key] for key in names if key in typed}
