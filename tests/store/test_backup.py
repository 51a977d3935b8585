"""Backup, restore and verification of stores of both kinds, also while they are used."""

import shutil
import sqlite3
import stat
import threading
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from tests.store.samples import made_record, made_result
from tests.store.test_released_stores import CANCELLED, DONE, ENGINE, QUEUED, RELEASED
from thetascope.store import Database, RunStore, StoreError, backup, opened, restore, verify
from thetascope.store.notebook.owners import add_owners


def fill(store: RunStore, count: int = 5) -> None:
    for i in range(count):
        store.put(made_record(f"r{i}", created=float(i)))
        store.put_result(f"r{i}", "e", made_result(seed=i))
    store.pin("r1", True)
    with store._database.writing() as connection:
        add_owners(connection, "r1", ["ann", "bob"])


def contents(place: Path | str) -> dict[str, list[tuple]]:
    """Return all rows of a store but the times of last use."""
    with closing(Database(place)) as database, database.reading() as connection:
        tables = {"runs": "*", "owners": "*", "results": "id, engine, size, rows, head, data, checksum"}
        return {
            name: sorted(tuple(row) for row in connection.exec_driver_sql(f"SELECT {columns} FROM {name}"))
            for name, columns in tables.items()
        }


def damage(place: str, id: str = "r2") -> None:
    with closing(Database(place)) as database, database.writing() as connection:
        connection.exec_driver_sql(f"UPDATE results SET head = 'x' || head WHERE id = '{id}'")
        connection.exec_driver_sql(f"UPDATE runs SET summary = 'x' || summary WHERE id = '{id}'")
        connection.exec_driver_sql("UPDATE runs SET spec = 'x' || spec WHERE id = 'r3'")


def test_a_store_is_restored_from_its_backup_in_every_row(place, open_store, tmp_path):
    """From either kind of store; runs, results bit for bit, pins and owners."""
    fill(open_store())
    file = tmp_path / "backup.sqlite"
    found = backup(place, file)
    assert (found.runs, found.results, found.defects) == (5, 5, ())
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert sorted(p.name for p in tmp_path.iterdir() if p.name.startswith("backup")) == ["backup.sqlite"]
    with closing(sqlite3.connect(file)) as connection:
        assert connection.execute("PRAGMA journal_mode").fetchone()[0] == "delete"
    before = contents(place)
    assert contents(shutil.copy(file, tmp_path / "copy.sqlite")) == before
    store = open_store()
    store.delete("r0")
    store.put(made_record("later"))
    restore(place, file, force=True)
    assert contents(place) == before


def test_a_backup_moves_a_store_to_the_other_kind(tmp_path, postgresql):
    """From SQLite to PostgreSQL and back nothing is changed."""
    first, last = tmp_path / "first.sqlite", tmp_path / "last.sqlite"
    with closing(Database(first)) as database:
        fill(RunStore(database, 10**9))
    backup(first, tmp_path / "one")
    restore(postgresql, tmp_path / "one")
    backup(postgresql, tmp_path / "two")
    restore(last, tmp_path / "two")
    assert contents(last) == contents(postgresql) == contents(first)


def test_a_used_store_is_replaced_by_force_only_and_its_file_is_kept(open_store, tmp_path, place):
    """The remedy names both steps."""
    fill(open_store())
    file = tmp_path / "backup.sqlite"
    backup(place, file)
    before = contents(place)
    with pytest.raises(StoreError, match="has runs; make a backup of it first.*--force"):
        restore(place, file)
    assert contents(place) == before
    kept = restore(place, file, force=True).kept
    if "://" not in place:
        assert kept is not None and contents(kept) == before


def test_a_store_that_a_server_owns_is_not_replaced(open_store, tmp_path, place):
    """Its owner would go on with a file that is no longer there."""
    owner = open_store()
    owner._database.own()
    fill(owner)
    backup(place, tmp_path / "backup")
    with pytest.raises(StoreError, match="belongs to a running server"):
        restore(place, tmp_path / "backup", force=True)
    assert owner.usage()["runs"] == 5


def test_a_file_that_exists_is_overwritten_by_force_only(open_store, tmp_path, place):
    """It may be another backup."""
    fill(open_store())
    file = tmp_path / "backup"
    file.write_text("precious")
    with pytest.raises(StoreError, match="exists.*--force"):
        backup(place, file)
    assert file.read_text() == "precious"
    assert backup(place, file, force=True).runs == 5


def test_verification_lists_every_damaged_row(open_store, place):
    """Names of runs and which part is damaged; nothing is changed by it."""
    fill(open_store())
    with closing(Database(place, read_only=True)) as database:
        assert verify(database).defects == ()
    damage(place)
    before = contents(place)
    with closing(Database(place, read_only=True)) as database:
        found = verify(database)
    assert sorted((defect.code, defect.args["id"]) for defect in found.defects) == [
        ("store.defect.outcome", "r2"),
        ("store.defect.result", "r2"),
        ("store.defect.spec", "r3"),
    ]
    assert (found.runs, found.results) == (5, 5) and contents(place) == before


def test_a_damaged_backup_is_restored_by_force_without_the_damaged_rows(open_store, tmp_path, place):
    """The others are all there."""
    fill(open_store())
    damage(place)
    file, target = tmp_path / "backup", tmp_path / "target.sqlite"
    assert len(backup(place, file).defects) == 3
    with pytest.raises(StoreError, match="damaged in 3 places"):
        restore(target, file)
    assert not target.exists()
    restore(target, file, force=True)
    kept = contents(target)
    assert [row[0] for row in kept["runs"]] == ["r0", "r1", "r4"]
    assert [row[0] for row in kept["results"]] == ["r0", "r1", "r3", "r4"]


@pytest.mark.parametrize("attack", ["flipped", "truncated", "text", "absent"])
def test_a_backup_that_cannot_be_trusted_replaces_nothing(tmp_path, attack):
    """Damage of the file itself is found, too."""
    source, target, file = tmp_path / "a.sqlite", tmp_path / "b.sqlite", tmp_path / "backup"
    with closing(Database(source)) as database:
        fill(RunStore(database, 10**9))
    backup(source, file)
    content = bytearray(file.read_bytes())
    if attack == "flipped":
        data = made_result(seed=2).data.tobytes()
        content[content.index(data[:64]) + 5] ^= 4
        file.write_bytes(content)
    elif attack == "truncated":
        file.write_bytes(content[: len(content) * 2 // 3])
    elif attack == "text":
        file.write_bytes(b"not a store" * 1000)
    else:
        file.unlink()
    shutil.copy(source, target)
    before = target.read_bytes()
    with pytest.raises(StoreError):
        restore(target, file)
    assert target.read_bytes() == before


def test_a_backup_of_an_earlier_version_is_restored(tmp_path):
    """The file itself stays as it is."""
    file = RELEASED / "schema-1.sqlite"
    before = file.read_bytes()
    with opened(file) as database:
        assert verify(database).defects == ()
    assert restore(tmp_path / "runs.sqlite", file).backup.runs == 3
    with closing(Database(tmp_path / "runs.sqlite")) as database:
        store = RunStore(database, 10**9)
        assert {run.id for run in store.page()} == {DONE, CANCELLED, QUEUED}
        assert store.get_result(DONE, ENGINE) is not None
    assert file.read_bytes() == before


def test_backups_during_writes_are_whole(open_store, tmp_path, place):
    """Each is the store at one moment: without defects, and with every run that was written before it began."""
    store = open_store()
    fill(store, 3)
    ended = threading.Event()
    written = [3]

    def write() -> None:
        while not ended.is_set() and written[0] < 400:
            i = written[0]
            store.put(made_record(f"w{i:03}"))
            store.put_result(f"w{i:03}", "e", made_result(seed=i))
            written[0] += 1

    writer = threading.Thread(target=write)
    writer.start()
    try:
        for i in range(4):
            least = written[0]
            found = backup(place, tmp_path / f"backup-{i}")
            assert found.defects == () and found.runs >= least and abs(found.runs - found.results) <= 1
    finally:
        ended.set()
        writer.join()


@pytest.fixture
def call(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, place: str) -> Callable[..., tuple]:
    """Call the command line with the store of the test."""
    from thetascope.cli.main import main

    monkeypatch.setenv("THETASCOPE_DATABASE", place)
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)

    def call_one(*arguments: str) -> tuple[int, str, str]:
        code = main(arguments)
        shown = capsys.readouterr()
        return code, shown.out, shown.err

    return call_one


def test_the_commands_say_what_they_found(call, open_store, tmp_path, place):
    """Exit code 1 with damage or a refusal, and each defect on a line."""
    fill(open_store())
    file = str(tmp_path / "backup")
    assert call("verify")[:2] == (0, f"read {Database(place).place} (runs: 5, results: 5)\n")
    assert call("backup", file)[0] == 0
    assert call("verify", file)[:2] == (0, f"read {file} (runs: 5, results: 5)\n")
    code, _, error = call("restore", file)
    assert code == 1 and "has runs" in error
    damage(place)
    code, _, error = call("verify")
    assert code == 1 and error.count("\n") == 4 and "run r2: its result is damaged" in error
    code, shown, _ = call("restore", file, "--force")
    assert code == 0 and "(runs: 5, results: 5)" in shown
    assert call("verify")[0] == 0
    assert np.array_equal(open_store().get_result("r2", "e").data, made_result(seed=2).data, equal_nan=True)
