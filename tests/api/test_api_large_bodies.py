"""Large bodies are read in worker processes, so that nobody else waits meanwhile, and answered as small ones are."""

import json
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

from tests.runs.samples import PLANT, spec_data

PADDING = " " * 70_000  # Bodies of more than 64 kB are large.


@pytest.fixture
def post(address):
    """Send a body as JSON; return the status and the data of the answer."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)

    def post_one(path: str, body: str) -> tuple[int, dict]:
        connection.request("POST", path, body, {"Content-Type": "application/json"})
        answer = connection.getresponse()
        return answer.status, json.loads(answer.read())

    yield post_one
    connection.close()


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/api/plants/check", PLANT),
        ("/api/plants/check", PLANT | {"dynamics": {"x": "-a*z"}}),
        ("/api/plants/check", PLANT | {"states": [{"name": f"x{i}"} for i in range(300)]}),
        ("/api/gains", spec_data()),
        ("/api/gains", spec_data(observers=[{"label": "a", "kind": "kalmann"}])),
        ("/api/equations", {"plant": "zhao-contois", "observers": ["zhao-adaptive"]}),
        ("/api/equations", {"plant": "zhao-contoi"}),
        ("/api/sessions", {"experiment": "zhao-2012", "spec": spec_data()}),
        ("/api/sessions", {"spec": spec_data(horizon="long")}),
        ("/api/runs", {"experiment": "dc-motor", "set": {"nothing": 1}}),
        ("/api/observability", spec_data(plant=PLANT | {"title": {"en": "Lag", "zh": "惯性环节"}})),
    ],
)
def test_a_large_body_is_answered_as_the_same_without_padding(post, path: str, body: dict):
    """The answer names the same fields, and texts in several languages arrive in all of them."""
    text = json.dumps(body)
    assert post(path, text + PADDING) == post(path, text)


def test_a_large_body_of_a_run_is_the_same_run(post):
    """The run of the same spec is found again: its id is that of the spec."""
    text = json.dumps(spec_data(seed=76))
    status, run = post("/api/runs", text + PADDING)
    assert status == 201 and post("/api/runs", text) == (200, run)


@pytest.mark.parametrize("large", [False, True])
def test_a_large_body_is_read_in_a_worker(address, post, large: bool):
    """A worker refuses text that is no JSON, with its place; a small one is refused by the service itself."""
    before = computations(address)
    status, problem = post("/api/runs", '{"plant": [' + PADDING * large + "}")
    assert status == 422 and problem["errors"][0]["code"] == "body.json"
    assert computations(address) - before == large


def computations(address: str) -> int:
    """Return how many computations have ended in worker processes."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=120)
    connection.request("GET", "/metrics")
    lines = connection.getresponse().read().decode().splitlines()
    connection.close()
    return int(
        sum(float(line.split()[-1]) for line in lines if line.startswith("thetascope_computations_ended_total{"))
    )
