"""The OpenAPI document: FastAPI's, with the schemas of bodies that routes parse themselves."""

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
    """Add the schemas of the bodies to the application's document."""
    derive = app.openapi

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            openapi = derive()
            _, bodies = models_json_schema(
                [(model, "validation") for model in BODIES], ref_template="#/components/schemas/{model}"
            )
            schemas = openapi.setdefault("components", {}).setdefault("schemas", {})
            for name, schema in bodies["$defs"].items():
                schemas.setdefault(name, schema)
            app.openapi_schema = openapi
        return app.openapi_schema

    app.openapi = document
