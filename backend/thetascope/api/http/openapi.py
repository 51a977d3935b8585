"""The OpenAPI document: FastAPI's, with the schemas of bodies that routes parse themselves."""

from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from thetascope.api.http.session_bodies import ForkRequest, SessionRequest
from thetascope.runs.specs.run_requests import RunRequest
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record import Record

SCHEMES = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "The access key, as `Authorization: Bearer KEY`."},
    "key": {"type": "apiKey", "in": "header", "name": "X-Access-Key", "description": "The access key."},
    "browser": {
        "type": "apiKey",
        "in": "cookie",
        "name": "thetascope",
        "description": "The cookie that /sign-in sets. Its name ends with `-` and the installation.",
    },
}
"""Ways to show the access key. A service on loopback, and one with THETASCOPE_OPEN=1, asks for none of them."""
_NO_KEY = ("/api/health/live",)

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
            openapi["components"]["securitySchemes"] = SCHEMES
            openapi["security"] = [{}, *({name: []} for name in SCHEMES)]
            for path in _NO_KEY:
                openapi["paths"][path]["get"]["security"] = []
            app.openapi_schema = openapi
        return app.openapi_schema

    app.openapi = document
