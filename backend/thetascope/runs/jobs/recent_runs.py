"""Recently ended runs in memory, up to a size: figures and data are often requested right after a run."""

from collections import OrderedDict
from threading import Lock
from typing import Any

from thetascope.runs.jobs.job import Ended

_COUNT = 2000


class Memory:
    """A least-recently-used map from run id to outcome, with at most `limit` bytes of results."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._entries: OrderedDict[str, Ended] = OrderedDict()
        self._size = 0
        self._lock = Lock()

    def get(self, id: str) -> Ended | None:
        """Return the run if it is in memory, and mark it as the most recently used."""
        with self._lock:
            entry = self._entries.get(id)
            if entry is not None:
                self._entries.move_to_end(id)
            return entry

    def put(self, entry: Ended) -> None:
        """Add a run, and drop the least recently used ones if necessary."""
        with self._lock:
            self._remove(entry.snapshot.id)
            self._entries[entry.snapshot.id] = entry
            self._size += entry.size
            while len(self._entries) > 1 and (self._size > self._limit or len(self._entries) > _COUNT):
                self._remove(next(iter(self._entries)))

    def change(self, id: str, **changes: Any) -> None:
        """Replace fields of the snapshot if the run is in memory."""
        with self._lock:
            entry = self._entries.get(id)
            if entry is not None:
                self._entries[id] = entry.with_snapshot(**changes)

    def remove(self, id: str) -> None:
        """Drop the run if it is in memory."""
        with self._lock:
            self._remove(id)

    def snapshots(self) -> list[Ended]:
        """Return all runs, the least recently used first."""
        with self._lock:
            return list(self._entries.values())

    def _remove(self, id: str) -> None:
        entry = self._entries.pop(id, None)
        if entry is not None:
            self._size -= entry.size
