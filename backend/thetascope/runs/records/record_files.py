"""The records that clients have uploaded.

Equal files are one record, of which each owner has a share: a name, a plant and a mapping. Whoever knows the id, the
hash of the file, may read it; only owners change or remove their share, and the file goes with the last one.
"""

import json
import logging
import time
from dataclasses import dataclass

from thetascope.access.principal import Principal
from thetascope.assembly.analyses.record_run import RecordBytes, diagnosed_plant
from thetascope.messages import Message
from thetascope.runs.jobs.ownership import share_of
from thetascope.runs.records.record_answers import RecordAnswers, answer_key
from thetascope.runs.specs.refusals import InvalidSpec, Refusal, Unknown, validated
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope.store import RecordStore, Share, record_id
from thetascope.store.record_store import Line
from thetascope_schemas.experiment.experiment import ResolvedExperiment
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.experiment.plant import Plant

log = logging.getLogger(__name__)

_OF_ONE = 4  # the part of the room that one client may fill, unless it is the machine's owner
_LONGEST = 200  # characters of a name


class NoRoom(Refusal):
    """There is no room for another record."""


@dataclass(frozen=True)
class RecordFile:
    """A record as one client sees it: id, name, bytes, plant (None: not chosen) and what is changed in the mapping."""

    id: str
    name: str
    data: bytes
    plant: Plant | None
    mapping: ColumnMapping


class RecordFiles:
    """Stores, finds and removes uploaded records. `limit`: bytes of all together, as they are stored."""

    def __init__(self, store: RecordStore, limit: int) -> None:
        self._store, self._limit = store, limit
        self.answers = RecordAnswers()

    def put(
        self, name: str, data: bytes, plant: str | Plant | None, mapping: ColumnMapping, by: Principal
    ) -> RecordFile:
        """Store a record with its plant and mapping. Raises Unknown for no such plant, NoRoom, StoreError."""
        chosen = None if plant is None else plant_of(plant)
        id = record_id(data)
        if not any(share.owner == by.owner for share in self._store.shares(id)):
            self._check_room(len(data), by)
        self._store.put(data, _share(id, by.owner, name, plant, mapping))
        return RecordFile(id, name, data, chosen, mapping)

    def _check_room(self, size: int, by: Principal) -> None:
        own = None if by.is_machine else by.owner
        used, most = self._store.usage(own), self._limit if by.is_machine else self._limit // _OF_ONE
        if used + size > most or self._store.usage() + size > self._limit:
            raise NoRoom(Message("record.no-room", used=used // 1024**2, limit=most // 1024**2))

    def get(self, id: str, by: Principal) -> RecordFile:
        """Return a record with a client's plant and mapping, else those that were changed last. Raises Unknown."""
        data = self._store.data(id)
        shares = self._store.shares(id)
        if data is None or not shares:
            raise Unknown(Message("record.unknown", id=id[:64]))
        share = next((share for share in shares if share.owner in (by.owner, by.also)), shares[0])
        return RecordFile(id, share.name, data, *_chosen(share))

    def of_experiment(self, spec: ResolvedExperiment) -> RecordBytes:
        """Return the file of an experiment's record, with its diagnosis where it is known. Raises Unknown."""
        record = spec.truth.record
        data = None if record is None else self._store.data(record.id)
        if record is None or data is None:
            raise Unknown(Message("record.unknown", id="" if record is None else record.id))
        key = answer_key(record.id, diagnosed_plant(spec), record.mapping, record.settings)
        return RecordBytes(record.name, data, self.answers.get(key))

    def change(self, id: str, plant: str | Plant, mapping: ColumnMapping, by: Principal) -> RecordFile:
        """Set the plant and the mapping of a client's share; whoever has none gets one. Raises Unknown, NoRoom."""
        known = self.get(id, by)
        chosen = plant_of(plant)
        if not any(share.owner == by.owner for share in self._store.shares(id)):
            self._check_room(0, by)
        self._store.put_share(_share(id, by.owner, known.name, plant, mapping))
        return RecordFile(id, known.name, known.data, chosen, mapping)

    def page(self, by: Principal, limit: int) -> list[Line]:
        """Return the records of a client, the last one that changed first; for the machine's owner all."""
        return self._store.page(None if by.is_machine else tuple(o for o in (by.owner, by.also) if o), limit)

    def remove(self, id: str, by: Principal) -> bool:
        """Remove a client's share, for the machine's owner the record; return whether the file is gone.

        Raises Unknown, or NotOwner for a client without a share.
        """
        owners = frozenset(share.owner for share in self._store.shares(id))
        if not owners:
            raise Unknown(Message("record.unknown", id=id[:64]))
        return self._store.delete_share(id, None if by.is_machine else share_of(owners, by))


def _share(id: str, owner: str, name: str, plant: str | Plant | None, mapping: ColumnMapping) -> Share:
    chosen = None if plant is None else json.dumps(plant) if isinstance(plant, str) else plant.model_dump_json()
    return Share(id, owner, name[:_LONGEST], chosen, mapping.model_dump_json(), time.time())


def _chosen(share: Share) -> tuple[Plant | None, ColumnMapping]:
    """Return the plant and the mapping of a share; one that is stored wrongly was not chosen."""
    plant, mapping = None, ColumnMapping()
    try:
        plant = None if share.plant is None else plant_of(_plant(share.plant))
        mapping = mapping if share.mapping is None else validated(ColumnMapping, json.loads(share.mapping))
    except InvalidSpec:
        log.error("the plant or the mapping of record %s is not valid", share.record)
    return plant, mapping


def _plant(text: str) -> str | Plant:
    data = json.loads(text)
    return data if isinstance(data, str) else validated(Plant, data)
