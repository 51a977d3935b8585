"""A damaged store over HTTP: whatever a field of any table holds, the other rows are shown, and every error says why.

In one column of a table all rows but the last two are damaged, each in another way. Then the lists and every address
that reads these rows are asked for, and the rows are changed and deleted.
"""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest

from tests.api.conftest import service
from tests.api.test_api_my_lessons import LESSON
from tests.runs.samples import spec_data
from thetascope.store.tables import METADATA

DAMAGES: dict[str, tuple[str, tuple[object, ...]]] = {
    "null": ("NULL", ()),
    "bytes": ("?", (b"\xff\xfe",)),
    "not UTF-8": ("CAST(? AS TEXT)", (b"\xff{\xed\xa0\x80",)),
    "word": ("?", ("text\0",)),
    "cut JSON": ("?", ('{"a": [1',)),
    "other list": ("?", ('[1, "\\ud800", {"label": {"code": "no.such", "args": {}}}]',)),
    "other object": ("?", ('{"curve": 1, "state": ["\\ud800"], "seed": ["x"], "observers": 3, "names": "t"}',)),
    "other label": ("?", ('[{"label": {"code": "no.such", "args": {}}}]',)),
    "deep JSON": ("?", ("[" * 100_000,)),
    "huge": ("?", (-1e300,)),
    "infinite": ("9e999", ()),
    "integer": ("?", (2**63 - 1,)),
}
"""SQL of a value, and its parameters."""

COLUMNS = [(table.name, column.name) for table in METADATA.sorted_tables for column in table.columns]
KINDS = {"plants": "plants", "lessons": "lessons", "records": "records", "record_shares": "records"}
"""The lists in which tables appear; all others: runs."""
LISTS = {"plants": ["/api/my-plants"], "lessons": ["/api/my-lessons"], "records": ["/api/records"]}
LISTS["runs"] = [
    f"/api/runs{query}"
    for query in (
        "",
        "?group=tags",
        "?group=experiment",
        "?sort=name",
        "?sort=rmse",
        "?q=seed%3E50",
        "?tag=all",
        "?q=run",
    )
]
CONDITIONS = ("?q", "?tag")
N = len(DAMAGES)
WHOLE, OTHER = N, N + 1


class Filled:
    """A service with N + 2 rows of every kind, the last two of which are never damaged."""

    def __init__(self, address: str, store: Path) -> None:
        self.connection, self.store = HTTPConnection(address.removeprefix("http://"), timeout=120), store
        self.ids: dict[str, list[str]] = {"plants": [], "lessons": [], "records": [], "runs": []}
        for i in range(N + 2):
            text = f"id: plant-{i}\ntitle: Plant {i}\n".encode()
            self.ids["plants"].append(self.send("PUT", f"/api/my-plants/plant-{i}", text, "yaml")["id"])
            self.ids["lessons"].append(self.send("POST", "/api/my-lessons", {**LESSON, "id": f"lesson-{i}"})["id"])
            rows = "t,u,y\n" + "".join(f"{k},1,{k + i}\n" for k in range(30))
            path = f"/api/records?name=record-{i}.csv&plant=dts200"
            self.ids["records"].append(self.send("POST", path, rows.encode(), "octet-stream")["id"])
            run = self.send("POST", "/api/runs?wait=60", spec_data(seed=i + 50))["id"]
            self.ids["runs"].append(run)
            self.send("PATCH", f"/api/runs/{run}", {"name": f"run {i}", "tags": ["all", f"tag {i}"]})
        for i in range(N + 1):
            self.send("PUT", self.compared(i).replace("?", "/notes?"), {"text": f"note {i}"})
        with self.opened() as connection:  # a flipped bit does not mind a constraint
            connection.execute("PRAGMA writable_schema = 1")
            connection.execute("UPDATE sqlite_schema SET sql = replace(sql, ' NOT NULL', '') WHERE type = 'table'")
            version = connection.execute("PRAGMA schema_version").fetchone()[0]
            connection.execute(f"PRAGMA schema_version = {version + 1}")
        with self.opened() as connection:
            rows = {name: connection.execute(f"SELECT rowid, * FROM {name} ORDER BY rowid") for name in METADATA.tables}
            self.rows = {name: found.fetchall() for name, found in rows.items()}
        assert all(len(rows) > N for rows in self.rows.values())

    def opened(self) -> Any:
        return closing(sqlite3.connect(self.store, timeout=60, isolation_level=None))

    def answer(self, method: str, path: str, body: object = None, kind: str = "json") -> tuple[int, bytes]:
        """Return status and content of an answer; the service closes the connection after an error of its own."""
        data = body if isinstance(body, bytes | None) else json.dumps(body).encode()
        self.connection.request(method, path, data, {"Content-Type": f"application/{kind}"} if data else {})
        answer = self.connection.getresponse()
        content = answer.read()
        if answer.status >= 500:
            self.connection.close()
        return answer.status, content

    def send(self, method: str, path: str, body: object = None, kind: str = "json") -> Any:
        """Return the JSON of an answer without an error."""
        status, content = self.answer(method, path, body, kind)
        assert status < 300, (method, path, content)
        return json.loads(content)

    def compared(self, i: int) -> str:
        return f"/api/runs/compare?ids={self.ids['runs'][i]},{self.ids['runs'][OTHER]}"

    def reads(self, table: str, i: int) -> list[str]:
        """Return the addresses that read row i of a table."""
        kind = KINDS.get(table, "runs")
        id = self.ids[kind][i]
        if kind == "plants":
            return [f"/api/my-plants/{id}", f"/api/my-plants/{id}/versions", f"/api/plants/{id}/text"]
        if kind == "lessons":
            return [f"/api/my-lessons/{id}", f"/api/course/{id}", f"/api/course/{id}/file"]
        if kind == "records":
            return [f"/api/records/{id}", f"/api/records/{id}/preview", f"/api/records/{id}/plant"]
        run = f"/api/runs/{id}"
        if table in ("runs", "results"):
            results = (
                "data?format=csv",
                "data?format=json",
                "comparison.csv",
                "figures",
                "report",
                "data?format=parquet",
            )
            return [run, f"{run}/progress", f"{run}/{results[i % len(results)]}"]
        return [run, self.compared(i)]

    def changes(self, table: str, i: int) -> list[tuple[str, str, object]]:
        """Return requests that change and delete row i of a table."""
        kind = KINDS.get(table, "runs")
        id = self.ids[kind][i]
        if kind == "plants":
            path = f"/api/my-plants/{id}"
            return [
                ("PUT", path, {"id": id, "title": "new"}),
                ("DELETE", path, None),
                ("POST", f"{path}/restore", None),
            ]
        if kind == "lessons":
            path = f"/api/my-lessons/{id}"
            changed = {**LESSON, "id": id, "minutes": 7}
            return [
                ("POST", "/api/my-lessons", changed),
                ("DELETE", path, None),
                ("POST", f"{path}/restore", None),
            ]
        if kind == "records":
            return [("DELETE", f"/api/records/{id}", None)]
        return [
            ("PATCH", f"/api/runs/{id}", {"name": "new", "tags": ["x"], "pinned": True}),
            ("PUT", self.compared(i).replace("?", "/notes?"), {"text": "new"}),
            ("DELETE", f"/api/runs/{id}", None),
            ("POST", f"/api/runs/{id}/restore", None),
            ("POST", "/api/runs", spec_data(seed=i + 50)),
        ]

    def listed(self, path: str, kind: str) -> tuple[int, list[dict]]:
        """Return the number of entries of a list, and the entry of the row that is never damaged."""
        entries = self.send("GET", path)[kind]
        whole = [entry for entry in entries if entry["id"] == self.ids[kind][WHOLE]]
        return len(entries), [{**entry, "changes": None} for entry in whole]  # changes: from another run

    def damage(self, table: str, column: str) -> None:
        with self.opened() as connection:
            for (row, *_), (sql, values) in zip(self.rows[table], DAMAGES.values(), strict=False):
                connection.execute(f"UPDATE OR IGNORE {table} SET {column} = {sql} WHERE rowid = ?", (*values, row))

    def mend(self) -> None:
        with self.opened() as connection:
            connection.execute("BEGIN IMMEDIATE")
            for table, rows in self.rows.items():
                names = ", ".join(["rowid", *METADATA.tables[table].columns.keys()])
                marks = ", ".join("?" * len(rows[0]))
                connection.execute(f"DELETE FROM {table}")
                connection.executemany(f"INSERT INTO {table} ({names}) VALUES ({marks})", rows)
            connection.execute("COMMIT")


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Filled]:
    folder = tmp_path_factory.mktemp("damaged")
    with service(folder, memory=1) as address:
        made = Filled(address, folder / "runs.sqlite")
        yield made
        made.connection.close()


@pytest.mark.parametrize(("table", "column"), COLUMNS)
def test_a_damaged_field_hides_no_other_row_and_every_error_says_why(filled: Filled, table: str, column: str):
    """The undamaged row is answered as before. A damaged one is listed unless its key is lost, and can be changed."""
    kind = KINDS.get(table, "runs")
    before = {path: filled.listed(path, kind) for path in LISTS[kind]}
    whole = {path: filled.answer("GET", path) for path in filled.reads(table, WHOLE)}
    try:
        filled.damage(table, column)
        for path, (count, entry) in before.items():
            now, same = filled.listed(path, kind)
            assert same == entry, path
            keys = METADATA.tables[table].primary_key.columns
            if not (column in keys or column == "removed" or any(condition in path for condition in CONDITIONS)):
                assert now == count, path
        for path, answer in whole.items():
            assert filled.answer("GET", path) == answer
        for i, name in enumerate(DAMAGES):
            requests = [("GET", path, None) for path in filled.reads(table, i)] + filled.changes(table, i)
            for method, path, body in requests:
                status, content = filled.answer(method, path, body)
                assert status < 500 or b'"code":"store.' in content, (name, method, path, content[:300])
    finally:
        filled.mend()


def test_a_damaged_name_or_note_is_left_out_with_a_warning(filled: Filled):
    """One letter has changed. The text is not shown as the client's own, and a new one takes its place."""
    run, path = filled.ids["runs"][0], filled.compared(0)
    try:
        with filled.opened() as connection:
            connection.execute("UPDATE run_notes SET name = 'rum 0' WHERE run = ?", (run,))
            connection.execute("UPDATE comparison_notes SET text = 'nose 0' WHERE text = 'note 0'")
        (line,) = (line for line in filled.send("GET", "/api/runs?limit=50")["runs"] if line["id"] == run)
        compared = filled.send("GET", path)
        assert (line["name"], line["tags"], compared["notes"]) == ("", [], "")
        assert "damaged in the store" in line["warning"] and "damaged in the store" in compared["warning"]
        filled.send("PATCH", f"/api/runs/{run}", {"name": "new"})
        filled.send("PUT", path.replace("?", "/notes?"), {"text": "new"})
        compared = filled.send("GET", path)
        assert (compared["runs"][0]["name"], compared["notes"], compared["warning"]) == ("new", "new", "")
        assert not compared["runs"][0].get("warning")
    finally:
        filled.mend()
