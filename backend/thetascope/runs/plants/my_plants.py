"""The plants that clients have saved: versions of a text, under the id that the text gives.

Everybody who may use the service may read them, as runs, so that a plant is found again from another browser; only its
owner deletes it, and what others save under its id is their own. Where a request names a plant, `two-tanks` means the
latest version of the sender's plant, else of anybody's; `two-tanks@7` means its version 7. Ids of the library are
refused.
"""

import re
import time
from collections import Counter
from threading import Lock
from typing import Any

from thetascope import library
from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.plants.text_check import TextFacts, format_of
from thetascope.runs.specs.refusals import NotOwner, Refusal, Unknown, invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, parse
from thetascope.store import PlantStore, PlantVersion
from thetascope.store.plant_store import ROW
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.texts.local_text import ALL
from thetascope_schemas.texts.refusal import suggestion

ID = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")
_REFERENCE = re.compile(r"(?P<id>[a-z0-9][a-z0-9-]{0,63})(?:@(?P<version>[0-9]{1,9}))?")
_OF_ONE = 4  # the part of the room that one client may fill, unless it is the machine's owner


class NoRoomForPlants(Refusal):
    """There is no room for another version."""


class MyPlants:
    """Stores, finds and deletes the plants of clients. `limit`: bytes of all versions of all plants together."""

    def __init__(self, store: PlantStore, limit: int) -> None:
        self._store, self._limit = store, limit
        self._saving = Lock()
        self._used: Counter[str] | None = None  # bytes of each owner: counting them reads all texts

    def save(self, id: str, text: str, facts: TextFacts, ready: bool, by: Principal) -> tuple[PlantVersion, bool]:
        """Store a text as the next version of a plant; return the latest version, and whether it is a new one.

        Args:
            id: the plant's id.
            text, facts: the text and its facts.
            ready: whether it has no errors.
            by: the client that saves it.

        Raises InvalidSpec for an id of the library or another one than the text has, NoRoomForPlants, StoreError.
        """
        check_id(id)
        if ID.fullmatch(facts.id) and facts.id != id:
            raise invalid("id", facts.id, Message("workshop.other-id", id=id, written=facts.id))
        moment, is_ready, size = time.time(), ready and facts.is_plant, len(text.encode()) + ROW
        with self._saving:
            before = self._store.get(None, id)
            number = 0 if before is None else before.version if before.owner != by.owner else 0
            used = self._make_room(size, by)
            stored = self._store.put(
                PlantVersion(by.owner, id, number, facts.title, format_of(text), facts.faults, is_ready, text, moment)
            )
            is_new = stored.saved == moment
            used[by.owner] += size * is_new
        return stored, is_new

    def _make_room(self, size: int, by: Principal) -> Counter[str]:
        """Return the bytes of each owner. Where there is no room, the client's deleted plants are erased for good.

        Raises NoRoomForPlants.
        """
        most = self._limit if by.is_machine else self._limit // _OF_ONE
        if self._used is not None and self._has_room(self._used, size, most, by):
            return self._used
        self._used = Counter(self._store.usage())
        if not self._has_room(self._used, size, most, by) and self._store.erase_removed(by.owner):
            self._used = Counter(self._store.usage())
        if not self._has_room(self._used, size, most, by):
            raise NoRoomForPlants(Message("workshop.no-room", limit=most // 1024**2))
        return self._used

    def _has_room(self, used: Counter[str], size: int, most: int, by: Principal) -> bool:
        own = used.total() if by.is_machine else used[by.owner]
        return own + size <= most and used.total() + size <= self._limit

    def get(self, id: str, version: int | None, by: Principal) -> PlantVersion:
        """Return a version of a plant, by default the latest: the client's own, else anybody's. Raises Unknown."""
        found = self._own(id, version, by) or self._store.get(None, id, version)
        if found is not None:
            return found
        known = [plant.id for plant in self.latest(by)]
        if id in known:
            raise Unknown(Message("workshop.version-unknown", id=id, version=version or 0))
        remedy = Message.from_data(suggestion(id, known)) if known else None
        raise Unknown(Message("workshop.unknown", id=id[:64]), remedy)

    def _own(self, id: str, version: int | None, by: Principal) -> PlantVersion | None:
        return next((p for owner in _owners(by) if (p := self._store.get(owner, id, version)) is not None), None)

    def latest(self, by: Principal) -> list[PlantVersion]:
        """Return the latest version of each plant, the client's own before others', the last saved first."""
        found: dict[str, PlantVersion] = {}
        for plant in sorted(self._store.latest(), key=lambda plant: not self.is_own(plant, by)):
            found.setdefault(plant.id, plant)
        return sorted(found.values(), key=lambda plant: -plant.saved)

    @staticmethod
    def is_own(plant: PlantVersion, by: Principal) -> bool:
        """Return whether a client may delete a plant."""
        return by.acts_for(plant.owner)

    def versions(self, id: str, by: Principal) -> list[PlantVersion]:
        """Return all versions of a plant without texts, the latest first. Raises Unknown."""
        return self._store.versions(self._owner(id, by), id)

    def _owner(self, id: str, by: Principal) -> str:
        """Return the owner of the plant that an id means, damaged or not: the client, else another. Raises Unknown."""
        owners = self._store.owners(id)
        own = [owner for owner in _owners(by) if owner in owners]
        if not owners:
            self.get(id, None, by)  # names the nearest ids
        return (own or owners)[0]

    def remove(self, id: str, by: Principal) -> None:
        """Delete a plant with all its versions; it can be restored for 30 days. Raises Unknown, NotOwner."""
        owner = self._owner(id, by)
        if not by.acts_for(owner):
            raise NotOwner(Message("workshop.not-owner", id=id))
        self._store.remove(owner, id)

    def restore(self, id: str, by: Principal) -> PlantVersion:
        """Bring a client's deleted plant back with all its versions. Raises Unknown."""
        for owner in _owners(by):
            if self._store.restore(owner, id):
                break
        return self.get(id, None, by)

    def named(self, name: str, by: Principal) -> PlantVersion | None:
        """Return the version that a name in a request means; None for the library's, and for names that nobody knows.

        Raises Unknown for a version that does not exist.
        """
        parts = _REFERENCE.fullmatch(name)
        if parts is None or parts["id"] in library.plants():
            return None
        version = None if parts["version"] is None else int(parts["version"])
        try:
            return self.get(parts["id"], version, by)
        except Unknown:
            if version is None:
                return None  # the library names the nearest ids
            raise


def check_id(id: str) -> None:
    """Raise InvalidSpec for an id under which no plant can be saved."""
    if not ID.fullmatch(id):
        raise invalid("id", id, Message("workshop.id"))
    if id in library.plants():
        raise invalid("id", id, Message("workshop.of-library", id=id))


def saved_data(plant: PlantVersion) -> Any:
    """Return the data of a saved plant. Raises InvalidSpec for a text that cannot be read."""
    try:
        return parse(plant.text).data
    except DocumentError:
        raise invalid("plant", plant.id, Message("workshop.draft", id=plant.id)) from None


def saved_json(plant: PlantVersion) -> bytes:
    """Return a saved plant as JSON. Raises InvalidSpec for a draft with errors."""
    return validated(Plant, saved_data(plant)).model_dump_json(exclude_unset=True, context={"language": ALL}).encode()


def _owners(by: Principal) -> tuple[str, ...]:
    return tuple(owner for owner in (by.owner, by.also) if owner)
