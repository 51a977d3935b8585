"""Damaged rows of a store over HTTP: whatever a field holds, lists show everything else."""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.api.conftest import service
from tests.runs.samples import spec_data
from thetascope.client import Client
from thetascope.store.tables import METADATA

WRONG = ("text", b"\xff\xfe", "{", "[1]", "{}", "[" * 100_000, -1e300)
WRONG += ('[{"label": {"code": "no.such", "args": {}}}]', '{"curve": 1, "state": [], "seed": ["x"]}')
LISTS = {
    "plants": ["/api/my-plants", "/api/my-plants/first/versions"],
    "records": ["/api/records"],
    "record_shares": ["/api/records", "/api/records/{record}", "/api/records/{record}/preview"],
    "runs": ["/api/runs", "/api/runs?group=tags", "/api/runs?sort=name", "/api/runs?q=second"],
}
LISTS |= {"run_facts": [*LISTS["runs"], "/api/runs?sort=rmse", "/api/runs?q=seed%3E50", "/api/runs?group=experiment"]}
LISTS |= {"run_notes": [*LISTS["runs"], "/api/runs?tag=second", "/api/runs/{run}"]}
CASES = [
    (table, column.name)
    for table in LISTS
    for column in METADATA.tables[table].columns
    if not column.primary_key and column.name not in ("removed", "data")
]


@pytest.fixture(scope="module")
def filled(tmp_path_factory) -> Iterator[tuple[Client, Path, dict[str, str]]]:
    """Return a service with two plants, records and runs, its store, and the ids of the first record and run."""
    folder = tmp_path_factory.mktemp("damaged")
    with service(folder, wait=60) as address, Client(address) as client:
        ids = {}
        for place, name in enumerate(("first", "second")):
            text, head = f"id: {name}\ntitle: A plant\n".encode(), {"Content-Type": "application/octet-stream"}
            client.request("PUT", f"/api/my-plants/{name}", text, head)
            rows = "t,u,y\n" + "".join(f"{k},1,{k + place}\n" for k in range(30))
            client.request("POST", f"/api/records?name={name}.csv&plant=dts200", rows.encode(), head)
            run = client.post("/api/runs", spec_data(seed=place + 50))["id"]
            notes = json.dumps({"name": name, "tags": ["a", name]}).encode()
            client.request("PATCH", f"/api/runs/{run}", notes, {"Content-Type": "application/json"})
            ids[name] = {"run": run, "record": client.get("/api/records")["records"][0]["id"]}
        yield client, folder / "runs.sqlite", ids["first"]


@pytest.mark.parametrize(("table", "column"), CASES)
def test_a_damaged_field_hides_no_other_row(filled, table: str, column: str):
    """Every list has as many entries as before; those with a condition have the other row."""
    client, store, ids = filled
    paths = [path.format(**ids) for path in LISTS[table]]
    before = [entries(client, path) for path in paths]
    assert all(before)
    key, value = {"plants": ("id", "first"), "records": ("id", ids["record"]), "runs": ("id", ids["run"])}.get(
        table, ("record", ids["record"]) if table == "record_shares" else ("run", ids["run"])
    )
    with closing(sqlite3.connect(store, timeout=30, isolation_level=None)) as connection:
        right = connection.execute(f"SELECT {column} FROM {table} WHERE {key} = ?", (value,)).fetchone()[0]
        try:
            for wrong in WRONG:
                connection.execute(f"UPDATE {table} SET {column} = ? WHERE {key} = ?", (wrong, value))
                for path, count in zip(paths, before, strict=True):
                    assert entries(client, path) == count, (path, wrong)
        finally:
            connection.execute(f"UPDATE {table} SET {column} = ? WHERE {key} = ?", (right, value))


def test_a_damaged_plant_can_be_deleted(filled):
    """Its versions are listed, and it goes as others do."""
    client, store, _ = filled
    client.request("PUT", "/api/my-plants/third", b"id: third\n", {"Content-Type": "application/yaml"})
    with closing(sqlite3.connect(store, timeout=30, isolation_level=None)) as connection:
        connection.execute("UPDATE plants SET text = 'x' WHERE id = 'third'")
    assert [line["version"] for line in client.get("/api/my-plants/third/versions")["plants"]] == [1]
    assert client.request("DELETE", "/api/my-plants/third")[0] == 204


def entries(client: Client, path: str) -> int:
    """Return how many entries the list of an answer has; 1 for another answer."""
    answer = client.get(path)
    return next((len(value) for name, value in answer.items() if name in ("plants", "records", "runs")), 1)
