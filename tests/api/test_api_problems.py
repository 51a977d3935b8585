"""Every refusal is a problem document that names the field, the value and the remedy; never a traceback."""

import json
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

from tests.runs.samples import PLANT, spec_data
from thetascope.client import ServiceError

JSON = {"Content-Type": "application/json"}


@pytest.fixture
def send(address):
    """Send a raw request; return status, headers and the problem document."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)

    def send_one(method: str, path: str, body: object = None, headers: dict | None = None) -> tuple[int, dict, dict]:
        body = json.dumps(body) if isinstance(body, dict | list) else body
        connection.request(method, path, body, JSON if headers is None else headers)
        answer = connection.getresponse()
        content = answer.read()
        assert answer.headers["content-type"] == "application/problem+json"
        assert b"Traceback" not in content
        problem = json.loads(content)
        assert problem["status"] == answer.status and problem["title"]
        return answer.status, dict(answer.headers), problem

    yield send_one
    connection.close()


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"horizon": "long"}, "horizon", "number"),
        ({"horizon": -1}, "horizon", "greater than 0"),
        ({"horizn": 1}, "horizn", "did you mean horizon"),
        ({"step": 5}, "step", "longer than the horizon"),
        ({"seed": 1.5}, "seed", "whole number"),
        ({"plant": "contoi"}, "plant", "contois"),
        ({"plant": None}, "plant", ""),
        ({"plant": "../lag.yaml"}, "plant", "command line only"),
        ({"plant": "/etc/passwd"}, "plant", "command line only"),
        ({"plant": "lag.json"}, "plant", "command line only"),
        ({"noise": {"z": {"std": 1}}}, "noise.z", "use one of: y"),
        ({"faults": [{"channel": "gain", "shape": "stepp", "onset": 1, "size": 1}]}, "faults[0]", "step"),
        (
            {"faults": [{"channel": "gian", "shape": "step", "onset": 1, "size": 1}]},
            "faults[0].channel",
            "did you mean gain",
        ),
        ({"inputs": {"u": {"kind": "sine", "amplitude": "x", "frequency": 1}}}, "inputs.u.amplitude", "number"),
        ({"observers": [{"label": "a", "kind": "kalmann"}]}, "observers[0].kind", "adaptive-kalman"),
        ({"observers": [{"label": "a", "kind": "joint-ekf", "gains": {"nope": 1}}]}, "observers[0].gains.nope", ""),
        ({"plant": {**PLANT, "dynamics": {"x": "-a*x + __import__('os')"}}}, "plant.dynamics.x", "column"),
        ({"plant": {**PLANT, "dynamics": {"x": "u.__class__"}}}, "plant.dynamics.x", "column"),
        ({"horizon": 1e9, "step": 1e-3}, "step", "the limit is"),
        ({"horizon": 20000, "step": 1e-3, "record": 1e-3}, "record", "are allowed"),
    ],
)
def test_a_wrong_spec_names_the_field_the_value_and_the_remedy(send, change, field, words):
    """The status is 422, whichever part of the program finds the error."""
    status, _, problem = send("POST", "/api/runs", spec_data() | change)
    assert status == 422
    first = problem["errors"][0]
    assert first["field"] == field
    assert words in json.dumps(problem, ensure_ascii=False)
    assert first["problem"] and first["remedy"]
    assert first["field"] in problem["detail"]


@pytest.mark.parametrize(
    "body",
    [
        "",
        "{",
        "[1, 2",
        '{"a": NaN}',
        '"text"',
        "null",
        "[]",
        "3",
        "[" * 3000,
        '{"a":' * 900 + "1" + "}" * 900,
        "\x00",
        "é",
    ],
)
def test_a_body_that_is_not_a_json_object_is_refused(send, body):
    """It may be truncated, of another type, or nested a thousand deep."""
    assert send("POST", "/api/runs", body.encode())[0] == 422


def test_a_run_request_reports_its_own_fields(send):
    """Errors have their paths; unknown ids come with the nearest known ones."""
    status, _, problem = send("POST", "/api/runs", {"experiment": "zhao-2021"})
    assert status == 404 and "zhao-2012" in problem["detail"]
    status, _, problem = send(
        "POST", "/api/runs", {"experiment": "zhao-2012", "set": {"observers.adaptive.gain.rho": 1}}
    )
    assert status == 422 and "did you mean gains" in problem["detail"]
    status, _, problem = send("POST", "/api/runs", {"experiment": "zhao-2012", "sett": {}})
    assert status == 422 and problem["errors"][0]["field"] == "sett"


def test_a_body_with_too_large_a_content_length_is_refused_before_it_is_read(address):
    """The answer comes after the headers alone."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    connection.putrequest("POST", "/api/runs")
    connection.putheader("Content-Type", "application/json")
    connection.putheader("Content-Length", str(10**9))
    connection.endheaders()
    answer = connection.getresponse()
    assert answer.status == 413
    assert "1,000,000,000" in json.loads(answer.read())["detail"]


def test_a_body_over_the_limit_in_chunks_is_cut_off(address):
    """Without a Content-Length the bytes are counted."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    chunks = (b" " * 10_000 for _ in range(25))
    connection.request("POST", "/api/runs", chunks, JSON, encode_chunked=True)
    answer = connection.getresponse()
    assert answer.status == 413 and b"204,800" in answer.read()


def test_a_body_of_another_type_is_refused(send):
    """415 names the type sent and the one required; a form on another site cannot start a run either."""
    for kind in ("text/plain", "application/x-www-form-urlencoded", "application/xml"):
        status, _, problem = send("POST", "/api/runs", "{}", {"Content-Type": kind})
        assert status == 415 and kind in problem["detail"]
    assert send("POST", "/api/runs", "{}", {})[0] == 415


@pytest.mark.parametrize("kind", ["application/yaml", "text/yaml; charset=utf-8"])
def test_a_body_in_yaml_is_read_as_the_same_in_json(client, send, kind):
    """The run of an experiment is the same, and a wrong line is named."""
    yaml = "# a comment\nexperiment: shen-hu-2015\nset:\n  horizon: 0.5\n"
    spec = {"experiment": "shen-hu-2015", "set": {"horizon": 0.5}}
    of_yaml = client.request("POST", "/api/runs?wait=60", yaml.encode(), {"Content-Type": kind})[2]
    assert json.loads(of_yaml)["id"] == client.post("/api/runs?wait=60", spec)["id"]
    status, _, problem = send("POST", "/api/runs", "experiment: a\n  set: b\n", {"Content-Type": kind})
    assert status == 422 and "line 2" in problem["detail"]
    status, _, problem = send("POST", "/api/runs", "experiment: &a [b, b]\nset: *a\n", {"Content-Type": kind})
    assert status == 422 and "line 1" in problem["detail"]


def test_unknown_addresses_and_methods_are_problem_documents(send):
    """404 has near matches, 405 the permitted methods."""
    assert send("GET", "/api/nothing")[0] == 404
    assert send("GET", "/nothing")[0] == 404
    status, headers, problem = send("PATCH", "/api/runs")
    assert (status, headers["allow"]) == (405, "GET, POST")
    assert "use GET or POST" in problem["detail"]
    status, _, problem = send("GET", "/api/plants/zhao-contoiss")
    assert status == 404 and "did you mean zhao-contois" in problem["detail"]
    assert send("GET", "/api/runs/0123456789abcdef")[0] == 404


def test_a_page_of_another_site_cannot_change_anything(send):
    """Browsers state the origin of a request."""
    assert send("POST", "/api/runs", spec_data(), {**JSON, "Sec-Fetch-Site": "cross-site"})[0] == 403


def test_a_plant_is_checked_and_an_error_has_its_position(client):
    """Φ and Ψ are derived from the text; an error has its column."""
    report = client.check(PLANT)
    assert report["Phi"] == [["u"]] and report["sizes"]["channels"] == 1
    with pytest.raises(ServiceError) as refusal:
        client.check({**PLANT, "dynamics": {"x": "-a*x + 9**9**9"}})
    assert refusal.value.problem["errors"][0]["field"] == "dynamics.x"
    assert "column" in refusal.value.problem["errors"][0]["problem"]
