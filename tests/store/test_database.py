"""Opening the store's file: new, older, newer, damaged, locked."""

import sqlite3

import pytest

from tests.store.samples import made_record
from thetascope.store import Database, StoreError, migrations


def test_an_older_file_is_migrated_and_keeps_its_runs(open_store, monkeypatch):
    """Each migration is applied once."""
    open_store().put(made_record("a"))
    later = (*migrations.MIGRATIONS, ("ALTER TABLE runs ADD COLUMN note TEXT DEFAULT 'none'",))
    monkeypatch.setattr("thetascope.store.database.MIGRATIONS", later)
    for _ in range(2):
        store = open_store()
        with store._database.reading() as connection:
            assert connection.exec_driver_sql("SELECT note FROM runs WHERE id = 'a'").scalar_one() == "none"


def test_a_newer_file_is_refused_and_unchanged(tmp_path):
    """An old program must not damage a newer store."""
    path = tmp_path / "runs.sqlite"
    Database(path).close()
    with sqlite3.connect(path) as connection:
        connection.execute("PRAGMA user_version = 999")
    with pytest.raises(StoreError, match=r"newer version.*THETASCOPE_DATA"):
        Database(path)
    with sqlite3.connect(path) as connection:
        assert connection.execute("PRAGMA user_version").fetchone()[0] == 999


def test_a_file_that_is_not_a_database_is_refused_with_the_remedy(tmp_path):
    """It is not overwritten."""
    path = tmp_path / "runs.sqlite"
    path.write_bytes(b"this is no database, but it is somebody's file " * 50)
    with pytest.raises(StoreError, match=r"runs\.sqlite is damaged or not a database.*move the file away"):
        Database(path)
    assert path.read_bytes().startswith(b"this is no database")


def test_a_damaged_page_is_reported_when_it_is_read(tmp_path):
    """Not every damage is visible on opening."""
    path = tmp_path / "runs.sqlite"
    database = Database(path)
    with database.writing() as connection:
        for i in range(200):
            connection.exec_driver_sql(
                "INSERT INTO runs VALUES (?, ?, 't', 'done', NULL, NULL, 'e', 1, 0, NULL, NULL, NULL)",
                (f"{i}", "x" * 900),
            )
    database.close()
    content = bytearray(path.read_bytes())
    content[8192 * 2 :] = b"\xff" * (len(content) - 8192 * 2)
    path.write_bytes(content)
    database = Database(path)
    with pytest.raises(StoreError, match="damaged"), database.reading() as connection:
        connection.exec_driver_sql("SELECT * FROM runs").fetchall()
    database.close()


@pytest.mark.parametrize("place", ["sqlite"], indirect=True)
def test_a_locked_store_is_refused_after_a_wait(open_store, tmp_path):
    """The message says which program to close."""
    store = open_store(timeout=0.05)
    other = sqlite3.connect(tmp_path / "data" / "runs.sqlite", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(StoreError, match="held by another process"):
        store.put(made_record("a"))
    other.execute("ROLLBACK")
    store.put(made_record("a"))
    other.close()
    assert store.get("a") is not None


def test_a_folder_that_cannot_be_created_is_refused_with_the_setting(tmp_path):
    """A common error in containers."""
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StoreError, match="THETASCOPE_DATA"):
        Database(tmp_path / "file" / "runs.sqlite")


def test_a_failed_transaction_changes_nothing(open_store):
    """A partial deletion would leave results without runs."""
    store = open_store()
    store.put(made_record("a"))
    with pytest.raises(RuntimeError), store._database.writing() as connection:
        connection.exec_driver_sql("DELETE FROM runs")
        raise RuntimeError
    assert store.get("a") is not None
