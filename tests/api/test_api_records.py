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
    (fault,) = first["faults"]
    assert fault["best"]["channel"] == "friction" and 10 < fault["alarm"] < 11
    assert fault["best"]["size"]["low"] < 9 < fault["best"]["size"]["high"]
    assert [o["noise"] for o in first["fit"]["outputs"]] == pytest.approx([0.01, 0.01], rel=0.15)
    assert client.post("/api/diagnosis", {"plant": plant, "csv": csv(record)}) == first


def test_a_stored_record_is_diagnosed_and_fitted(client, record):
    """The diagnosis of an uploaded record is that of the same columns; the fit returns a complete plant."""
    stored = client.post("/api/records", {"plant": "friction-motor", "columns": record})
    body = {"plant": "friction-motor", "settings": {"healthy": {"begin": 0, "end": 9}}}
    here = client.post(f"/api/records/{stored['id']}/diagnosis", body)
    assert here == client.post("/api/diagnosis", {"columns": record} | body)
    assert here["healthy"]["given"] and [f["best"]["channel"] for f in here["faults"]] == ["friction"]
    name = library.plant("friction-motor").parameters[0].name
    body["settings"] |= {"fit": "chosen", "parameters": [name]}
    fit = client.post(f"/api/records/{stored['id']}/fit", body)
    assert [p["name"] for p in fit["report"]["parameters"]] == [name]
    assert fit["plant"]["id"] == "friction-motor" and fit["report"]["verdict"] == "fits-after-fit"
    with pytest.raises(ServiceError, match="404"):
        client.post("/api/records/0123456789abcdef/diagnosis", body)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"csv": "t,u.torque\n0,1\n1,x"}, "row 3"),
        ({"csv": "t,t\n0,1"}, "y_speed: no column"),
        ({"columns": None}, "columns or as csv"),
        ({"settings": {"healthy": {"begin": -1, "end": 5}}}, "settings.healthy.begin"),
        ({"settings": {"fit": "chosen", "parameters": ["inertness"]}}, "no parameter inertness"),
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
