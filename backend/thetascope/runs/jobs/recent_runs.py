"""The runs that ended last, in memory up to a size: figures and data follow a run without reading it back."""

from collections import OrderedDict
from threading import Lock

from thetascope.runs.jobs.job import Finished

_COUNT = 2000


class Memory:
    """A least-recently-used map from run id to :class:`Finished`, of at most `limit` bytes of results."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._entries: OrderedDict[str, Finished] = OrderedDict()
        self._size = 0
        self._lock = Lock()

    def get(self, id: str) -> Finished | None:
        with self._lock:
            entry = self._entries.get(id)
            if entry is not None:
                self._entries.move_to_end(id)
            return entry

    def put(self, entry: Finished) -> None:
        with self._lock:
            self._remove(entry.snapshot.id)
            self._entries[entry.snapshot.id] = entry
            self._size += entry.size
            while len(self._entries) > 1 and (self._size > self._limit or len(self._entries) > _COUNT):
                self._remove(next(iter(self._entries)))

    def change(self, id: str, **changes: object) -> None:
        """Replace fields of the snapshot, if the run is here."""
        with self._lock:
            entry = self._entries.get(id)
            if entry is not None:
                self._entries[id] = entry.with_snapshot(**changes)

    def remove(self, id: str) -> None:
        with self._lock:
            self._remove(id)

    def snapshots(self) -> list[Finished]:
        with self._lock:
            return list(self._entries.values())

    def _remove(self, id: str) -> None:
        entry = self._entries.pop(id, None)
        if entry is not None:
            self._size -= entry.size
