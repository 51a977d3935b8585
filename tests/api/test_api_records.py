"""Recorded data over HTTP: the same diagnosis as on the command line."""

import numpy as np
import pytest

from thetascope import library
from thetascope.client import ServiceError


@pytest.fixture
def record(client) -> dict[str, list[float]]:
    """Return simulated measurements of the motor whose friction rises tenfold at 10 s."""
    run = client.post("/api/runs?wait=60", {"experiment": "friction-motor", "set": {"seed": 5}})
    data = client.get(f"/api/runs/{run['id']}/data?format=json")["columns"]
    return {
        n: [float(f"{x:.6g}") for x in v] for n, v in data.items() if n == "t" or n.startswith(("u.", "signal.", "y."))
    }


def csv(columns: dict[str, list[float]]) -> str:
    return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in zip(*columns.values(), strict=True))])


def test_a_record_is_diagnosed(client, record):
    """Columns or CSV text, a library plant or a whole one give the same fault, onset, size and noise."""
    plant = library.plant("friction-motor").model_dump(mode="json")
    first = client.post("/api/diagnosis", {"plant": "friction-motor", "columns": record})
    (alarm,) = first["alarms"]
    assert alarm["channel"] == "friction" and 10 < alarm["t"] < 11 and alarm["size_from"] < 9 < alarm["size_to"]
    assert [n["estimated"] for n in first["noise"]] == pytest.approx([0.01, 0.01], rel=0.15)
    assert client.post("/api/diagnosis", {"plant": plant, "csv": csv(record)}) == first


def test_a_healthy_beginning_is_learnt(client, record):
    """With ``learn`` deviations in the first seconds are attributed to the plant;
    other settings are the experiment's."""
    body = {"plant": "friction-motor", "columns": record, "learn": 5.0, "diagnosis": {"confidence": 0.9}}
    (alarm,) = client.post("/api/diagnosis", body)["alarms"]
    assert alarm["channel"] == "friction" and alarm["t"] > 10


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"csv": "t,u.torque\n0,1\n1,x"}, "line 3"),
        ({"csv": "t,t\n0,1"}, "a name appears twice"),
        ({"columns": None}, "columns or as csv"),
        ({"learn": -1}, "learn"),
        ({"plant": "friction-moter"}, "friction-motor"),
        ({"columns": {"t": [0.0, 1.0], "y": [0.0]}}, "columns.y"),
        ({"columns": {"t": list(np.arange(300.0))}}, "y_speed"),
    ],
)
def test_an_invalid_record_is_refused(client, record, change, words):
    """Each error names its field and the remedy."""
    body = {"plant": "friction-motor", "columns": record} | ({"columns": None} if "csv" in change else {}) | change
    with pytest.raises(ServiceError, match=words):
        client.post("/api/diagnosis", body)


def test_the_observability_of_an_experiment(client):
    """zhao-2012 has full structural rank and full rank in every window; at constant input dc-motor's speed sensor bias
    is hidden."""
    spec = library.experiment("zhao-2012").model_dump(mode="json")
    found = client.post("/api/observability", spec)
    assert (
        found["rank"] == found["size"] == 5
        and set(found["ranks"]) == {5}
        and len(found["t"]) == len(found["conditions"]) > 3
    )
    assert all(c > 1 for c in found["conditions"]) and "rank 5 of 5" in found["along"]["text"]
    hidden = client.post("/api/observability", library.experiment("dc-motor").model_dump(mode="json"))
    assert hidden["rank"] == hidden["size"] == 7 and 6 in hidden["ranks"] and "speed_bias" in hidden["along"]["text"]
    assert [c is None for c in hidden["conditions"]] == [r < 7 for r in hidden["ranks"]]
    with pytest.raises(ServiceError, match="dc-motor"):
        client.post("/api/observability", spec | {"plant": "dc-moter"})
