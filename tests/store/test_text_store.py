"""Saved plants in the store: versions of a text for each owner, deleted and restored as a whole."""

import pytest

from thetascope.store import Damaged, Database, PlantStore, TextVersion, backup, restore, verify
from thetascope.store.tables import PLANTS
from thetascope.store.text_store import ROW


@pytest.fixture
def database(place):
    opened = Database(place)
    yield opened
    opened.close()


def plant(text: str, owner: str = "ann", id: str = "tank", saved: float = 1.0) -> TextVersion:
    return TextVersion(owner, id, 0, "A tank", "yaml", 2, True, text, saved)


def test_each_change_of_a_text_is_a_version(database):
    """Numbers count from 1, the same text again is no version, and every version can be read."""
    store = PlantStore(database)
    versions = [store.put(plant(text, saved=k)).version for k, text in enumerate(("a", "b", "b", "a"))]
    assert versions == [1, 2, 2, 3]
    assert [v.saved for v in store.versions("ann", "tank")] == [3.0, 1.0, 0.0]
    assert store.get("ann", "tank").text == "a" and store.get("ann", "tank", 2).text == "b"
    assert store.get("ann", "tank", 4) is None and store.usage() == {"ann": 3 * (1 + ROW)}


def test_plants_of_owners_are_apart(database):
    """The same id of two owners is two plants; lists have the last one that was saved first."""
    store = PlantStore(database)
    store.put(plant("a", saved=1))
    store.put(plant("b", owner="bob", saved=2))
    store.put(plant("c", id="motor", saved=3))
    assert [(p.owner, p.id) for p in store.latest()] == [("ann", "motor"), ("bob", "tank"), ("ann", "tank")]
    assert {p.text for p in store.latest()} == {""}, "lists are short, however long the texts are"
    assert store.get("bob", "motor") is None and store.get(None, "motor").text == "c"
    assert store.get("bob", "tank").text == "b"


def test_a_deleted_plant_comes_back_with_all_versions(database):
    """Deleting hides all versions; restoring brings them back, and numbers are never used twice."""
    store = PlantStore(database)
    store.put(plant("a"))
    store.put(plant("b"))
    assert store.remove("ann", "tank") and not store.remove("ann", "tank")
    assert store.get("ann", "tank") is None and store.latest() == [] == store.versions("ann", "tank")
    assert store.put(plant("b")).version == 3
    assert [v.version for v in store.versions("ann", "tank")] == [3]
    assert store.restore("ann", "tank") and not store.restore("ann", "tank")
    assert [v.version for v in store.versions("ann", "tank")] == [3, 2, 1]


def test_deleted_plants_take_room_until_they_are_erased(database):
    """Erasing an owner's deleted plants ends their restoring; others' stay."""
    store = PlantStore(database)
    for owner in ("ann", "bob"):
        store.put(plant("δ", owner=owner))
        store.remove(owner, "tank")
    assert store.usage() == {"ann": 2 + ROW, "bob": 2 + ROW}
    assert store.erase_removed("ann") == 1 and store.usage() == {"bob": 2 + ROW}
    assert not store.restore("ann", "tank") and store.restore("bob", "tank")


def test_a_damaged_version_is_never_returned(database):
    """A text that is not what was written is an error, and verification names plant and version."""
    store = PlantStore(database)
    store.put(plant("a"))
    assert verify(database).defects == ()
    with database.writing() as connection:
        connection.execute(PLANTS.update().values(text="x"))
    with pytest.raises(Damaged, match="version 1 of the saved plant tank"):
        store.get("ann", "tank")
    assert [defect.args for defect in verify(database).defects] == [{"id": "tank", "version": 1}]


def test_a_backup_holds_saved_plants(database, place, tmp_path):
    """A backup that is restored elsewhere has all versions."""
    store = PlantStore(database)
    store.put(plant("a"))
    store.put(plant("b"))
    backup(place, tmp_path / "copy.sqlite")
    restore(tmp_path / "other.sqlite", tmp_path / "copy.sqlite")
    other = Database(tmp_path / "other.sqlite")
    assert PlantStore(other).versions("ann", "tank") == store.versions("ann", "tank")
    other.close()
