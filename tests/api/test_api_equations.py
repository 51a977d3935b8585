"""Equations, gains and lessons over HTTP."""

import pytest

from thetascope import library
from thetascope.client import ServiceError


def test_a_library_plant_and_all_kinds(client):
    """GET gives the plant's equations and those of every kind of observer."""
    answer = client.get("/api/equations/zhao-contois")
    assert len(answer["plant"]["states"]) == 2 and "<math" in answer["plant"]["states"][0]["math"]
    assert {item["id"] for item in client.get("/api/catalogue")["observers"]} == set(answer["observers"])


def test_a_posted_plant_and_chosen_kinds(client):
    """POST takes a whole plant; an error in its text is refused with its position."""
    plant = library.plant("dc-motor").model_dump(mode="json") | {"id": "mine"}
    answer = client.post("/api/equations", {"plant": plant, "observers": ["adaptive-kalman"]})
    assert answer["plant"]["id"] == "mine" and list(answer["observers"]) == ["adaptive-kalman"]
    plant["dynamics"] = plant["dynamics"] | {"speed": "(kt*curent)/J"}
    with pytest.raises(ServiceError, match="curent"):
        client.post("/api/equations", {"plant": plant, "observers": []})


def test_names_in_equations_are_escaped(client):
    """A description may contain any text; only mathematics is markup."""
    plant = library.plant("shen-hu-2015").model_dump(mode="json")
    plant["states"][0]["description"] = "<script>alert(1)</script>"
    answer = client.post("/api/equations", {"plant": plant, "observers": []})
    assert "script" not in answer["plant"]["states"][0]["math"]


def test_unknown_plants_and_kinds_are_refused_with_suggestions(client):
    """A misspelt id is answered with the nearest one, a misspelt kind with the choices."""
    with pytest.raises(ServiceError, match="zhao-contois"):
        client.get("/api/equations/zhao-conto")
    with pytest.raises(ServiceError, match="joint-ekf"):
        client.post("/api/equations", {"plant": "dc-motor", "observers": ["joint-efk"]})


def test_gains_are_filled_in(client):
    """Gains that depend on plant and noise become numbers; given gains are unchanged."""
    spec = library.experiment("dc-motor").model_dump(mode="json")
    gains = client.post("/api/gains", spec)["gains"]
    assert gains["adaptive"]["lambda"] == 2 and gains["adaptive"]["q"] == [0.1, 1.0]
    assert len(gains["adaptive"]["gamma0"]) == 4 and all(value > 0 for value in gains["adaptive"]["r"])


def test_lessons_are_listed_and_returned(client):
    """Each lesson has its questions in both languages and the commands that carry them out."""
    listed = client.get("/api/lessons")["lessons"]
    assert {lesson["id"] for lesson in listed} == set(library.experiments())
    lesson = client.get("/api/lessons/zhao-2012")
    assert lesson["questions"][0]["do"] == [
        {"type": "set-gain", "observer": "adaptive", "gain": "lambda", "value": 0.6}
    ]
    with pytest.raises(ServiceError, match="nothing"):
        client.get("/api/lessons/nothing")
