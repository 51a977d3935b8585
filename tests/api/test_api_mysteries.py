"""/api/mysteries: the record of a seed, answers with their points, and no way to the truth before an answer."""

import http.client
import json
import re

import pytest

from thetascope.challenge import draw
from thetascope.client import Client, ServiceError

SEED = "11"
"""Two tanks with a leak, sudden, that can be told soon."""


def test_a_seed_returns_the_same_record(client: Client):
    """What the page gets has inputs, outputs and what observers make of them, for each suspect."""
    mystery = client.get(f"/api/mysteries/{SEED}")
    assert mystery == client.get(f"/api/mysteries/{SEED}")
    rows = round(mystery["end"] / mystery["record"]) + 1
    assert all(len(column["values"]) == rows for column in mystery["columns"])
    suspects = {choice["channel"] for choice in mystery["choices"]}
    assert suspects == {c["observer"] for c in mystery["columns"] if c["of"] == "theta"} == {"pump", "leak", "bias"}
    assert all(choice["title"]["zh"] for choice in mystery["choices"])


def test_a_plant_can_be_chosen(client: Client):
    """The easiest set-up is first, and a seed draws another mystery in each."""
    setups = client.get("/api/mysteries")["setups"]
    assert [one["suspects"] for one in setups] == sorted(one["suspects"] for one in setups)
    drawn = client.get(f"/api/mysteries/{SEED}?setup={setups[1]['id']}")
    assert drawn["setup"] == setups[1]["id"] and len(drawn["choices"]) == setups[1]["suspects"]


def test_an_answer_is_graded_beside_the_detector(client: Client):
    """The right leak earns nearly everything, a wrong name nothing; sentences are in the language of the request."""
    fault = draw(f"mystery:{SEED}").fault
    assert fault is not None
    right = {"verdict": "channel", "channel": "leak", "onset": 700, "size": 1.1 * fault.size, "at": 800}
    solution = client.post(f"/api/mysteries/{SEED}/answer", right)
    assert solution["truth"]["fault"]["channel"] == solution["detector"]["channel"] == "leak"
    assert solution["score"]["total"] >= 90 and solution["detector_score"]["total"] >= 90
    assert [p["of"] for p in solution["score"]["points"]] == ["name", "size", "soon", "accused"]
    assert solution["experiment"]["faults"][0]["onset"] == fault.onset
    wrong = client.post(f"/api/mysteries/{SEED}/answer?lang=zh", right | {"channel": "bias"})
    assert wrong["score"]["total"] == 0
    assert wrong["score"]["points"][0]["why"]["text"] == "不对"


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        ("/api/mysteries/UPPER", None, 404),
        (f"/api/mysteries/{SEED}?setup=ten-tanks", None, 404),
        (f"/api/mysteries/{'a' * 17}", None, 404),
        (f"/api/mysteries/{SEED}/answer", {"verdict": "channel", "channel": "flood", "at": 1}, 422),
        (
            f"/api/mysteries/{SEED}/answer",
            {"verdict": "none", "at": 1, "accused": [{"channel": "flood", "at": 1}]},
            422,
        ),
        (f"/api/mysteries/{SEED}/answer", {"verdict": "channel", "at": 1}, 422),
        (f"/api/mysteries/{SEED}/answer", {}, 422),
    ],
)
def test_unknown_seeds_and_answers_are_refused(client: Client, path: str, body: dict | None, status: int):
    """A refusal says what is possible, and nothing of the truth."""
    with pytest.raises(ServiceError) as refused:
        client.get(path) if body is None else client.post(path, body)
    assert refused.value.status == status
    assert "onset" not in str(refused.value)


def test_no_route_discloses_the_truth_before_an_answer(address: str, client: Client):
    """Every route that can be read, tried with the seed, answers without onset, size, noise seed or the experiment."""
    seed = "4k"
    drawn = draw(f"mystery:{seed}")
    assert drawn.fault is not None
    secrets = {str(drawn.seed), str(drawn.fault.size)}
    question = json.dumps(client.get(f"/api/mysteries/{seed}"))
    words = set(re.findall(r'"(\w+)":', question))
    assert not words & {"fault", "faults", "onset", "size", "truth", "seed_of_noise", "experiment", "alike", "rivals"}
    before = len(client.get("/api/runs")["runs"])
    for path, methods in client.get("/openapi.json")["paths"].items():
        if "get" not in methods:
            continue
        for name in (seed, f"mystery:{seed}", f"mystery-{seed}", "mystery"):
            answer = read(address, re.sub(r"\{[^}]+\}", name, path))
            assert not any(re.search(rf'"(size|seed)":\s*{re.escape(secret)}\b', answer) for secret in secrets), path
    assert len(client.get("/api/runs")["runs"]) == before, "a mystery is no run that could be read"


def read(address: str, path: str) -> str:
    """Return the answer to a GET as text, whatever its status; of a stream, its beginning."""
    link = http.client.HTTPConnection(address.removeprefix("http://"), timeout=60)
    try:
        link.request("GET", path.replace(":", "%3A"))
        return link.getresponse().read(2_000_000).decode("utf-8", "replace")
    finally:
        link.close()
