"""What clients save: versions of a text under an id, for plants and lessons.

Everybody who may use the service may read them, as runs, so that a text is found again from another browser and a link
is enough to share one; only its owner deletes it, and what others save under its id is their own. An id means the
latest version of the client's own text, else of anybody's.
"""

from collections import Counter
from dataclasses import replace
from threading import Lock

from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotOwner, Refusal, Unknown
from thetascope.store import Damaged, TextStore, TextVersion
from thetascope.store.text_store import ROW
from thetascope_schemas.texts.refusal import suggestion

_OF_ONE = 4  # the part of the room that one client may fill, unless it is the machine's owner


class NoRoomForTexts(Refusal):
    """There is no room for another version."""


class SavedTexts:
    """Stores, finds and deletes the texts of clients. `limit`: bytes of all versions of all texts together."""

    # codes of the refusals, which name the kind of text
    unknown: str
    version_unknown: str
    not_owner: str
    no_room: str

    def __init__(self, store: TextStore, limit: int) -> None:
        self._store, self._limit = store, limit
        self._saving = Lock()
        self._used: Counter[str] | None = None  # bytes of each owner: counting them reads all texts

    def put(self, version: TextVersion, by: Principal) -> tuple[TextVersion, bool]:
        """Store a text as the next version; return the latest version, and whether it is a new one.

        Its number follows also that of another owner's latest version, so that it is the latest of all. Raises
        NoRoomForTexts, StoreError.
        """
        size = len(version.text.encode()) + ROW
        with self._saving:
            used = self._make_room(size, by)
            stored = self._store.put(replace(version, version=self._number_of_others(version.id, by)))
            is_new = stored.saved == version.saved
            used[by.owner] += size * is_new
        return stored, is_new

    def _number_of_others(self, id: str, by: Principal) -> int:
        """Return the number of the latest version if it is another client's, else 0: the store counts the client's."""
        try:
            latest = self._store.get(None, id)
        except Damaged:  # to save a whole version is what the error asks for
            return 0
        return 0 if latest is None or latest.owner == by.owner else latest.version

    def _make_room(self, size: int, by: Principal) -> Counter[str]:
        """Return the bytes of each owner. Where there is no room, what the client has deleted is erased for good.

        Raises NoRoomForTexts.
        """
        most = self._limit if by.is_machine else self._limit // _OF_ONE
        if self._used is not None and self._has_room(self._used, size, most, by):
            return self._used
        self._used = Counter(self._store.usage())
        if not self._has_room(self._used, size, most, by) and self._store.erase_removed(by.owner):
            self._used = Counter(self._store.usage())
        if not self._has_room(self._used, size, most, by):
            raise NoRoomForTexts(Message(self.no_room, limit=most // 1024**2))
        return self._used

    def _has_room(self, used: Counter[str], size: int, most: int, by: Principal) -> bool:
        own = used.total() if by.is_machine else used[by.owner]
        return own + size <= most and used.total() + size <= self._limit

    def find(self, id: str, version: int | None, by: Principal) -> TextVersion | None:
        """Return a version, by default the latest: the client's own, else anybody's; None: unknown. Raises Damaged."""
        own = (self._store.get(owner, id, version) for owner in owners_of(by))
        return next((one for one in own if one is not None), None) or self._store.get(None, id, version)

    def get(self, id: str, version: int | None, by: Principal) -> TextVersion:
        """Return the same. Raises Unknown with the nearest id, Damaged."""
        found = self.find(id, version, by)
        if found is not None:
            return found
        known = [one.id for one in self.latest(by)]
        if id in known:
            raise Unknown(Message(self.version_unknown, id=id, version=version or 0))
        remedy = Message.from_data(suggestion(id, known)) if known else None
        raise Unknown(Message(self.unknown, id=id[:64]), remedy)

    def latest(self, by: Principal) -> list[TextVersion]:
        """Return the latest version of each id without texts, the client's own before others', the last saved first."""
        found: dict[str, TextVersion] = {}
        for one in sorted(self._store.latest(), key=lambda one: not by.acts_for(one.owner)):
            found.setdefault(one.id, one)
        return sorted(found.values(), key=lambda one: -one.saved)

    def versions(self, id: str, by: Principal) -> list[TextVersion]:
        """Return all versions of an id without texts, the latest first. Raises Unknown."""
        return self._store.versions(self._owner(id, by), id)

    def _owner(self, id: str, by: Principal) -> str:
        """Return the owner of the text that an id means, damaged or not: the client, else another. Raises Unknown."""
        owners = self._store.owners(id)
        own = [owner for owner in owners_of(by) if owner in owners]
        if not owners:
            self.get(id, None, by)  # names the nearest ids
        return (own or owners)[0]

    def remove(self, id: str, by: Principal) -> None:
        """Delete all versions of an id; they can be restored for 30 days. Raises Unknown, NotOwner."""
        owner = self._owner(id, by)
        if not by.acts_for(owner):
            raise NotOwner(Message(self.not_owner, id=id))
        self._store.remove(owner, id)

    def restore(self, id: str, by: Principal) -> TextVersion:
        """Bring back all versions of an id that the client has deleted. Raises Unknown."""
        for owner in owners_of(by):
            if self._store.restore(owner, id):
                break
        return self.get(id, None, by)


def owners_of(by: Principal) -> tuple[str, ...]:
    """Return the owners in whose name a client acts, its own first."""
    return tuple(owner for owner in (by.owner, by.also) if owner)
