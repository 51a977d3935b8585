"""Records over REST: upload, inspection, mapping, preview, owners, limits."""

import json

import numpy as np
import pytest
import yaml

from tests.api.conftest import ROOT, service
from tests.api.test_api_owners import KEY, browser, refused
from tests.test_docs import blocks
from thetascope.client import Client, ServiceError

TANK = yaml.safe_load(blocks(ROOT / "docs" / "plant-format.md", "yaml")[0])


def csv(rows: int = 300, head: str = "Time (s),Flow,Level (m)") -> bytes:
    rng = np.random.default_rng(0)
    lines = [f"{k},{50 if k // 60 % 2 else 65},{0.2 + 0.0005 * rng.standard_normal():.6f}" for k in range(rows)]
    return "\n".join([head, *lines, ""]).encode()


def upload(client: Client, data: bytes, query: str = "name=rig.csv") -> dict:
    return send(client, "POST", f"/api/records?{query}", data)


def send(client: Client, method: str, path: str, body: bytes) -> dict:
    headers = {"Content-Type": "application/octet-stream"}
    return json.loads(client.request(method, path, body, headers)[2])


def test_a_file_is_uploaded_mapped_and_drawn(client):
    """The columns are listed without a plant; a plant of one's own is mapped with the unit in the head."""
    first = upload(client, csv())
    assert first["rows"] == 300 and first["plant"] == "" and not first["ready"] and first["quantities"] == []
    assert [c["name"] for c in first["columns"]] == ["Time (s)", "Flow", "Level (m)"]
    plain = client.get(f"{first['links']['preview']}?intervals=10")
    assert [(s["name"], s["unit"], s["role"]) for s in plain["series"]] == [
        ("Flow", "", "unused"),
        ("Level (m)", "m", "unused"),
    ]
    path = first["links"]["mapping"]
    mapped = client.post(path, {"plant": TANK})
    assert mapped["ready"] and mapped["times"]["period"] == 1 and mapped["id"] == first["id"]
    assert {q["name"]: (q["column"], q["column_unit"], q["factor"]) for q in mapped["quantities"]} == {
        "q": ("Flow", "cm³/s", 1.0),
        "y": ("Level (m)", "m", 100.0),
    }
    again = client.get(first["links"]["self"])
    assert again == mapped
    same = client.post(path, {"plant": TANK, "mapping": mapped["mapping"]})
    assert [q["factor"] for q in same["quantities"]] == [1.0, 100.0] and same["mapping"] == mapped["mapping"]
    drawn = client.get(f"{first['links']['preview']}?intervals=10")
    level = next(s for s in drawn["series"] if s["name"] == "y")
    assert (
        len(drawn["t"]) == 10 and level["unit"] == "cm" and all(19.5 < v < 20.5 for v in level["low"] + level["high"])
    )
    raw = client.get(f"{first['links']['preview']}?intervals=10&file_units=true")
    assert all(0.195 < v < 0.205 for s in raw["series"] if s["name"] == "y" for v in s["low"])


def test_json_columns_and_csv_are_records_too(client):
    """Today's body of a record is stored as a file; the same plant is chosen with it."""
    columns = {"t": [0.1 * k for k in range(50)], "torque": [0.0] * 50, "y_speed": [0.01 * k for k in range(50)]}
    columns["y_acceleration"] = columns["y_speed"]
    found = client.post("/api/records", {"plant": "friction-motor", "columns": columns})
    assert found["plant"] == "friction-motor" and found["ready"] and found["format"] == "json"
    lines = [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]
    text = client.post("/api/records", {"plant": "friction-motor", "csv": "\n".join(lines)})
    assert text["ready"] and text["id"] != found["id"] and text["times"]["period"] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("data", "query", "words"),
    [
        (b"t,q,y\n0,1,2\n7\n1,2,3\n", "name=a.csv", "line 3"),
        (b"\x80\x04\x95...", "name=a.pkl", "loading them runs code"),
        (b"PAR1" + bytes(50), "name=a.parquet", "parquet"),
        (b"t,y\n0,1\n1,2\n", "name=a.csv&plant=no-such", "no-such"),
    ],
)
def test_a_file_that_cannot_be_read_is_refused_and_not_stored(client, data, query, words):
    """The refusal names line and cell, or the format and the remedy."""
    before = client.get("/api/records")
    with pytest.raises(ServiceError, match=words):
        upload(client, data, query)
    assert client.get("/api/records") == before


def test_a_wrong_mapping_is_refused_with_its_field(client):
    """An unknown column, quantity or unit names what there is."""
    path = upload(client, csv(40))["links"]["mapping"]
    for mapping, words in (
        ({"quantities": {"y": {"column": "Levl"}}}, "Level"),
        ({"quantities": {"z": {"column": "Flow"}}}, "q or y"),
        ({"quantities": {"y": {"column": "Flow", "unit": "bar"}}}, "bar cannot be converted to cm"),
        ({"time": {"column": "Time"}}, "Time"),
        ({"time": {"unit": "weeks"}}, "time.unit"),
    ):
        with pytest.raises(ServiceError, match=words) as refusal:
            client.post(path, {"plant": TANK, "mapping": mapping})
        assert refusal.value.status == 422


def test_sentences_are_in_the_language_that_is_asked_for(client):
    """Findings, reasons and problems are Chinese for a Chinese client."""
    id = upload(client, csv(60, "t,q,y"), "name=a.csv")["id"]
    client.post(f"/api/records/{id}/mapping", {"plant": TANK})
    chinese = client.get(f"/api/records/{id}?lang=zh")
    texts = [f["text"]["text"] for f in chinese["findings"]] + [q["reason"]["text"] for q in chinese["quantities"]]
    assert len(texts) > 2 and all(any("\u4e00" <= c <= "\u9fff" for c in text) for text in texts)


def test_records_belong_to_their_owners(tmp_path):
    """Others may read a record whose id they know, with a mapping of their own; only owners remove their share."""
    with service(tmp_path, host="0.0.0.0", key=KEY, record_limit="400k") as address:
        ann, eve = browser(address), browser(address)
        record = upload(ann, csv())["links"]
        ann.post(record["mapping"], {"plant": TANK})
        assert eve.get(record["self"])["ready"] and eve.get("/api/records")["records"] == []
        assert refused(eve, "DELETE", record["self"])["code"] == "run.not-owner"
        eve.post(
            record["mapping"], {"plant": TANK, "mapping": {"quantities": {"y": {"column": "Level (m)", "unit": "mm"}}}}
        )
        assert [q["column_unit"] for q in ann.get(record["self"])["quantities"]] == ["cm³/s", "m"]
        assert [q["column_unit"] for q in eve.get(record["self"])["quantities"]] == ["cm³/s", "mm"]
        assert len(ann.get("/api/records")["records"]) == len(eve.get("/api/records")["records"]) == 1
        assert ann.request("DELETE", record["self"])[0] == 204 and eve.get(record["self"])["ready"]
        assert eve.request("DELETE", record["self"])[0] == 204
        with pytest.raises(ServiceError) as gone:
            eve.get(record["self"])
        assert gone.value.status == 404
        noise = np.random.default_rng(1).standard_normal(12_000)
        large = "t,y\n" + "\n".join(f"{k},{v}" for k, v in enumerate(noise))
        with pytest.raises(ServiceError) as full:
            upload(ann, large.encode())
        assert full.value.status == 413 and full.value.problem["code"] == "record.no-room"
        ann.close()
        eve.close()
