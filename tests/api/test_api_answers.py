"""Answers that routes build as plain data match the models that document them."""

import json

import pytest

from tests.api.conftest import ROOT
from tests.test_docs import blocks
from thetascope.client import ServiceError
from thetascope.runs.specs.spec_files import parse
from thetascope_schemas import Plant
from thetascope_schemas.service import answers
from thetascope_schemas.service.notebook.lines import RunList


@pytest.mark.parametrize(
    ("path", "model"),
    [
        ("/api/catalogue", answers.Catalogue),
        ("/api/plants", answers.PlantList),
        ("/api/experiments", answers.ExperimentList),
        ("/api/lessons", answers.LessonList),
        ("/api/lessons/zhao-2012", answers.LessonPlan),
        ("/api/equations/zhao-contois", answers.Equations),
        ("/api/runs", RunList),
    ],
)
def test_answers_of_the_library_match_their_models(client, run, path, model):
    """No field is missing, unknown or of another type."""
    model.model_validate_json(client.request("GET", path)[2])


def test_answers_about_a_plant_match_their_models(client):
    """The check of a plant, its equations, and the gains of an experiment with it."""
    plant = client.get("/api/plants/dts200")
    answers.PlantCheck.model_validate(client.post("/api/plants/check", plant))
    answers.Equations.model_validate(client.post("/api/equations", {"plant": plant, "observers": ["joint-ekf"]}))
    answers.PresentGains.model_validate(client.post("/api/gains", client.get("/api/experiments/zhao-2012-observers")))


def test_a_plant_is_read_from_yaml_and_from_json(client):
    """Both give the plant in full; a mistake in the text is placed, one in the data names its field."""
    text = blocks(ROOT / "docs" / "plant-format.md", "yaml")[0]

    def read(body: str | bytes) -> tuple[int, dict]:
        status, _, answer = client.request("POST", "/api/plants/read", body, {"Content-Type": "application/yaml"})
        return status, json.loads(answer)

    def refused(body: str | bytes) -> dict:
        with pytest.raises(ServiceError) as refusal:
            read(body)
        assert refusal.value.status == 422
        return refusal.value.problem["errors"][0]

    status, plant = read(text.encode())
    assert status == 200 and plant == Plant.model_validate(parse(text).data).model_dump(mode="json")
    assert read(json.dumps(plant).encode()) == (200, plant)
    assert refused(b"id: tank\nstates: {h: [\n")["args"]["line"] == 3
    assert refused(b"\xff")["code"] == "document.no-utf8"
    assert refused(text.replace("h: (q", "z: (q").encode())["field"].startswith("dynamics")
    assert refused(b"7")["field"] == ""


def test_answers_about_a_run_match_their_models(client, run):
    """The list of its figures, and each figure."""
    figures = answers.FigureList.model_validate_json(client.request("GET", run["links"]["figures"])[2]).figures
    assert figures
    for figure in figures:
        answers.PlotlyFigure.model_validate_json(client.request("GET", figure.href)[2])


def test_answers_about_a_session_match_their_models(client):
    """A new session, its state, and a fork of it."""
    opened = client.post("/api/sessions", {"experiment": "zhao-2012", "play": False, "t": 1.5})
    answers.SessionOpened.model_validate(opened)
    answers.SessionState.model_validate_json(client.request("GET", f"/api/sessions/{opened['id']}")[2])
    fork = client.post(f"/api/sessions/{opened['id']}/fork", {})
    assert answers.SessionOpened.model_validate(fork).parent == opened["id"]
