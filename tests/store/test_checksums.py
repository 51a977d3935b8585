"""What is stored is what was computed: flipped bits in rows and in the file are found when they are read."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.store.samples import made_record, made_result
from thetascope.store import Damaged, Database, RunStore, StoreError

#: Columns of a run and of a result whose change must be found, with SQL for another value of the same type.
TEXTS = "replace({0}, substr({0}, 1, 1), '~')"
RUN = {
    "spec": "spec",
    "title": "spec",
    "created": "spec",
    "summary": "outcome",
    "engine": "outcome",
    "status": "outcome",
}
RESULT = ("head", "rows", "data", "checksum")


def change(store: RunStore, table: str, column: str, id: str, sql: str) -> None:
    with store._database.writing() as connection:
        connection.exec_driver_sql(f"UPDATE {table} SET {column} = {sql} WHERE id = '{id}'")


@pytest.mark.parametrize("column", RUN)
def test_a_changed_run_is_listed_as_damaged_and_hides_no_other(open_store, column):
    """Its spec is not returned if it was hit, its outcome never; the other runs are as before."""
    store = open_store()
    for id in ("before", "hit", "after"):
        store.put(made_record(id))
    change(store, "runs", column, "hit", "created + 0.5" if column == "created" else TEXTS.format(column))
    assert {run.id: run.damaged for run in store.page()} == {"before": False, "hit": True, "after": False}
    if RUN[column] == "spec":
        with pytest.raises(Damaged, match=r"run hit is damaged.*run the experiment again"):
            store.get("hit")
    else:
        record = store.get("hit")
        assert record.damaged and record.summary is None and record.spec == '{"seed": 1}'
    assert store.get("after").summary == {"rows": 50}
    store.put(made_record("hit"))
    assert not any(run.damaged for run in store.page())
    assert store.delete("hit")


@pytest.mark.parametrize("column", RESULT)
def test_a_changed_result_is_an_error_that_names_the_run_and_is_then_absent(open_store, column):
    """It is removed, so that the run is computed again."""
    store = open_store()
    for id in ("hit", "other"):
        store.put(made_record(id))
        store.put_result(id, "e", made_result())
    if column == "rows":
        change(store, "results", column, "hit", "rows + 1")
    elif column != "data":
        change(store, "results", column, "hit", TEXTS.format(column))
    else:
        flip(store, "hit", 777)
    with pytest.raises(Damaged, match="result of run hit is damaged.*computed again"):
        store.get_result("hit", "e")
    assert not store.has_result("hit", "e") and store.get_result("hit", "e") is None
    assert store.get_result("other", "e") is not None
    store.put_result("hit", "e", made_result())
    assert store.get_result("hit", "e") is not None


def flip(store: RunStore, id: str, bit: int) -> None:
    """Flip one bit of the numbers of a result."""
    with store._database.writing() as connection:
        query = f"SELECT data FROM results WHERE id = '{id}'"
        data = bytearray(connection.exec_driver_sql(query).scalar_one())
        data[bit // 8 % len(data)] ^= 1 << bit % 8
        mark = "?" if connection.dialect.name == "sqlite" else "%s"
        connection.exec_driver_sql(f"UPDATE results SET data = {mark} WHERE id = '{id}'", (bytes(data),))


def test_every_flipped_bit_of_the_numbers_is_found(open_store):
    """At random places, in both kinds of stores."""
    store = open_store()
    for bit in np.random.default_rng(1).integers(0, made_result().data.nbytes * 8, 25):
        store.put_result("a", "e", made_result())
        flip(store, "a", int(bit))
        with pytest.raises(Damaged):
            store.get_result("a", "e")


def test_rows_with_values_of_other_kinds_hide_no_other(tmp_path):
    """A flipped bit in SQLite's record header changes the type of a column, or the end of a text in UTF-8."""
    database = Database(tmp_path / "runs.sqlite")
    store = RunStore(database, 10**9)
    strange = ["1e300", "'soon'", "NULL", "x'ff00'", "-5", "9e999", "x'4142'"]
    for i, value in enumerate(strange):
        store.put(made_record(f"r{i}"))
        with database.writing() as connection:
            connection.exec_driver_sql("PRAGMA ignore_check_constraints = 1")
            if value != "NULL":
                connection.exec_driver_sql(f"UPDATE runs SET created = {value} WHERE id = 'r{i}'")
            connection.exec_driver_sql(f"UPDATE runs SET title = CAST(x'ff41' AS TEXT) WHERE id = 'r{i}'")
    store.put(made_record("good"))
    listed = store.page()
    assert len(listed) == len(strange) + 1 and [run.id for run in listed if not run.damaged] == ["good"]
    for run in listed:
        assert 0 <= run.created < 253402300800
        run.title.encode()
    database.close()


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the file of a closed store with 30 runs and results."""
    path = tmp_path_factory.mktemp("filled") / "runs.sqlite"
    database = Database(path)
    store = RunStore(database, 10**9)
    for i in range(30):
        store.put(made_record(f"run-{i:02}", created=float(i), spec=f"{i} {'y' * 3000}"))
        store.put_result(f"run-{i:02}", "e", made_result(rows=400, seed=i))
    database.close()
    return path


@pytest.mark.parametrize("attack", [*range(24), "truncated", "cut"])
def test_no_damage_to_the_file_changes_an_answer(filled, tmp_path, attack):
    """Flipped bits at random places of the file and truncation: every answer is right, or an error of the store."""
    path = Path(shutil.copy(filled, tmp_path / "runs.sqlite"))
    content = bytearray(path.read_bytes())
    if attack == "truncated":
        content = content[: len(content) * 3 // 4]
    elif attack == "cut":
        content = content[: len(content) // 2 - 1000]
    else:
        for bit in np.random.default_rng(attack).integers(0, len(content) * 8, 1 + attack % 4 * 20):
            content[bit // 8] ^= 1 << bit % 8
    path.write_bytes(content)
    answers = errors = 0
    try:
        database = Database(path, timeout=0.2)
    except StoreError:
        return
    store = RunStore(database, 10**9)
    for i in range(30):
        try:
            record = store.get(f"run-{i:02}")
            if record is not None and not record.damaged:
                assert record.summary == {"rows": 50} and record.spec == f"{i} {'y' * 3000}"
                answers += 1
        except StoreError:
            errors += 1
        try:
            result = store.get_result(f"run-{i:02}", "e")
            if result is not None:
                assert result.data.tobytes() == made_result(rows=400, seed=i).data.tobytes()
                answers += 1
        except StoreError:
            errors += 1
    listed = store.page()
    assert {run.id for run in listed if not run.damaged} <= {f"run-{i:02}" for i in range(30)}
    assert len(listed) >= 30 or attack in ("truncated", "cut")
    store.usage()
    assert answers + errors > 0
    database.close()
