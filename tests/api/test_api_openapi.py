"""The OpenAPI document is true: its examples work, and answers have the statuses, types and forms that it names."""

import json
import subprocess
import sys
from collections.abc import Iterator

import pytest

from tests.api.conftest import Client, service

CHECKS = (
    "not_a_server_error",
    "status_code_conformance",
    "content_type_conformance",
    "response_schema_conformance",
    "response_headers_conformance",
)
#: Values at the bounds of every parameter of requests without a body: those with a body are refused for reasons that a
#: schema cannot say, and take long.
PHASES = (("examples", ()), ("coverage", ("--include-method", "GET", "--max-time", "10")))


@pytest.fixture(scope="module")
def described(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a service that has done a run."""
    with service(tmp_path_factory.mktemp("described"), queue=100_000, max_seconds=20) as address:
        with Client(address) as client:
            client.run("zhao-2012", {"horizon": 1})
        yield address


@pytest.mark.parametrize(("phase", "more"), PHASES, ids=[phase for phase, _ in PHASES])
def test_schemathesis_finds_nothing(described, tmp_path, phase: str, more: tuple[str, ...]):
    """Requests made from the document get answers that it describes, and no error of the program."""
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "run", f"{described}/openapi.json", "--url", described),
        *("--phases", phase, "--checks", ",".join(CHECKS), "--continue-on-failure", "--no-shrink"),
        *("--generation-deterministic", "--no-color", "--output-truncate", "false", *more),
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert "Tested: " in done.stdout


@pytest.mark.parametrize("path", ["/api/runs", "/api/sessions", "/api/equations", "/api/plants/check", "/api/gains"])
def test_the_examples_of_bodies_are_accepted(client, path):
    """What /docs fills in works when it is tried."""
    document = client.get("/openapi.json")
    schema = document["paths"][path]["post"]["requestBody"]["content"]["application/json"]["schema"]
    for reference in schema.get("anyOf", [schema]):
        named = document["components"]["schemas"][reference["$ref"].rpartition("/")[2]]
        for body in named["examples"]:
            assert client.request("POST", path, json.dumps(body).encode())[0] in (200, 201, 202)


def test_bodies_may_be_yaml_where_the_document_says_so(client):
    """All bodies but the samples of a record: the document names YAML for them, and the service reads it."""
    operations = [o for path in client.get("/openapi.json")["paths"].values() for o in path.values()]
    bodies = [o["requestBody"]["content"] for o in operations if isinstance(o, dict) and "requestBody" in o]
    json_only = [content for content in bodies if "application/json" in content and "application/yaml" not in content]
    samples = "#/components/schemas/Record"
    assert len(bodies) > 15 and all(c["application/json"]["schema"].get("$ref") == samples for c in json_only)
    kind = {"Content-Type": "application/yaml"}
    status, _, answer = client.request("POST", "/api/equations", b"plant: dc-motor\nobservers: [joint-ekf]\n", kind)
    assert status == 200 and list(json.loads(answer)["observers"]) == ["joint-ekf"]
    session = client.post("/api/sessions", {"experiment": "dc-motor", "play": False})
    assert client.request("POST", session["links"]["fork"], b"t: 0\n", kind)[0] == 201


def test_a_refusal_with_a_number_that_is_not_finite_is_a_refusal(client):
    """The number of samples of a period of 5e-324 s is infinite, which JSON cannot say."""
    from thetascope.client import ServiceError

    with pytest.raises(ServiceError) as refusal:
        client.run("zhao-2012", {"horizon": 1, "measurement": {"mode": "sampled", "period": 5e-324}})
    assert refusal.value.status == 422


def test_columns_of_a_session_are_chosen(client):
    """Names and patterns select columns in their order; an unknown one is refused with the nearest."""
    from tests.api.streams import opened
    from thetascope.client import ServiceError

    path = opened(client, t=1)["links"]["data"]
    table = client.get(f"{path}?columns=y.y,kalman.theta.*")
    assert list(table["columns"]) == ["y.y", "kalman.theta.gain"]
    with pytest.raises(ServiceError) as refusal:
        client.get(f"{path}?columns=y.x")
    assert refusal.value.status == 422
