"""/api/catalogue: the content of forms, from the schemas and the observers."""

from functools import cache
from typing import Any, get_args

import orjson
from fastapi import APIRouter
from pydantic import BaseModel
from starlette.responses import Response

from thetascope import library
from thetascope.api.http.language import Language
from thetascope.api.routes.plants import experiment_line, plant_line
from thetascope.messages import Message
from thetascope_schemas.experiment.faults import ChannelFault, Fault
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.answers import Catalogue

router = APIRouter(tags=["catalogue"])

_FORMS = {"shape": "fault", "kind": "signal"}  # by the field that distinguishes the members of a union


@router.get("/catalogue", response_model=Catalogue)
def get_catalogue(language: Language) -> Response:
    """Return plants, experiments, observers with their gains, and the fields of fault shapes and signals."""
    return Response(_catalogue(language), media_type="application/json", headers={"Cache-Control": "no-cache"})


@cache
def _catalogue(language: str) -> bytes:
    from thetascope import assembly  # imports SymPy, so the service starts without it

    return orjson.dumps(
        {
            "plants": [plant_line(plant, language) for plant in library.plants().values()],
            "experiments": [experiment_line(item, language) for item in library.experiments().values()],
            "observers": assembly.observer_kinds(language),
            "faults": [
                {**_form(model, "shape", language), "on": "channel" if issubclass(model, ChannelFault) else "output"}
                for model in members(Fault)
            ],
            "signals": [_form(model, "kind", language) for model in members(Signal)],
        },
        option=orjson.OPT_SERIALIZE_NUMPY,
    )


def members(union: object) -> tuple[type[BaseModel], ...]:
    """Return the models of a discriminated union of the contract."""
    return get_args(get_args(union)[0])  # of Annotated[A | B, Field(discriminator=…)]


def form_codes(model: type[BaseModel], tag: str) -> dict[str, str]:
    """Return the codes of a form's descriptions: of the form itself under `tag`, and of each field.

    A field that the model shares with others, such as `onset`, has one description for all: `form.fault.onset`.
    """
    general = f"form.{_FORMS[tag]}"
    own = f"{general}.{model.model_fields[tag].default}"
    declared = vars(model)["__annotations__"]
    codes = {name: f"{own if name in declared else general}.{name.replace('_', '-')}" for name in model.model_fields}
    return codes | {tag: own}


def _form(model: type[BaseModel], tag: str, language: str) -> dict[str, Any]:
    """Return one member of a union as a form: its kind, meaning, fields and an example."""
    schema = model.model_json_schema()
    properties = schema["properties"]
    required = schema.get("required", [])
    codes = form_codes(model, tag)
    fields = [_field(name, properties[name], name in required, codes[name], language) for name in codes if name != tag]
    return {
        tag: properties[tag]["const"],
        "description": Message(codes[tag]).text(language),
        "fields": fields,
        "example": schema["examples"][0],
    }


def _field(name: str, schema: dict[str, Any], required: bool, code: str, language: str) -> dict[str, Any]:
    """Return a field of a form: its type, default and bounds; `code` is that of its description."""
    options = schema.get("anyOf", [schema])
    kinds = [option.get("type") for option in options]
    typed = next(option for option in options if option.get("type") != "null")
    field = {
        "name": name,
        "type": "choice" if "enum" in typed else typed.get("type", "any"),
        "required": required,
        "nullable": "null" in kinds,
        "description": Message(code).text(language),
    }
    if not required:
        field["default"] = schema.get("default")
    names = {"minimum": "minimum", "exclusiveMinimum": "above", "maximum": "maximum", "enum": "choices"}
    return field | {names[key]: typed[key] for key in names if key in typed}
