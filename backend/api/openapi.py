"""The OpenAPI document: what FastAPI derives, with the schemas of bodies that are read by hand."""

from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from backend.api.asked import ForkRequest, SessionRequest
from backend.runs.requests import RunRequest
from shared.experiment import Experiment
from shared.plant import Plant
from shared.record import Record

_BODIES = (Experiment, Plant, Record, RunRequest, SessionRequest, ForkRequest)


def install(app: FastAPI) -> None:
    """Let the application's document hold the schemas of the bodies too."""
    derive = app.openapi

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            made = derive()
            _, bodies = models_json_schema(
                [(model, "validation") for model in _BODIES], ref_template="#/components/schemas/{model}"
            )
            schemas = made.setdefault("components", {}).setdefault("schemas", {})
            for name, schema in bodies["$defs"].items():
                schemas.setdefault(name, schema)
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document
