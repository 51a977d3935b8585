"""/api/runs over HTTP: starting, repeating, following and cancelling runs."""

import json
import sys

import pytest

from tests.api.conftest import Client, process, service, until
from tests.runs.samples import long_data, spec_data
from thetascope.client import ServiceError


def posted(client: Client, data: dict, query: str = "") -> tuple[int, dict, dict]:
    """Return status, headers and answer of a POST of a run."""
    status, headers, content = client.request("POST", f"/api/runs{query}", json.dumps(data).encode())
    return status, headers, json.loads(content)


def test_a_new_spec_is_answered_with_201_and_a_known_one_with_200(client):
    """The id is the hash of the spec; all clients get the same run."""
    status, headers, run = posted(client, spec_data(seed=11))
    assert (status, run["status"], run["progress"]) == (201, "done", 1)
    assert headers["location"] == run["links"]["self"] == f"/api/runs/{run['id']}"
    assert posted(client, spec_data(seed=11))[0::2] == (200, run)
    assert client.get(run["links"]["self"]) == run


def test_a_library_experiment_with_changes_is_the_same_run_as_its_whole_spec(client):
    """Both requests have one id; prose does not affect it."""
    changed = posted(client, {"experiment": "zhao-2012", "set": {"horizon": 1, "observers.adaptive.gains.rho": 8}})[2]
    whole = client.experiment("zhao-2012") | {"horizon": 1, "title": "Mine"}
    whole["observers"][0]["gains"]["rho"] = 8
    assert posted(client, whole)[2]["id"] == changed["id"]
    assert changed["spec"]["observers"][0]["gains"]["rho"] == 8


def test_the_summary_has_errors_and_checks_of_every_observer(client, run):
    """It suffices for a list of runs, without the data."""
    observer = run["summary"]["observers"][0]
    assert observer["label"] == "adaptive"
    assert set(observer["rmse"]) == {"x1", "x2"} and all(value > 0 for value in observer["rmse"].values())
    assert observer["checks"] and {check["verdict"] for check in observer["checks"]} <= {
        "holds",
        "fails",
        "cannot tell",
    }
    assert run["summary"]["rows"] == 501


def test_a_long_run_is_answered_with_202_and_can_be_cancelled(client):
    """Location is the run; progress increases; after cancellation it ends within seconds and has no data."""
    status, headers, answer = posted(client, long_data(seed=21), "?wait=0")
    assert status == 202 and answer["status"] in ("queued", "running")
    assert headers["location"] == f"/api/runs/{answer['id']}" and headers["retry-after"]
    progress = answer["links"]["progress"]
    until(lambda: client.get(progress)["progress"] > 0.01)
    first = client.get(progress)["progress"]
    until(lambda: client.get(progress)["progress"] > first)
    client.cancel(answer["id"])
    assert client.get(progress + "?wait=60")["status"] == "cancelled"
    with pytest.raises(ServiceError, match="cancelled") as refusal:
        client.data(answer["id"])
    assert refusal.value.status == 409


def test_a_request_waits_as_long_as_specified(client):
    """A run of two seconds: 202 without waiting, 200 with waiting, and the same run when posted again."""
    spec = spec_data(horizon=2000, evaluate=1, seed=31)
    assert posted(client, spec, "?wait=0")[0] == 202
    status, _, run = posted(client, spec, "?wait=60")
    assert status in (200, 201) and run["status"] == "done"


def test_a_deleted_run_is_removed_and_an_active_one_cancelled_first(client):
    """DELETE answers 204 for the one and 202 for the other."""
    done = posted(client, spec_data(seed=41))[2]["links"]["self"]
    assert client.request("DELETE", done)[0] == 204
    with pytest.raises(ServiceError) as refusal:
        client.get(done)
    assert refusal.value.status == 404
    answer = posted(client, long_data(seed=42), "?wait=0")[2]
    until(lambda: client.get(answer["links"]["progress"])["status"] == "running")
    assert client.request("DELETE", answer["links"]["self"])[0] == 202
    assert client.get(answer["links"]["progress"] + "?wait=60")["status"] == "cancelled"


def test_a_pin_is_set_and_removed(client):
    """PUT and DELETE on the run's pin."""
    run = posted(client, spec_data(seed=51))[2]
    assert client.post(run["links"]["pin"])["pinned"]
    assert client.get(run["links"]["self"])["pinned"]
    client.request("DELETE", run["links"]["pin"])
    assert not client.get(run["links"]["self"])["pinned"]


def test_runs_are_listed_newest_first_with_their_links(client):
    """Active and stored runs are in the list."""
    first = posted(client, spec_data(seed=61, title="First"))[2]
    second = posted(client, spec_data(seed=62, title="Second"))[2]
    until(lambda: {first["id"], second["id"]} <= {run["id"] for run in client.get("/api/runs")["runs"]})
    titles = {run["id"]: run["title"] for run in client.get("/api/runs")["runs"]}
    order = [id for id in titles if id in (first["id"], second["id"])]
    assert order == [second["id"], first["id"]]
    assert titles[first["id"]] == "First"
    assert len(client.get("/api/runs?limit=1")["runs"]) == 1


def test_a_full_queue_is_answered_with_503_and_retry_after(tmp_path):
    """With one active and one waiting run the third is refused; after cancellation there is room."""
    with service(tmp_path, workers=1, queue=1, wait=0) as address, Client(address) as client:
        ids = [posted(client, long_data(seed=seed))[2]["id"] for seed in (1, 2)]
        with pytest.raises(ServiceError, match="2 runs") as refusal:
            posted(client, long_data(seed=3))
        assert refusal.value.status == 503
        for id in ids:
            client.cancel(id)
            client.wait(id)
        assert posted(client, spec_data(), "?wait=60")[0] == 201


def test_a_restarted_service_finds_the_run_and_stays_responsive(tmp_path):
    """A new service on the same folder answers 200; during a long run it answers other requests."""
    with service(tmp_path, workers=1) as address, Client(address) as client:
        run = posted(client, spec_data(), "?wait=60")[2]
        until(lambda: client.health()["runs"]["results"] == 1)
    with service(tmp_path, workers=1, wait=0) as address, Client(address) as client:
        status, _, again = posted(client, spec_data())
        assert (status, again) == (200, run)
        long = posted(client, long_data())[2]
        until(lambda: client.get(long["links"]["self"])["status"] == "running")
        for _ in range(20):
            assert client.health()["status"] == "ok"
        assert client.get(long["links"]["self"])["status"] == "running"


def test_a_run_during_which_the_service_ended_is_finished_by_the_next(tmp_path):
    """SIGTERM ends the service soon; the same run, with the same address, goes on at the next start."""
    with process(tmp_path, workers=1, wait=0) as (started, address), Client(address) as client:
        run = posted(client, {**long_data(seed=41), "horizon": 3000})[2]
        until(lambda: client.get(run["links"]["progress"])["progress"] > 0)
        started.terminate()
        started.wait(60)
    with service(tmp_path, workers=1) as address, Client(address, timeout=120) as client:
        assert client.get(run["links"]["self"])["status"] in ("queued", "running", "done")
        assert client.wait(run["id"])["status"] == "done"
        assert client.get(run["links"]["self"])["summary"]["rows"] > 1


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit on the size of files")
def test_a_run_that_could_not_be_stored_says_so(tmp_path):
    """On a full disk runs are computed and answered, with a warning that names the reason; later ones are stored."""
    import resource

    with process(tmp_path, wait=60) as (started, address), Client(address) as client:
        assert posted(client, spec_data(seed=51))[2]["warning"] is None
        until(lambda: client.health()["runs"]["results"] == 1)
        unlimited = resource.prlimit(started.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(started.pid, resource.RLIMIT_FSIZE, (1, unlimited[1]))
        status, _, run = posted(client, spec_data(seed=52))
        assert (status, run["status"]) == (201, "done")
        until(lambda: client.get(run["links"]["self"])["warning"])
        for path, words in (("", "in memory only"), ("?lang=zh", "仅存于内存")):
            assert words in client.get(run["links"]["self"] + path)["warning"]
        assert "in memory only" in posted(client, spec_data(seed=53))[2]["warning"]
        resource.prlimit(started.pid, resource.RLIMIT_FSIZE, unlimited)
        assert posted(client, spec_data(seed=54))[2]["warning"] is None
        until(lambda: client.health()["runs"]["results"] == 2)
