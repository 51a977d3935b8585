"""Stores that released versions wrote. `released/schema-1.sqlite` was written by the service when the schema had
version 1: a pinned run with its result, a cancelled run, and one that a kill -9 of the service cut off. The CSV is the
answer of that service to /api/runs/{id}/data. `schema-2.sqlite` was written by the command line: a pinned run with two
owners, and the CSV that `thetascope run --out` wrote. `schema-3.sqlite` has such a run, too,
and a record of two owners. `schema-4.sqlite` is that store, opened by the next version, which saved a plant twice."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from thetascope.export import csv_chunks, select
from thetascope.runs.jobs.store_rows import snapshot_of
from thetascope.runs.results.run_facts import facts_of_run
from thetascope.store import (
    Database,
    NotebookStore,
    PlantStore,
    RecordStore,
    RunQuery,
    RunStore,
    StoreError,
    record_id,
)

RELEASED = Path(__file__).parent / "released"
DONE, CANCELLED, QUEUED = (
    "e3e26c02e2c4a9915a2907173aa306db",
    "2ab923d24f1f3b873a69e19992f5e21e",
    "9b2e67eb63ef710837019ce72a8ddde7",
)
ENGINE = "b079398157ae2a57"


SECOND, SECOND_ENGINE = "05f45b405b189d91bdd48a73a8214d70", "924a0d9d16f6572c"
THIRD_ENGINE = "94f7a39ccc2c6b44"
RECORD = b"t,q,y\n0,50,20\n1,50,20.1\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return a copy of the store of schema 1."""
    return Path(shutil.copy(RELEASED / "schema-1.sqlite", tmp_path / "runs.sqlite"))


def test_a_store_of_schema_1_opens_with_all_its_runs_and_numbers(path):
    """The result is the CSV that the service of that time answered; specs, summary, pin and states are kept."""
    database = Database(path)
    store = RunStore(database, 10**9)
    assert [(run.id, run.status, run.damaged, run.pinned) for run in store.page()] == [
        (QUEUED, "queued", False, False),
        (CANCELLED, "cancelled", False, False),
        (DONE, "done", False, True),
    ]
    result = store.get_result(DONE, ENGINE)
    assert b"".join(csv_chunks(select(result))) == (RELEASED / "schema-1.csv").read_bytes()
    snapshot = snapshot_of(store.get(DONE))
    assert snapshot.summary.rows == 41 and snapshot.spec.horizon == 2
    assert snapshot.spec.title is not None
    (unfinished,) = store.unfinished()
    assert unfinished.id == QUEUED and snapshot_of(unfinished).spec.horizon > 0
    database.close()


def test_a_store_of_schema_2_keeps_runs_owners_and_numbers(tmp_path):
    """Its pinned run has its owners and the CSV of that time; tables of records are there, and empty."""
    database = Database(Path(shutil.copy(RELEASED / "schema-2.sqlite", tmp_path / "runs.sqlite")))
    store = RunStore(database, 10**9)
    (run,) = store.page()
    assert (run.id, run.status, run.pinned, run.damaged) == (SECOND, "done", True, False)
    assert store.owners(SECOND) == {"browser-1", "machine"}
    result = store.get_result(SECOND, SECOND_ENGINE)
    assert b"".join(csv_chunks(select(result))) == (RELEASED / "schema-2.csv").read_bytes()
    assert RecordStore(database).page(None, 10) == [] and RecordStore(database).usage() == 0
    database.close()


def test_a_store_of_schema_3_keeps_runs_and_records(tmp_path):
    """Its run has the CSV of that time, its record both shares; the table of plants is there, and empty."""
    database = Database(Path(shutil.copy(RELEASED / "schema-3.sqlite", tmp_path / "runs.sqlite")))
    store, records = RunStore(database, 10**9), RecordStore(database)
    assert store.owners(SECOND) == {"browser-1", "machine"}
    result = store.get_result(SECOND, THIRD_ENGINE)
    assert b"".join(csv_chunks(select(result))) == (RELEASED / "schema-3.csv").read_bytes()
    assert records.data(record_id(RECORD)) == RECORD
    shares = [(share.owner, share.name, share.plant) for share in records.shares(record_id(RECORD))]
    assert shares == [("machine", "other.csv", None), ("browser-1", "tank.csv", '"dts200"')]
    assert PlantStore(database).latest() == []
    database.close()


def test_a_store_of_schema_4_keeps_runs_records_and_plants(tmp_path):
    """Its run is in the list of runs, with the facts that the notebook writes for it, and nothing is removed."""
    database = Database(Path(shutil.copy(RELEASED / "schema-4.sqlite", tmp_path / "runs.sqlite")))
    store, notebook = RunStore(database, 10**9), NotebookStore(database)
    result = store.get_result(SECOND, THIRD_ENGINE)
    assert b"".join(csv_chunks(select(result))) == (RELEASED / "schema-3.csv").read_bytes()
    assert RecordStore(database).data(record_id(RECORD)) == RECORD
    assert PlantStore(database).get("machine", "tank", 1).text == "id: tank\ntitle: A tank\n"
    (line,), counts = notebook.page("machine", RunQuery())
    assert (line.record.id, line.facts, line.owners) == (SECOND, None, {"browser-1", "machine"})
    assert (counts.all, counts.pinned) == (1, 1) and notebook.without_facts() == [SECOND]
    snapshot = snapshot_of(store.get(SECOND))
    notebook.put_facts({SECOND: facts_of_run(snapshot.spec, snapshot.summary)})
    assert notebook.line("machine", SECOND).facts.shown["plant"] == snapshot.spec.plant_id
    database.close()


def test_an_upgraded_store_has_the_schema_of_a_new_one(path, tmp_path):
    """Columns and indexes are equal, so that later versions need to know one schema only."""
    schemas = []
    later = [Path(shutil.copy(RELEASED / f"schema-{n}.sqlite", tmp_path / f"{n}.sqlite")) for n in (2, 3, 4)]
    for place in (path, *later, tmp_path / "new.sqlite"):
        database = Database(place)
        with database.reading() as connection:
            query = "SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY name"
            schemas.append([tuple(row) for row in connection.exec_driver_sql(query)])
        database.close()
    assert all(schema == schemas[0] for schema in schemas) and len(schemas[0]) > 5


def test_a_damaged_file_of_schema_1_is_refused_and_unchanged(path):
    """An upgrade in one transaction: nothing of it remains if the file cannot be read."""
    content = bytearray(path.read_bytes())
    page = content.index(QUEUED.encode() + b"{") // 8192 * 8192
    content[page : page + 8] = b"\xff" * 8
    path.write_bytes(content)
    with pytest.raises(StoreError, match="is damaged"):
        Database(path)
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone()[0] == 1
        assert connection.execute("SELECT count(*) FROM sqlite_master WHERE name = 'owners'").fetchone()[0] == 0
