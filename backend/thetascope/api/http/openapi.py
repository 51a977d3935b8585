"""The OpenAPI document: FastAPI's own, with the schemas of bodies that are read by hand."""

from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from thetascope.api.http.session_bodies import ForkRequest, SessionRequest
from thetascope.runs.specs.run_requests import RunRequest
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record import Record

BODIES = (Experiment, Plant, Record, RunRequest, SessionRequest, ForkRequest)


def install(app: FastAPI) -> None:
    """Let the application's document hold the schemas of the bodies too."""
    derive = app.openapi

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            made = derive()
            _, bodies = models_json_schema(
                [(model, "validation") for model in BODIES], ref_template="#/components/schemas/{model}"
            )
            schemas = made.setdefault("components", {}).setdefault("schemas", {})
            for name, schema in bodies["$defs"].items():
                schemas.setdefault(name, schema)
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document
