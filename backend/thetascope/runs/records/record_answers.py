"""Diagnoses of stored records, kept by everything that determines them."""

import hashlib
from collections import OrderedDict
from threading import Lock

from thetascope_schemas import Plant
from thetascope_schemas.experiment.measurement import ColumnMapping, RecordSettings
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis

_MOST = 64


def answer_key(id: str, plant: Plant, mapping: ColumnMapping, settings: RecordSettings) -> str:
    """Return the hash of a record's id, the plant without its controllers, the mapping and the settings."""
    plant = plant.without_controllers  # the record holds the applied inputs
    parts = (id, *(part.model_dump_json() for part in (plant, mapping, settings)))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


class RecordAnswers:
    """A least-recently-used map from `answer_key` to diagnosis."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, RecordDiagnosis] = OrderedDict()
        self._lock = Lock()

    def get(self, key: str) -> RecordDiagnosis | None:
        """Return a diagnosis, None if it is not known."""
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
            return self._known.get(key)

    def put(self, key: str, diagnosis: RecordDiagnosis) -> None:
        """Keep a diagnosis, and drop the least recently used ones if necessary."""
        with self._lock:
            self._known[key] = diagnosis
            self._known.move_to_end(key)
            while len(self._known) > _MOST:
                self._known.popitem(last=False)
