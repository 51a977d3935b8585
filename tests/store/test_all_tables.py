"""Every table and column of a store: backup and restoring, and damage to any of them."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tests.store.samples import made_record, made_result
from thetascope.store import (
    Database,
    LessonStore,
    NotebookStore,
    PlantStore,
    RecordStore,
    RunFacts,
    RunQuery,
    RunStore,
    Share,
    TextVersion,
    backup,
    record_id,
    restore,
    verify,
)
from thetascope.store.tables import METADATA

COLUMNS = [(table.name, column.name) for table in METADATA.sorted_tables for column in table.columns]
UNVERIFIED = ("pinned", "removed", "used", "size", "kind", "delay")
"""Columns that are in no checksum, and one that is null in all rows: other types are read as null, too."""
VALUES = ("NULL", "x'fffe'", "CAST(x'ff7bed' AS TEXT)", "'text'", "'[1'", "-1e300", "9e999", "9223372036854775807")
N = len(VALUES)


def fill(database: Database) -> None:
    """Write N + 1 rows into every table: runs, facts, names and tags, notes, owners, results, texts and records."""
    runs, notes = RunStore(database, 10**9), NotebookStore(database)
    plants, lessons, records = PlantStore(database), LessonStore(database), RecordStore(database)
    for i in range(N + 1):
        facts = RunFacts("zhao-2012", "run", 0.1 * i, None, i, "words", {"seed": [float(i)]}, [], {"state": "x"})
        runs.put(made_record(f"run-{i}", created=float(i), facts=facts))
        runs.put_result(f"run-{i}", "e", made_result(rows=20, seed=i))
        runs.own(f"run-{i}", ["ann", "bob"])
        notes.note(f"run-{i}", "ann", f"name {i}", ("all", f"标签 {i}"))
        notes.note_comparison([f"run-{i}", "run-x"], "ann", f"note {i}")
        plants.put(TextVersion("ann", f"plant-{i}", 0, f"Plant {i}", "yaml", 1, True, f"id: plant-{i}\n", float(i)))
        lessons.put(TextVersion("ann", f"lesson-{i}", 0, f"Lesson {i}", "yaml", 1, True, f"id: {i}\n", float(i)))
        data = f"t,y\n0,{i}\n".encode()
        records.put(data, Share(record_id(data), "ann", f"record {i}", "dts200", '{"columns": {}}', float(i)))
    runs.pin("run-1", True)
    plants.remove("ann", "plant-1")


def contents(place: Path | str) -> dict[str, list[tuple]]:
    """Return all rows of all tables as the database returns them."""
    with closing(Database(place)) as database, database.reading() as connection:
        return {
            name: sorted((tuple(row) for row in connection.exec_driver_sql(f"SELECT * FROM {name}")), key=repr)
            for name in METADATA.tables
        }


def test_a_restored_store_has_every_row_of_every_table(place, postgresql, tmp_path):
    """From either kind of store into a file and into PostgreSQL; plants, notes, tags and records included."""
    with closing(Database(place)) as database:
        fill(database)
    before = contents(place)
    assert all(len(rows) > N for rows in before.values())
    file = tmp_path / "backup.sqlite"
    assert backup(place, file).defects == ()
    assert contents(shutil.copy(file, tmp_path / "copy.sqlite")) == before
    for target in (str(tmp_path / "fresh" / "runs.sqlite"), postgresql):
        assert restore(target, file, force=target == place).backup.runs == N + 1
        assert contents(target) == before
        with closing(Database(target)) as database:
            assert verify(database).defects == ()
            assert NotebookStore(database).line("ann", "run-2").tags == ("all", "标签 2")
            assert PlantStore(database).get("ann", "plant-2").text == "id: plant-2\n"
            assert PlantStore(database).restore("ann", "plant-1")


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a closed store whose columns accept NULL, as a flipped bit does not mind a constraint."""
    path = tmp_path_factory.mktemp("filled") / "runs.sqlite"
    with closing(Database(path)) as database:
        fill(database)
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA writable_schema = 1")
        connection.execute("UPDATE sqlite_schema SET sql = replace(sql, ' NOT NULL', '') WHERE type = 'table'")
    return path


def stored(path: Path, table: str) -> set[tuple]:
    """Return the rows of a table of a file, texts as bytes."""
    with closing(sqlite3.connect(path)) as connection:
        connection.text_factory = bytes
        return set(connection.execute(f"SELECT * FROM {table}"))


@pytest.mark.parametrize(("table", "column"), COLUMNS)
def test_a_damaged_column_is_found_and_everything_else_is_restored(filled, tmp_path, table, column):
    """`verify` names each damaged row that has a checksum; a backup of the store can be restored without these rows."""
    path = Path(shutil.copy(filled, tmp_path / "runs.sqlite"))
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        rows = [row for (row,) in connection.execute(f"SELECT rowid FROM {table} ORDER BY rowid")]
        for row, value in zip(rows, VALUES, strict=False):
            connection.execute(f"UPDATE OR IGNORE {table} SET {column} = {value} WHERE rowid = {row}")
        whole = connection.execute(f"SELECT * FROM {table} WHERE rowid = {rows[-1]}").fetchone()
    changed = stored(path, table) - stored(filled, table)
    with closing(Database(path)) as database:
        found = verify(database)
        lists = [NotebookStore(database).page("ann", RunQuery())[0], PlantStore(database).latest()]
        lists.append(RecordStore(database).page(None, 100))
    assert all(found.text("en") for found in found.defects)
    if table != "records" and column not in UNVERIFIED:
        assert len(found.defects) >= len(changed), (changed, found.defects)
    assert sum(map(len, lists)) >= 2 * (N + 1)  # at least two of the lists are whole
    backup(path, tmp_path / "backup.sqlite")
    fresh = tmp_path / "fresh" / "runs.sqlite"
    restore(fresh, tmp_path / "backup.sqlite", force=True)
    after = contents(fresh)
    assert whole in after[table]
    for other, rows in contents(filled).items():
        assert other == table or after[other] == rows, other


@pytest.mark.parametrize("value", ["0", "-1e300", "9e999", "'text'", "x'00'", "1"])
def test_no_damaged_time_of_removal_erases_a_row(filled, tmp_path, value):
    """A run, its notes and a plant that nobody removed are there after the next start."""
    path = Path(shutil.copy(filled, tmp_path / "runs.sqlite"))
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for table, key in (("runs", "id"), ("run_notes", "run")):
            connection.execute(f"UPDATE {table} SET removed = {value} WHERE {key} = 'run-2'")
        connection.execute(f"UPDATE plants SET removed = {value} WHERE id = 'plant-2'")
    with closing(Database(path)) as database:
        notes, plants = NotebookStore(database), PlantStore(database)
        plants.put(TextVersion("ann", "other", 0, "Other", "yaml", 0, True, "id: other\n", 1.0))
        assert notes.erase(2e9) == 0
        assert notes.line("ann", "run-2").name == "name 2"
        assert plants.get("ann", "plant-2").text == "id: plant-2\n"
