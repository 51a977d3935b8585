"""Operation: health, readiness, metrics, log lines with the ids of requests, and the audit."""

import json
from collections.abc import Iterator
from email.message import Message
from http.client import HTTPConnection
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families

from tests.api.conftest import Client, process, until
from tests.runs.samples import long_data, spec_data
from thetascope.api.http.services import Services
from thetascope.api.operation.log_format import TextLines
from thetascope_schemas.service.health import Health, Ready


@pytest.fixture(scope="module")
def logged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Client, Path]]:
    """A service with room for one run, and the file of its log lines."""
    folder = tmp_path_factory.mktemp("operation")
    settings = {"log": "json", "log_requests": 1, "queue": 0, "workers": 1, "wait": 60}
    with (
        (folder / "log").open("wb") as log,
        process(folder / "data", log, **settings) as (_, address),
        Client(address, timeout=120) as client,
    ):
        yield client, folder / "log"


def get(client: Client, path: str, **headers: str) -> tuple[int, Message, dict]:
    """Return status, headers and JSON of an answer, whatever its status."""
    connection = HTTPConnection(client._connection.host, client._connection.port, timeout=120)
    connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, answer.headers, json.loads(content)


def lines(log: Path) -> list[dict]:
    """Return the log lines so far; each is one JSON object."""
    return [json.loads(line) for line in log.read_text().splitlines()]


def metrics(client: Client) -> dict[str, dict[tuple, float]]:
    """Return the samples by name and labels, as Prometheus' own parser reads them."""
    status, headers, content = client.request("GET", "/metrics")
    assert status == 200 and headers["content-type"].startswith("text/plain")
    samples: dict[str, dict[tuple, float]] = {}
    for family in text_string_to_metric_families(content.decode()):
        for sample in family.samples:
            samples.setdefault(sample.name, {})[tuple(sample.labels.values())] = sample.value
    return samples


def test_health_says_that_the_service_answers_and_is_ready(logged):
    """Three addresses: versions and usage, alive, ready with its conditions."""
    client, _ = logged
    assert Health.model_validate(client.get("/api/health")).status == "ok"
    assert client.get("/api/health/live") == {"status": "alive"}
    ready = Ready.model_validate(client.get("/api/health/ready"))
    assert ready.status == "ready" and ready.free > 0
    assert [(check.name, check.ok) for check in ready.checks] == [("store", True), ("disk", True), ("queue", True)]


def test_a_full_queue_is_not_ready(logged):
    """With its only place taken the service is alive, but not ready, and says why in the language of the request."""
    client, _ = logged
    run = json.loads(client.request("POST", "/api/runs?wait=0", json.dumps(long_data(seed=5)).encode())[2])
    status, _, answer = get(client, "/api/health/ready?lang=zh")
    assert status == 503 and answer["status"] == "not ready"
    assert [check["name"] for check in answer["checks"] if not check["ok"]] == ["queue"]
    assert "已占用 1 个" in answer["checks"][2]["detail"]
    assert client.get("/api/health/live") == {"status": "alive"}
    client.cancel(run["id"])
    until(lambda: get(client, "/api/health/ready")[0] == 200)


def test_a_store_or_a_disk_that_cannot_be_written_is_not_ready(tmp_path, monkeypatch):
    """A store that another program holds, and a full disk, are named."""
    import shutil

    from thetascope.api.operation import health
    from thetascope.settings import load
    from thetascope.store import StoreError

    services = Services.start(load({"THETASCOPE_DATA": str(tmp_path)}))
    try:
        assert [check["ok"] for check in health._checks(services, "en")[0]] == [True, True, True]
        monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(1000, 999, 1))

        def locked(*_: object) -> object:
            raise StoreError(health.Message("store.disk-full", path="runs.sqlite", detail="full"))

        monkeypatch.setattr(type(services.database), "writing", locked)
        checks, free = health._checks(services, "en")
        assert free == 1 and [check["ok"] for check in checks] == [False, False, True]
    finally:
        services.close()


def test_every_answer_has_the_id_of_its_request_and_a_log_line(logged):
    """A proxy's id is kept where it is harmless, and replaced where it is not; refusals have lines, too."""
    client, log = logged
    for sent, kept in (("abc-123", True), ("x" * 65, False), ('"}{', False)):
        status, headers, _ = get(client, "/api/nothing", X_Request_ID=sent)
        id = headers["x-request-id"]
        assert status == 404 and (id == sent) == kept
        until(lambda id=id: any(line.get("request") == id for line in lines(log)))
        (line,) = (line for line in lines(log) if line.get("request") == id)
        assert (line["method"], line["path"], line["status"]) == ("GET", "/api/nothing", 404)
        assert line["client"] == "127.0.0.1" and line["ms"] >= 0


def test_removing_pinning_and_ending_leave_a_line_in_the_audit(logged):
    """Each names the run or session and the request."""
    client, log = logged
    run = client.run("zhao-2012", {"horizon": 1})["id"]
    client.request("PUT", f"/api/runs/{run}/pin")
    client.request("DELETE", f"/api/runs/{run}/pin")
    client.request("DELETE", f"/api/runs/{run}")
    body = json.dumps({"experiment": "zhao-2012"}).encode()
    session = json.loads(client.request("POST", "/api/sessions", body)[2])
    client.request("DELETE", f"/api/sessions/{session['id']}", headers={"X-Control-Token": session["token"]})
    until(lambda: any(line.get("event") == "session.ended" for line in lines(log)))
    events = [line for line in lines(log) if line["logger"] == "thetascope.audit" and line.get("run") == run]
    assert [line["event"] for line in events] == ["run.pinned", "run.unpinned", "run.removed"]
    assert all(line["request"] and line["client"] == "127.0.0.1" for line in events)
    assert [line["session"] for line in lines(log) if line.get("event") == "session.ended"] == [session["id"]]


def test_metrics_count_requests_runs_and_computations(logged):
    """Counters grow by the requests made; ids of runs never become labels."""
    client, _ = logged
    begin = metrics(client)
    run = client.run(spec_data(seed=31))  # on a busy machine it asks for the run until that has ended
    before = metrics(client)
    for _ in range(3):
        client.get(f"/api/runs/{run['id']}")
    get(client, "/some/where/else")
    after = metrics(client)

    def grown(name: str, *labels: str) -> float:
        return after[name].get(labels, 0) - before[name].get(labels, 0)

    assert grown("thetascope_request_seconds_count", "GET", "/api/runs/{id}", "200") == 3
    assert grown("thetascope_request_seconds_count", "GET", "other", "404") == 1
    before = begin
    assert grown("thetascope_run_seconds_count", "done") == 1
    assert grown("thetascope_computations_ended_total", "done") == 1
    assert after["process_resident_memory_bytes"][()] > 1e7
    assert after["thetascope_runs_stored"][()] >= 1 and after["thetascope_sessions"][()] == 0
    labels = {label for samples in after.values() for sample in samples for label in sample}
    assert not any(run["id"] in label or "where" in label for label in labels)


def test_a_line_of_text_stays_one_line(caplog):
    """Line ends and terminal commands that a client sends are escaped; a long field is cut."""
    import logging

    record = logging.LogRecord("thetascope.requests", logging.INFO, "", 0, "", (), None)
    record.fields = {"path": "/a\n2026 forged\x1b[2J", "agent": "x" * 10_000}
    line = TextLines().format(record)
    assert "\n" not in line and "\x1b" not in line and r"/a\n2026 forged\x1b[2J" in line and len(line) < 3000


def test_a_wrong_form_of_the_log_is_refused(tmp_path):
    """The setting, its value and the choices are named."""
    from thetascope.settings import SettingsError, load

    with pytest.raises(SettingsError, match="THETASCOPE_LOG is 'xml'. Set it to text or json"):
        load({"THETASCOPE_LOG": "xml", "THETASCOPE_DATA": str(tmp_path)})
