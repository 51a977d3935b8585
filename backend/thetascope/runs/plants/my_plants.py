"""The plants that clients have saved: versions of a text, under the id that the text gives.

Who may read and delete them: thetascope.runs.saved_texts. Where a request names a plant, `two-tanks` means the latest
version of the sender's plant, else of anybody's; `two-tanks@7` means its version 7. Ids of the library are refused.
"""

import re
import time
from typing import Any

from thetascope import library
from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.plants.text_check import TextFacts, format_of
from thetascope.runs.saved_texts import SavedTexts
from thetascope.runs.specs.refusals import Unknown, invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, parse
from thetascope.store import TextVersion
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.texts.local_text import ALL

ID = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")
_REFERENCE = re.compile(r"(?P<id>[a-z0-9][a-z0-9-]{0,63})(?:@(?P<version>[0-9]{1,9}))?")


class MyPlants(SavedTexts):
    """Stores, finds and deletes the plants of clients."""

    unknown, version_unknown = "workshop.unknown", "workshop.version-unknown"
    not_owner, no_room = "workshop.not-owner", "workshop.no-room"

    def save(self, id: str, text: str, facts: TextFacts, ready: bool, by: Principal) -> tuple[TextVersion, bool]:
        """Store a text as the next version of a plant; return the latest version, and whether it is a new one.

        Args:
            id: the plant's id.
            text, facts: the text and its facts.
            ready: whether it has no errors.
            by: the client that saves it.

        Raises InvalidSpec for an id of the library or another one than the text has, NoRoomForTexts, StoreError.
        """
        check_id(id)
        if ID.fullmatch(facts.id) and facts.id != id:
            raise invalid("id", facts.id, Message("workshop.other-id", id=id, written=facts.id))
        is_ready = ready and facts.is_plant
        version = TextVersion(by.owner, id, 0, facts.title, format_of(text), facts.faults, is_ready, text, time.time())
        return self.put(version, by)

    def named(self, name: str, by: Principal) -> TextVersion | None:
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


def saved_data(plant: TextVersion) -> Any:
    """Return the data of a saved plant. Raises InvalidSpec for a text that cannot be read."""
    try:
        return parse(plant.text).data
    except DocumentError:
        raise invalid("plant", plant.id, Message("workshop.draft", id=plant.id)) from None


def saved_json(plant: TextVersion) -> bytes:
    """Return a saved plant as JSON. Raises InvalidSpec for a draft with errors."""
    return validated(Plant, saved_data(plant)).model_dump_json(exclude_unset=True, context={"language": ALL}).encode()
