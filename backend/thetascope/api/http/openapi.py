"""The OpenAPI document: FastAPI's, with the schemas of bodies that routes parse themselves."""

from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from thetascope.api.http.problems import PROBLEM, RESPONSES
from thetascope.api.http.request_bodies import EquationsRequest, ForkRequest, SessionRequest
from thetascope.runs.specs.run_requests import RunRequest
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.classroom.requests import (
    AnswerRequest,
    JoinRequest,
    LaunchedRequest,
    LeadRequest,
    NameRequest,
    RoundRequest,
    VoteRequest,
)
from thetascope_schemas.service.figures.printed_figure import PrintSettings
from thetascope_schemas.service.figures.signal_curve import SignalCurveRequest
from thetascope_schemas.service.learning.challenge import ChallengeAnswer
from thetascope_schemas.service.learning.judged import JudgeRequest
from thetascope_schemas.service.learning.measured import MeasuresRequest
from thetascope_schemas.service.learning.played import PlayRequest
from thetascope_schemas.service.notebook.comparison import ComparisonNotes
from thetascope_schemas.service.notebook.lines import RunNotes
from thetascope_schemas.service.plants.text import TextEdit
from thetascope_schemas.service.plants.trial import FaultPatternRequest, PlantTrialRequest
from thetascope_schemas.service.record import Record, RecordRunRequest
from thetascope_schemas.service.record_diagnosis import RecordDiagnosisRequest
from thetascope_schemas.service.record_inspection import MappingRequest
from thetascope_schemas.service.run import Problem
from thetascope_schemas.service.study.study import Study

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
_NO_KEY = ("/api/health/live", "/api/messages/{language}", "/api/classroom/join")
_NO_KEY_BELOW = "/api/classroom/seat"
"""Addresses that answer without the key: see thetascope.api.sign_in.guests."""

BODIES = (
    Experiment,
    Plant,
    PlantTrialRequest,
    SignalCurveRequest,
    FaultPatternRequest,
    TextEdit,
    Record,
    MappingRequest,
    RecordDiagnosisRequest,
    RecordRunRequest,
    RunNotes,
    ComparisonNotes,
    RunRequest,
    Study,
    SessionRequest,
    ForkRequest,
    EquationsRequest,
    PrintSettings,
    JudgeRequest,
    MeasuresRequest,
    PlayRequest,
    RoundRequest,
    LeadRequest,
    JoinRequest,
    LaunchedRequest,
    NameRequest,
    VoteRequest,
    ChallengeAnswer,
    AnswerRequest,
    Problem,
)
_ANY = {"description": "Another refusal, or an internal error (500).", "content": PROBLEM}


def _refusals(responses: dict[str, Any]) -> None:
    """Describe refusals as they are answered: also those of parameters, for which FastAPI has a form of its own."""
    if "HTTPValidationError" in str(responses.get("422")):
        responses["422"] = RESPONSES[422]
    responses["default"] = _ANY


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
            for operations in openapi["paths"].values():
                for operation in operations.values():
                    _refusals(operation["responses"])
            for name in ("HTTPValidationError", "ValidationError"):
                schemas.pop(name, None)
            for path, operations in openapi["paths"].items():
                if path in _NO_KEY or path.startswith(_NO_KEY_BELOW):
                    for operation in operations.values():
                        operation["security"] = []
            app.openapi_schema = openapi
        return app.openapi_schema

    app.openapi = document
