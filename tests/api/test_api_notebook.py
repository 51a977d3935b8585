"""The notebook over REST: the list with what was changed, names and tags, removal that can be undone, comparisons."""

import json
from urllib.parse import quote

import pytest

from tests.api.conftest import service, until
from tests.api.test_api_owners import KEY, browser, refused
from tests.runs.samples import spec_data
from thetascope.client import Client, ServiceError
from thetascope_schemas.service.notebook.comparison import RunComparison
from thetascope_schemas.service.notebook.lines import RunList

QUICK = {"experiment": "zhao-2012", "set": {"horizon": 2.0, "seed": 3, "observers.adaptive.gains.lambda": 8}}


def patched(client: Client, id: str, **notes: object) -> dict:
    """Return the answer to a change of what is noted about a run."""
    body = json.dumps(notes).encode()
    answer = client.request("PATCH", f"/api/runs/{id}", body, {"Content-Type": "application/json"})[2]
    return json.loads(answer)


def stored(client: Client, *ids: str, query: str = "") -> list[dict]:
    """Return the runs of the list, in which those with these ids are as soon as they have been answered."""
    assert set(ids) <= {one["id"] for one in client.get("/api/runs")["runs"] if one["status"] == "done"}
    return client.get(f"/api/runs?{query}")["runs"]


@pytest.fixture(scope="module")
def notebook(tmp_path_factory):
    """Yield a client of a service that has three runs, with their ids."""
    with service(tmp_path_factory.mktemp("notebook"), wait=60) as address, Client(address) as client:
        changes = ({"horizon": 2.0}, QUICK["set"], {"horizon": 2.0, "seed": 3})
        ids = [client.post("/api/runs", {"experiment": "zhao-2012", "set": one})["id"] for one in changes]
        stored(client, *ids)
        yield client, ids


def test_a_line_has_what_was_changed_and_the_measures_of_the_summary(notebook):
    """They are those of the run's own summary, and the answer is as documented."""
    client, (_, quick, _) = notebook
    answer = client.get("/api/runs?lang=zh")
    RunList.model_validate(answer)
    line = next(one for one in answer["runs"] if one["id"] == quick)
    assert [(c["path"], c["label"]["text"], c["from"], c["to"]) for c in line["changes"]] == [
        ("seed", "随机种子", 1, 3),
        ("horizon", "时长", 100, 2),
        ("observers.adaptive.gains.lambda", "lambda", 4, 8),
    ]
    summary = client.get(f"/api/runs/{quick}")["summary"]
    row = summary["comparison"]["observers"][0]
    assert line["rmse"] == summary["observers"][0]["rmse"]["x1"] and line["state"] == "x1"
    assert (line["delay"], line["false_alarms"]) == (row["delay"], row["false_alarms"])
    assert line["curve"]["channel"] == "theta3" and len(line["curve"]["truth"]) == len(line["curve"]["estimate"]) > 10


def test_filter_order_and_groups_are_those_of_the_server(notebook):
    """Words, conditions, groups with their titles; a wrong column is refused."""
    client, (plain, quick, seed) = notebook
    found = {
        q: [one["id"] for one in client.get(f"/api/runs?q={quote(q)}")["runs"]] for q in ("λ > 5", "seed = 3", "dts")
    }
    assert found == {"λ > 5": [quick], "seed = 3": [seed, quick], "dts": []}
    answer = client.get("/api/runs?group=experiment&limit=1&offset=1")
    assert [one["id"] for one in answer["runs"]] == [quick]
    assert [(group["key"], group["n"]) for group in answer["groups"]] == [("zhao-2012", 3)]
    assert answer["groups"][0]["title"].startswith("Adaptive observer") and answer["counts"]["found"] == 3
    rmse = [one["rmse"] for one in client.get("/api/runs?sort=rmse")["runs"]]
    assert rmse == sorted(rmse) and plain in [one["id"] for one in client.get("/api/runs?sort=rmse")["runs"]]
    with pytest.raises(ServiceError, match="colour") as refusal:
        client.get("/api/runs?sort=colour")
    assert refusal.value.status == 422


def test_names_tags_and_pins_are_changed_one_by_one(notebook):
    """What is left out stays; a tag with a comma is refused with its field."""
    client, (plain, *_) = notebook
    assert patched(client, plain, name="  as in\tthe paper ")["name"] == "as in the paper"
    line = patched(client, plain, tags=["fig. 4", "图 4", "fig. 4"], pinned=True)
    assert (line["name"], line["tags"], line["pinned"]) == ("as in the paper", ["fig. 4", "图 4"], True)
    answer = client.get(f"/api/runs?tag={quote('图 4')}")
    assert [one["id"] for one in answer["runs"]] == [plain] and answer["counts"]["pinned"] == 1
    assert answer["tags"] == [{"tag": "fig. 4", "n": 1}, {"tag": "图 4", "n": 1}]
    with pytest.raises(ServiceError) as refusal:
        patched(client, plain, tags=["a,b"])
    assert refusal.value.problem["errors"][0]["field"] == "tags[0]"
    with pytest.raises(ServiceError) as refusal:
        patched(client, "0" * 32, name="x")
    assert refusal.value.status == 404


def test_a_run_that_is_removed_comes_back_with_name_and_result(notebook):
    """It is neither listed nor answered meanwhile; a second restore finds it in place."""
    client, (plain, *_) = notebook
    patched(client, plain, name="kept")
    csv = client.request("GET", f"/api/runs/{plain}/data")[2]
    assert client.request("DELETE", f"/api/runs/{plain}")[0] == 204
    assert plain not in [one["id"] for one in client.get("/api/runs")["runs"]]
    with pytest.raises(ServiceError) as refusal:
        client.get(f"/api/runs/{plain}")
    assert refusal.value.status == 404
    for _ in range(2):
        assert client.post(f"/api/runs/{plain}/restore")["name"] == "kept"
    assert client.request("GET", f"/api/runs/{plain}/data")[2] == csv


def test_others_neither_edit_nor_restore_and_have_names_of_their_own(tmp_path):
    """Two owners of one run: each has its own name, and gives up its share without a change for the other."""
    with service(tmp_path, host="0.0.0.0", key=KEY, wait=60) as address:
        ann, eve = browser(address), browser(address)
        id = ann.post("/api/runs", spec_data())["id"]
        stored(ann, id)
        assert [one["mine"] for one in eve.get("/api/runs")["runs"]] == [False]
        with pytest.raises(ServiceError) as refusal:
            patched(eve, id, name="mine")
        assert (refusal.value.status, refusal.value.problem["code"]) == (403, "run.not-owner")
        patched(ann, id, name="of ann")
        eve.post("/api/runs", spec_data())
        patched(eve, id, name="of eve")
        assert [one["name"] for one in ann.get("/api/runs")["runs"]] == ["of ann"]
        assert eve.request("DELETE", f"/api/runs/{id}")[0] == 200
        assert eve.get("/api/runs")["runs"] == [] and len(ann.get("/api/runs")["runs"]) == 1
        assert eve.post(f"/api/runs/{id}/restore")["name"] == "of eve" and eve.get("/api/runs")["runs"][0]["mine"]
        eve.request("DELETE", f"/api/runs/{id}")
        assert ann.request("DELETE", f"/api/runs/{id}")[0] == 204
        third = browser(address)
        refused(third, "POST", f"/api/runs/{id}/restore")
        assert ann.post(f"/api/runs/{id}/restore")["name"] == "of ann"
        for client in (ann, eve, third):
            client.close()


def test_a_session_that_is_saved_is_in_the_list_as_one(notebook):
    """With its changes relative to the experiment, plant included."""
    client, _ = notebook
    session = client.post("/api/sessions", {"experiment": "zhao-2012", "speed": None})
    until(lambda: client.get(session["links"]["self"])["t"] > 1)
    token = {"X-Control-Token": session["token"]}
    id = json.loads(client.request("POST", session["links"]["save"], b"", token)[2])["id"]
    stored(client, id)
    until(lambda: [one["id"] for one in client.get("/api/runs?kind=session")["runs"]] == [id])
    (line,) = client.get("/api/runs?kind=session")["runs"]
    assert (line["experiment"], [c["path"] for c in line["changes"]]) == ("zhao-2012", ["horizon"])
    client.request("DELETE", session["links"]["self"], headers=token)


def test_runs_are_compared_by_settings_measures_and_curves(notebook):
    """Settings that differ have the value of each run; every fault and state has a curve of each run and the truth."""
    client, (plain, quick, seed) = notebook
    answer = client.get(f"/api/runs/compare?ids={plain},{quick},{seed}")
    RunComparison.model_validate(answer)
    assert {row["path"]: row["values"] for row in answer["differences"]} == {
        "seed": [1, 3, 3],
        "observers.adaptive.gains.lambda": [4, 8, 4],
    }
    assert answer["observers"] == ["adaptive"] * 3 and answer["same"] > 20
    rmse = next(row["values"] for row in answer["measures"] if row["label"]["code"] == "measure.rmse")
    summary = client.get(f"/api/runs/{quick}")["summary"]["observers"][0]
    assert rmse[1] == summary["rmse_end"]["x1"] and len(rmse) == 3
    figure = client.get(answer["links"]["figure"])
    assert len(figure["data"]) == 4 * (3 + 2)  # three channels and two states, each with a truth and three estimates
    for ids, status in ((plain, 422), (f"{plain},{'0' * 32}", 404), (",".join([plain] * 3), 422)):
        with pytest.raises(ServiceError) as refusal:
            client.get(f"/api/runs/compare?ids={ids}")
        assert refusal.value.status == status


def test_runs_of_other_plants_and_horizons_are_compared(notebook):
    """Curves reach to the end of the longest run, and a run that shares nothing with the others has its own strip."""
    client, ids = notebook
    longer = client.post("/api/runs", {"experiment": "zhao-2012", "set": {"horizon": 3.0}})["id"]
    other = client.post("/api/runs", {"experiment": "dc-motor", "set": {"horizon": 1.0}})["id"]
    stored(client, longer, other)
    query = f"ids={ids[0]},{longer},{other}"
    figure = client.get(f"/api/runs/compare/figure?{query}")
    first, last = ([t["name"] for t in figure["data"] if t["yaxis"] == axis] for axis in ("y", "y6"))
    assert len(first) == 3 and f"r-{longer[:4]}" in first and last == [f"r-{other[:4]}", "truth"]
    printed = client.get(f"/api/runs/compare/figure/print?{query}&format=json&panels=1&end=2.5")
    assert [curve["drawn"] for curve in printed["curves"]].count(True) >= 3
    pdf = client.request("GET", f"/api/runs/compare/figure/print?{query}&format=pdf")[2]
    assert pdf.startswith(b"%PDF") and b"/FontFile2" in pdf


def test_runs_of_an_own_plant_say_what_they_changed(notebook):
    """The oldest run of the plant is what the others differ from, in settings and in parameters of the plant."""
    client, _ = notebook
    data = spec_data(seed=1)
    other = {**data["plant"], "parameters": [{"name": "a", "value": 0.6}]}
    ids = [client.post("/api/runs", one)["id"] for one in (data, spec_data(plant=other, seed=7))]
    lines = {line["id"]: line for line in stored(client, *ids)}
    assert lines[ids[0]]["changes"] is None
    assert {change["path"]: change["to"] for change in lines[ids[1]]["changes"]} == {"seed": 7, "parameters.a": 0.6}


def test_a_comparison_is_printed_less_the_first_and_keeps_its_notes(notebook):
    """Differences are of the runs' own data; the printed figure names the runs; notes do not depend on the order."""
    client, ids = notebook
    query = f"ids={','.join(ids)}"
    less = client.get(f"/api/runs/compare/figure/print?{query}&less=true&format=json")
    assert [curve["key"] for curve in less["curves"]] == [curve["label"] for curve in less["curves"]]
    assert len(less["curves"]) == 2 and len(less["panels"]) == 5 and all(id[:12] in less["caption"] for id in ids)
    assert less["command"].startswith(f"thetascope figure {','.join(id[:16] for id in ids)} less-the-first --width 8.5")
    tex = client.request("GET", f"/api/runs/compare/figure/print?{query}&less=1&format=tex&panels=1&legend=none")[2]
    table = tex.decode().split("\\pgfplotstableread{\n")[1].split("}")[0].splitlines()
    t, difference = (float(value) for value in table[-1].split())
    column = table[0].split()[1].partition("-")[0]
    ends = [client.data(id, [column])[column][-1] for id in ids]
    assert t == 2.0 and difference == ends[1] - ends[0] != 0
    pdf = client.request("GET", f"/api/runs/compare/figure/print?{query}&format=pdf&observer=adaptive")[2]
    assert pdf.startswith(b"%PDF")
    body = json.dumps({"text": "图 4: leave out θ₂"}).encode()
    path, kind = f"/api/runs/compare/notes?{query}", {"Content-Type": "application/json"}
    assert client.request("PUT", path, body, kind)[0] == 200
    assert client.get(f"/api/runs/compare?ids={ids[2]},{ids[0]},{ids[1]}")["notes"] == "图 4: leave out θ₂"
    assert client.get(f"/api/runs/compare?ids={ids[0]},{ids[1]}")["notes"] == ""
    assert client.get(f"/api/runs/compare?{query}")["choices"] == ["adaptive"]
    client.request("PUT", path, b'{"text": ""}', kind)
    assert client.get(f"/api/runs/compare?{query}")["notes"] == ""
    with pytest.raises(ServiceError) as refusal:
        client.request("PUT", f"/api/runs/compare/notes?ids={ids[0]},{'0' * 32}", body, kind)
    assert refusal.value.status == 404
