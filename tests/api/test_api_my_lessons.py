"""/api/my-lessons and /api/course/play: lessons that clients make, save, play and share as a file."""

import json

import pytest
import yaml

from tests.api.streams import watching
from thetascope.client import Client, ServiceError

WORDS = {"en": "What will it do?"}
LESSON = {
    "id": "falling-level",
    "minutes": 3,
    "title": {"en": "A falling level", "zh": "下降的水位"},
    "outcome": WORDS,
    "experiments": {
        "recorded": {
            "plant": "two-tanks",
            "horizon": 60.0,
            "step": 0.1,
            "record": 0.5,
            "evaluate": 0.5,
            "faults": [{"channel": "leak", "shape": "step", "onset": 10.0, "size": 0.02}],
            "diagnosis": {"enabled": False},
        }
    },
    "steps": [
        {
            "title": WORDS,
            "say": [WORDS],
            "start": {"experiment": "recorded", "t": 5.0},
            "show": {"strips": ["x.h2"]},
            "ask": WORDS,
            "answers": [
                {"text": {"zh": "下降"}, "right_if": [{"measure": "end", "at_most": 9.9}]},
                {"text": {"en": "It stays"}, "right_if": [{"measure": "end", "at_least": 9.9}]},
            ],
            "run": {"seconds": 20.0},
            "measures": {"end": {"kind": "level", "take": "last", "column": "x.h2"}},
        }
    ],
}


def text_of(client: Client, path: str) -> str:
    return client.request("GET", path)[2].decode()


def test_a_lesson_is_saved_played_and_shared_as_a_file(client, address):
    """It has versions, is judged in a session as one of the library, and its file is saved again as it is."""
    first = client.post("/api/my-lessons", LESSON)
    assert first["version"] == 1 and first["mine"] and first["steps"] == 1
    changed = {**LESSON, "minutes": 4}
    assert client.post("/api/my-lessons", changed)["version"] == 2
    assert client.post("/api/my-lessons", changed)["version"] == 2, "the same is no new version"
    assert [one["id"] for one in client.get("/api/my-lessons")["lessons"]] == [LESSON["id"]]
    lesson = client.get(f"/api/course/{LESSON['id']}")
    assert lesson["minutes"] == 4 and lesson["title"]["zh"] == "下降的水位"
    assert LESSON["id"] not in {one["id"] for one in client.get("/api/course")["lessons"]}
    session = client.post("/api/sessions", {"spec": lesson["experiments"]["recorded"], "play": False, "t": 5})
    with watching(address, session) as page:
        page.receive()
        page.say("step", rows=40)
        page.until(lambda: page.end == 51)
    judged = client.post(f"/api/sessions/{session['id']}/judge", {"lesson": LESSON["id"], "step": 0, "mark": 5.0})
    assert judged["right"] == [True, False]
    file = text_of(client, f"/api/course/{LESSON['id']}/file")
    assert yaml.safe_load(file)["steps"][0]["answers"][0]["text"] == {"zh": "下降"}
    sent = client.request("POST", "/api/my-lessons", file.encode(), {"Content-Type": "application/yaml"})
    assert json.loads(sent[2])["version"] == 2


def test_a_step_is_played_on_the_server(client):
    """Which answer is right there, since when, and the curves of its strips."""
    played = client.post("/api/course/play", {"lesson": LESSON, "step": 0})
    (deed,) = played["deeds"]
    assert deed["judged"]["right"] == [True, False] and deed["since"][1] is None
    assert 10 < deed["since"][0] < 25
    (curve,) = played["curves"]
    assert curve["strip"] == "x.h2" and len(curve["values"]) == len(played["t"])
    assert "x.h2" in played["columns"] and played["mark"] == 5.0


def test_a_deleted_lesson_comes_back(client):
    """Deleting hides all versions; restoring brings them back."""
    client.post("/api/my-lessons", {**LESSON, "id": "short-lived"})
    assert client.request("DELETE", "/api/my-lessons/short-lived")[0] == 204
    with pytest.raises(ServiceError) as caught:
        client.get("/api/course/short-lived")
    assert caught.value.status == 404
    assert client.post("/api/my-lessons/short-lived/restore", {})["version"] == 1


def test_a_hostile_lesson_is_refused_with_field_value_and_remedy(client):
    """Names of the library, sizes, unknown fields and measures, expressions, plants that do not fit."""
    step, experiment = LESSON["steps"][0], LESSON["experiments"]["recorded"]
    cases = {
        "id": {"id": "what-you-cannot-see"},
        "minutes": {"minutes": 10**9},
        "steps": {"steps": [step] * 13},
        "steps[0].do": {"steps": [{**step, "do": "import os"}]},
        "steps[0].say": {"steps": [{**step, "say": [WORDS] * 5}]},
        "steps[0].say[0].en": {"steps": [{**step, "say": [{"en": "x" * 20_000}]}]},
        "steps[0].title.en": {"steps": [{**step, "title": {"en": " ", "zh": ""}}]},
        "steps[0].measures": {"steps": [{**step, "measures": {}}]},
        "experiments.recorded.faults[0].channel": {
            "experiments": {"recorded": {**experiment, "faults": [{**experiment["faults"][0], "channel": "lid"}]}}
        },
        "experiments.recorded.plant": {"experiments": {"recorded": {**experiment, "plant": "../../etc/passwd"}}},
    }
    for field, change in cases.items():
        with pytest.raises(ServiceError) as caught:
            client.post("/api/my-lessons", {**LESSON, **change})
        assert caught.value.status == 422
        errors = caught.value.problem["errors"]
        assert field in {error["field"] for error in errors}, (field, errors)
        assert all(error["remedy"] for error in errors), errors
