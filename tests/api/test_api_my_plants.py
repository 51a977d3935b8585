"""Saved plants over HTTP: versions, deletion with undo, and their names wherever a plant is chosen."""

import json

import pytest

from tests.api.conftest import service
from tests.api.test_api_large_bodies import computations
from tests.api.test_api_owners import KEY, browser
from tests.runs.plants.test_text_check import TEXT
from thetascope.client import Client, ServiceError
from thetascope_schemas.service.plants.trial import FaultPatterns, PlantTrial

RUN = {"horizon": 1, "step": 0.01, "record": 0.5}


def text(id: str, **changes: str) -> str:
    """Return the plant under an id of its own, since the tests share a service."""
    changed = TEXT.replace("id: two-tanks", f"id: {id}")
    for old, new in changes.items():
        changed = changed.replace(old, new)
    return changed


def save(client: Client, id: str, content: str) -> tuple[int, dict]:
    """Save a text; return the status and the answer."""
    status, _, body = client.request(
        "PUT", f"/api/my-plants/{id}", content.encode(), {"Content-Type": "application/yaml"}
    )
    return status, json.loads(body)


def check(client: Client, content: str) -> dict:
    body = client.request("POST", "/api/plants/check-text", content.encode(), {"Content-Type": "application/yaml"})[2]
    return json.loads(body)


def test_a_text_with_errors_is_answered_with_places(client):
    """The check of a text is an answer, and no refusal; a text without errors has equations."""
    wrong = check(client, text("a-tank", sqrt="sqr"))
    assert not wrong["valid"] and [e["fix"]["text"] for e in wrong["errors"]] == ["sqrt"] * 3
    assert [e["place"]["line"] for e in wrong["errors"]] == [14, 15, 22]
    right = check(client, text("a-tank"))
    assert right["valid"] and right["equations"]["states"][0]["math"].startswith("<math")


def test_each_save_is_a_version_and_drafts_are_kept(client):
    """Versions count from 1, the same text again adds none, and a text with errors is saved as a draft."""
    assert save(client, "tank-a", text("tank-a"))[0] == 201
    status, again = save(client, "tank-a", text("tank-a"))
    assert status == 200 and (again["version"], again["ready"], again["faults"]) == (1, True, 1)
    status, draft = save(client, "tank-a", text("tank-a", sqrt="sqr"))
    assert status == 201 and (draft["version"], draft["ready"]) == (2, False)
    assert save(client, "tank-a", "id: [")[1]["version"] == 3
    listed = {line["id"]: line for line in client.get("/api/my-plants")["plants"]}
    assert listed["tank-a"]["version"] == 3 and not listed["tank-a"]["ready"]
    assert [v["version"] for v in client.get("/api/my-plants/tank-a/versions")["plants"]] == [3, 2, 1]
    assert client.get("/api/my-plants/tank-a?version=1")["text"] == text("tank-a")


def test_a_deleted_plant_is_restored(client):
    """After deletion it is unknown, and a restored one has its versions."""
    save(client, "tank-b", text("tank-b"))
    assert client.request("DELETE", "/api/my-plants/tank-b")[0] == 204
    with pytest.raises(ServiceError, match="no saved plant tank-b"):
        client.get("/api/my-plants/tank-b")
    assert client.post("/api/my-plants/tank-b/restore")["version"] == 1
    assert client.get("/api/my-plants/tank-b")["ready"]


@pytest.mark.parametrize(
    ("id", "content", "problem"),
    [
        ("dts200", TEXT, "plant of the library"),
        ("other", TEXT, "the text has the id two-tanks"),
        ("Two_Tanks", TEXT, "lower-case"),
    ],
)
def test_ids_are_refused_that_would_be_ambiguous(client, id, content, problem):
    """The id is that of the text, and none of the library."""
    with pytest.raises(ServiceError, match=problem):
        save(client, id, content)


def test_a_saved_plant_is_named_where_a_plant_is_chosen(client):
    """Runs, records, equations and sessions take `id` and `id@version`; a run has the hash of the plant in full."""
    save(client, "tank-c", text("tank-c"))
    save(client, "tank-c", text("tank-c", **{"value: 981": "value: 500"}))
    values = [
        client.post("/api/runs", {**RUN, "plant": plant})["id"]
        for plant in ("tank-c", "tank-c@1", "tank-c@2", check(client, text("tank-c"))["plant"])
    ]
    assert values[0] == values[2] != values[1] == values[3]
    assert client.get("/api/plants/tank-c@1")["parameters"][1]["value"] == 981
    assert client.post("/api/equations", {"plant": "tank-c", "observers": []})["plant"]["id"] == "tank-c"
    opened = client.post("/api/sessions", {"spec": {**RUN, "plant": "tank-c@1"}, "play": False})
    assert client.get(f"/api/sessions/{opened['id']}")["spec"]["plant"]["parameters"][1]["value"] == 981
    rows = {"columns": {"t": [0, 1, 2, 3], "q": [50.0] * 4, "y1": [34, 34.1, 34.2, 34.3]}, "plant": "tank-c"}
    assert client.post("/api/records", rows)["plant"] == "tank-c"
    with pytest.raises(ServiceError, match="no version 9"):
        client.post("/api/runs", {**RUN, "plant": "tank-c@9"})
    with pytest.raises(ServiceError, match="no plant 'tank-d'|tank-d"):
        client.post("/api/runs", {**RUN, "plant": "tank-d"})


def test_a_draft_is_refused_with_its_error(client):
    """A run of a draft names the field of the plant; a text that is no YAML is refused, too."""
    save(client, "tank-e", text("tank-e", kind="knd"))
    with pytest.raises(ServiceError, match="plant.channels"):
        client.post("/api/runs", {**RUN, "plant": "tank-e"})
    save(client, "tank-e", "id: [")
    with pytest.raises(ServiceError, match="cannot be read"):
        client.post("/api/runs", {**RUN, "plant": "tank-e"})


@pytest.mark.parametrize("size", ["small", "large"])
def test_a_large_text_is_read_in_workers_whenever_it_is_named(client, address, size):
    """Saving reads it there, and each request that names it: YAML of a megabyte takes seconds. Small ones need none."""
    content = text(f"tank-{size}") + f"# {'x' * 100}\n" * (200 if size == "large" else 0)
    draft = content.replace("kind: ", "knd: ")
    assert save(client, f"tank-{size}", draft)[1]["ready"] is False
    assert save(client, f"tank-{size}", content)[1]["ready"] is True
    before = computations(address)
    assert client.get(f"/api/plants/tank-{size}")["id"] == f"tank-{size}"
    assert computations(address) - before == (size == "large")
    spec = {"plant": f"tank-{size}@1", "horizon": 1}
    for path, body, field in (("gains", spec, "plant"), ("sessions", {"spec": spec}, "spec.plant")):
        with pytest.raises(ServiceError, match=rf" {field}\.channels"):
            client.post(f"/api/{path}", body)
    assert computations(address) - before == 3 * (size == "large")


def test_a_body_names_a_saved_plant_in_two_places_only(client, address):
    """A body that nests specs is refused without reading the plant that each of them names."""
    save(client, "tank-h", text("tank-h") + f"# {'x' * 100}\n" * 200)
    body: dict = {}
    for _ in range(400):
        body = {"plant": "tank-h", "spec": body}
    before = computations(address)
    with pytest.raises(ServiceError) as refusal:
        client.post("/api/sessions", body)
    assert refusal.value.status == 422 and computations(address) - before <= 2


def test_room_for_plants_is_limited(tmp_path):
    """One client may have a quarter of it, all together the whole; deleted plants make room for new ones."""
    with service(tmp_path, host="0.0.0.0", key=KEY, plant_limit="64k") as address:
        ann, eve = browser(address), browser(address)
        assert save(ann, "long", "id: long # " + "x" * 10_000)[0] == 201
        with pytest.raises(ServiceError, match="your plants take more") as refusal:
            save(ann, "longer", "id: longer # " + "x" * 10_000)
        assert refusal.value.status == 413
        assert save(eve, "long", "id: long # " + "x" * 10_000)[0] == 201
        ann.request("DELETE", "/api/my-plants/long")
        assert save(ann, "longer", "id: longer # " + "x" * 10_000)[0] == 201
        for client in (ann, eve):
            client.close()


def test_facts_about_a_plant_match_their_models(client):
    """An experiment that suits it can be run as it is; patterns of faults can be added to its text."""
    save(client, "tank-g", text("tank-g"))
    trial = PlantTrial.model_validate(client.post("/api/plants/trial", {"plant": "tank-g", "parameters": {"A": 100}}))
    assert trial.experiment.parameters == {"A": 100} and trial.experiment.observers == ()
    assert trial.preview.outputs.keys() == {"y1"} and trial.preview.faulty.keys() == {"leak"}
    spec = trial.experiment.model_dump(mode="json") | {"observers": [{"label": "o", "kind": "joint-ekf"}]}
    assert client.post("/api/runs?wait=60", spec)["status"] == "done"
    asked = {"plant": "tank-g", "name": "h2"}
    first = FaultPatterns.model_validate(client.post("/api/plants/fault-patterns", asked)).patterns[0]
    assert (first.pattern, first.term, first.conserved) == ("loss", "q12", {"h1": "q12/A"})
    channel = first.channel.model_dump(mode="json", exclude_unset=True)
    edited = client.post("/api/plants/edit-text", {"text": text("tank-g"), "channels": [channel]})
    assert edited["lines"] and check(client, edited["text"])["sizes"]["channels"] == 2
    assert client.get("/api/plants/dts200/text?lang=zh")["text"].startswith("id: dts200\ntitle: 三")
    with pytest.raises(ServiceError, match="z has no equation"):
        client.post("/api/plants/fault-patterns", {"plant": "tank-g", "name": "z"})


def test_a_plant_is_found_from_another_browser_and_deleted_by_its_owner(tmp_path):
    """Others with the key read and use it; what they save under its id is their own next version."""
    with service(tmp_path, host="0.0.0.0", key=KEY) as address:
        ann, eve = browser(address), browser(address)
        save(ann, "tank-f", text("tank-f"))
        (seen,) = eve.get("/api/my-plants")["plants"]
        assert (seen["id"], seen["mine"]) == ("tank-f", False)
        with pytest.raises(ServiceError) as refusal:
            eve.request("DELETE", "/api/my-plants/tank-f")
        assert refusal.value.status == 403
        assert save(eve, "tank-f", text("tank-f", title="name"))[1]["version"] == 2
        assert [client.get("/api/my-plants/tank-f")["version"] for client in (ann, eve)] == [1, 2]
        for client in (ann, eve):
            client.close()
