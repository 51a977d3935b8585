"""Uploaded records in the store: one file for several owners, removed with the last of them."""

import pytest

from thetascope.store import Damaged, Database, RecordStore, Share, StoreError, backup, record_id, restore, verify
from thetascope.store.tables import RECORDS

CSV = b"t,q,y\n0,50,20\n1,50,20.1\n"


@pytest.fixture
def database(place):
    opened = Database(place)
    yield opened
    opened.close()


def share(owner: str, changed: float = 1.0, **more: str | None) -> Share:
    return Share(record_id(CSV), owner, more.get("name", "a.csv"), more.get("plant"), more.get("mapping"), changed)


def test_a_file_is_stored_once_with_a_share_for_each_owner(database):
    """The bytes come back, the latest share comes first, and the file goes with the last share."""
    store, id = RecordStore(database), record_id(CSV)
    store.put(CSV, share("ann"))
    used = store.usage()
    store.put(CSV, share("bob", 2.0, name="b.csv", plant='"dts200"'))
    assert store.data(id) == CSV and store.usage() == used == store.usage("ann") and store.usage("eve") == 0
    assert [(s.owner, s.name, s.plant) for s in store.shares(id)] == [
        ("bob", "b.csv", '"dts200"'),
        ("ann", "a.csv", None),
    ]
    assert (
        [(line.id, line.size) for line in store.page(("ann",), 5)]
        == [(id, len(CSV))]
        == [(line.id, line.size) for line in store.page(None, 5)]
    )
    assert store.page(("eve",), 5) == []
    assert not store.delete_share(id, "bob") and store.data(id) == CSV
    assert store.delete_share(id, "ann") and store.data(id) is None and store.shares(id) == []


def test_a_share_that_changes_replaces_the_earlier_one(database):
    """An owner has one plant and one mapping for a record."""
    store = RecordStore(database)
    store.put(CSV, share("ann"))
    store.put_share(share("ann", 3.0, mapping="{}"))
    assert [(s.mapping, s.changed) for s in store.shares(record_id(CSV))] == [("{}", 3.0)]


@pytest.mark.parametrize("spoilt", [b"", b"x", bytes(40)])
def test_a_damaged_file_is_never_returned(database, spoilt):
    """Bytes that do not have the hash are an error, and verification names the record."""
    store = RecordStore(database)
    store.put(CSV, share("ann"))
    assert verify(database).defects == ()
    with database.writing() as connection:
        connection.execute(RECORDS.update().values(data=spoilt))
    with pytest.raises(Damaged, match=record_id(CSV)):
        store.data(record_id(CSV))
    (defect,) = verify(database).defects
    assert defect.args == {"id": record_id(CSV)}


def test_a_backup_holds_uploaded_records(place, tmp_path):
    """Files and shares come back from the backup of a store, whatever database it is in."""
    database = Database(place)
    RecordStore(database).put(CSV, share("ann", plant='"dts200"'))
    database.close()
    backup(place, tmp_path / "backup.sqlite")
    restore(tmp_path / "other.sqlite", tmp_path / "backup.sqlite")
    restored = Database(tmp_path / "other.sqlite")
    store = RecordStore(restored)
    assert store.data(record_id(CSV)) == CSV and store.shares(record_id(CSV)) == [share("ann", plant='"dts200"')]
    restored.close()


def test_a_store_for_reading_takes_no_record(place):
    """A service that shares the store of another one refuses uploads."""
    Database(place).close()
    database = Database(place, read_only=True)
    with pytest.raises(StoreError):
        RecordStore(database).put(CSV, share("ann"))
    database.close()
