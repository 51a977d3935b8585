"""The plants that clients have saved: versions of a text, under the id that the text gives.

Everybody who may use the service may read them, as runs, so that a plant is found again from another browser; only its
owner deletes it, and what others save under its id is their own. Where a request names a plant, `two-tanks` means the
latest version of the sender's plant, else of anybody's; `two-tanks@7` means its version 7. Ids of the library are
refused.
"""

import re
import time
from collections.abc import Mapping
from typing import Any

from thetascope import library
from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.plants.text_check import format_of, readable, title_in
from thetascope.runs.specs.refusals import NotOwner, Refusal, Unknown, invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, parse
from thetascope.store import PlantStore, PlantVersion
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.texts.refusal import suggestion

ID = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")
_REFERENCE = re.compile(r"(?P<id>[a-z0-9][a-z0-9-]{0,63})(?:@(?P<version>[0-9]{1,9}))?")
_ROOM = 64 * 1024**2  # characters of all versions of an owner


class NoRoomForPlants(Refusal):
    """There is no room for another version."""


class MyPlants:
    """Stores, finds and deletes the plants of clients."""

    def __init__(self, store: PlantStore) -> None:
        self._store = store

    def save(self, id: str, text: str, ready: bool, by: Principal) -> PlantVersion:
        """Store a text as the next version of a plant; `ready`: it has no errors.

        Raises InvalidSpec for an id of the library or another one than the text has, NoRoomForPlants, StoreError.
        """
        if not ID.fullmatch(id):
            raise invalid("id", id, Message("workshop.id"))
        if id in library.plants():
            raise invalid("id", id, Message("workshop.of-library", id=id))
        document, plant = readable(text)
        written = document.data.get("id") if document is not None and isinstance(document.data, Mapping) else None
        if isinstance(written, str) and ID.fullmatch(written) and written != id:
            raise invalid("id", written, Message("workshop.other-id", id=id, written=written))
        if self._store.usage(by.owner) + len(text) > _ROOM:
            raise NoRoomForPlants(Message("workshop.no-room", limit=_ROOM // 1024**2))
        title = "" if document is None else title_in(document, "en")
        faults = 0 if plant is None else len(plant.channels)
        is_ready = ready and plant is not None
        before = self._store.get(None, id)
        number = 0 if before is None else before.version if before.owner != by.owner else 0
        return self._store.put(
            PlantVersion(by.owner, id, number, title, format_of(text), faults, is_ready, text, time.time())
        )

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
        """Return all versions of a plant, the latest first. Raises Unknown."""
        return self._store.versions(self.get(id, None, by).owner, id)

    def remove(self, id: str, by: Principal) -> None:
        """Delete a plant with all its versions; it can be restored for 30 days. Raises Unknown, NotOwner."""
        plant = self.get(id, None, by)
        if not self.is_own(plant, by):
            raise NotOwner(Message("workshop.not-owner", id=id))
        self._store.remove(plant.owner, id)

    def restore(self, id: str, by: Principal) -> PlantVersion:
        """Bring a client's deleted plant back with all its versions. Raises Unknown."""
        for owner in _owners(by):
            if self._store.restore(owner, id):
                break
        return self.get(id, None, by)

    def plant(self, choice: str | Plant, by: Principal) -> str | Plant:
        """Return a plant that a client names in full if it is one of the client's, else the choice unchanged.

        Raises Unknown for a version that does not exist, and InvalidSpec for a draft with errors.
        """
        if not isinstance(choice, str):
            return choice
        data = self._data(choice, by)
        return choice if data is None else validated(Plant, data)

    def in_full(self, body: Any, by: Principal) -> Any:
        """Return the JSON of a request in which a `plant`, its own or that of its `spec`, is written out.

        Raises as `plant`, but does not validate.
        """
        if not isinstance(body, dict):
            return body
        changes: dict[str, Any] = {}
        if isinstance(body.get("plant"), str):
            data = self._data(body["plant"], by)
            changes |= {} if data is None else {"plant": data}
        if isinstance(body.get("spec"), dict):
            changes |= {"spec": self.in_full(body["spec"], by)}
        return body | changes if changes else body

    def _data(self, name: str, by: Principal) -> Any:
        """Return the data of a client's plant; None for a name of the library, and for one that nobody knows."""
        parts = _REFERENCE.fullmatch(name)
        if parts is None or parts["id"] in library.plants():
            return None
        version = None if parts["version"] is None else int(parts["version"])
        try:
            found = self.get(parts["id"], version, by)
        except Unknown:
            if version is None:
                return None  # the library names the nearest ids
            raise
        try:
            return parse(found.text).data
        except DocumentError:
            raise invalid("plant", name, Message("workshop.draft", id=found.id)) from None


def _owners(by: Principal) -> tuple[str, ...]:
    return tuple(owner for owner in (by.owner, by.also) if owner)
