"""What clients save, plants and lessons alike: numbers, room, owners and damage."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from thetascope.access.principal import Principal
from thetascope.runs.lessons.my_lessons import MyLessons
from thetascope.runs.plants.my_plants import MyPlants
from thetascope.runs.saved_texts import NoRoomForTexts, SavedTexts
from thetascope.runs.specs.refusals import NotOwner, Unknown
from thetascope.store import Damaged, Database, LessonStore, PlantStore, TextVersion
from thetascope.store.text_store import ROW

ANN, BOB = Principal("ann", "ann"), Principal("bob", "bob")
KINDS = {"plant": (MyPlants, PlantStore), "lesson": (MyLessons, LessonStore)}


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """Yield an empty store."""
    opened = Database(tmp_path / "runs.sqlite")
    yield opened
    opened.close()


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    """Return plant, then lesson."""
    return request.param


def texts_of(kind: str, database: Database, limit: int = 10**6) -> SavedTexts:
    """Return the saved plants or lessons of a store."""
    texts, store = KINDS[kind]
    return texts(store(database), limit)


def version(by: Principal, text: str, saved: float, id: str = "tank") -> TextVersion:
    return TextVersion(by.owner, id, 0, "{}", "yaml", 1, True, text, saved)


def test_the_latest_of_all_has_the_highest_number(kind, database):
    """What another client saves under an id follows the number of the first; each finds its own first."""
    texts = texts_of(kind, database)
    texts.put(version(ANN, "a", 1.0), ANN)
    texts.put(version(ANN, "b", 2.0), ANN)
    assert texts.put(version(BOB, "c", 3.0), BOB)[0].version == 3
    assert texts.get("tank", None, ANN).text == "b" and texts.get("tank", None, BOB).text == "c"
    with pytest.raises(NotOwner, match=kind):
        texts_of(kind, database).remove("tank", Principal("eve", "eve"))
    with pytest.raises(Unknown, match=f"saved {kind} tank has no version 9"):
        texts.get("tank", 9, ANN)


def test_what_was_deleted_makes_room(kind, database):
    """A client may fill a quarter; deleted texts count until they are in the way."""
    texts = texts_of(kind, database, limit=4 * (2 * ROW + 200))
    texts.put(version(ANN, "a" * 50, 1.0, "one"), ANN)
    texts.put(version(ANN, "a" * 50, 2.0, "two"), ANN)
    with pytest.raises(NoRoomForTexts):
        texts.put(version(ANN, "a" * 50, 3.0, "three"), ANN)
    texts.remove("one", ANN)
    texts.put(version(ANN, "a" * 50, 4.0, "three"), ANN)
    assert [one.id for one in texts.latest(ANN)] == ["three", "two"]


def test_a_whole_version_is_saved_over_a_damaged_one(kind, database):
    """The error names the kind; to save again, or to delete, is not hindered by the damage."""
    texts = texts_of(kind, database)
    texts.put(version(ANN, "a", 1.0), ANN)
    with database.writing() as connection:
        connection.execute(texts._store.table.update().values(text="x"))
    with pytest.raises(Damaged, match=f"saved {kind} tank"):
        texts.get("tank", None, ANN)
    assert texts.put(version(ANN, "b", 2.0), ANN)[0].version == 2
    assert texts.get("tank", None, ANN).text == "b"
    texts.remove("tank", ANN)
    assert texts.latest(ANN) == []
