"""Files of records in the store: the bytes once, and for each owner a name, a plant and a mapping."""

import hashlib
import logging
import time
import zlib
from dataclasses import dataclass, replace
from typing import Any

from sqlalchemy import Float, cast, delete, func, select
from sqlalchemy.dialects import postgresql, sqlite

from thetascope.messages import Message
from thetascope.store.database import Database
from thetascope.store.errors import Damaged
from thetascope.store.tables import (
    RECORD_SHARES,
    RECORDS,
    UNKNOWN,
    as_number,
    has_share,
    has_share_owner,
    owner_sum,
    share_sum,
)

log = logging.getLogger(__name__)

_ID = 32  # hexadecimal digits
_SHARE = ("name", "plant", "mapping", "changed", "owner_sum", "checksum")


def record_id(data: bytes) -> str:
    """Return the id of a file: the beginning of the SHA-256 of its bytes."""
    return hashlib.sha256(data).hexdigest()[:_ID]


def has_record(row: Any) -> bool:
    """Return whether a row of `records` holds the bytes that its id says."""
    try:
        decoder = zlib.decompressobj()
        data = decoder.decompress(row.data, int(row.size) + 1)
    except (zlib.error, TypeError, ValueError, OverflowError):
        return False
    return len(data) == row.size and record_id(data) == row.id


@dataclass(frozen=True)
class Share:
    """A record of one owner; plant and mapping are JSON text, or None where they were not chosen."""

    record: str
    owner: str
    name: str
    plant: str | None
    mapping: str | None
    changed: float


@dataclass(frozen=True)
class Line:
    """A record in a list."""

    id: str
    name: str
    size: int
    changed: float


def _share(row: Any) -> Share:
    """Return the share in a row.

    A damaged owner is one that no client matches. Of a share that is damaged elsewhere only the owner is believed: it
    has no name, and no plant or mapping was chosen.
    """
    if not has_share_owner(row):
        log.error("an owner of record %s is damaged", row.record)
        return Share(row.record, UNKNOWN, "", None, None, 0.0)
    if not has_share(row):
        log.error("the name, the plant or the mapping of record %s is damaged", row.record)
        return Share(row.record, row.owner, "", None, None, 0.0)
    return Share(row.record, row.owner, row.name, row.plant, row.mapping, row.changed)


class RecordStore:
    """Reads and writes files of records and the shares of their owners."""

    def __init__(self, database: Database) -> None:
        self._database = database

    @property
    def read_only(self) -> bool:
        """Whether nothing can be written."""
        return self._database.read_only

    def put(self, data: bytes, share: Share) -> None:
        """Store a file, if it is not there, and an owner's share of it."""
        row = {"id": share.record, "size": len(data), "created": time.time(), "data": zlib.compress(data, 1)}
        with self._database.writing() as connection:
            insert = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}[connection.dialect.name]
            connection.execute(insert(RECORDS).on_conflict_do_nothing(), row)
        self.put_share(share)

    def put_share(self, share: Share) -> None:
        """Store an owner's share of a record, or replace it."""
        share = replace(share, name=share.name.replace("\0", "\ufffd"), changed=float(share.changed))
        values = {**vars(share), "owner_sum": owner_sum(share.record, share.owner), "checksum": share_sum(share)}
        with self._database.writing() as connection:
            insert = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}[connection.dialect.name]
            statement = insert(RECORD_SHARES)
            changes = {name: statement.excluded[name] for name in _SHARE}
            keys = list(RECORD_SHARES.primary_key)
            connection.execute(statement.on_conflict_do_update(index_elements=keys, set_=changes), values)

    def data(self, id: str) -> bytes | None:
        """Return the bytes of a file, or None if there is no such record. Raises Damaged."""
        with self._database.reading() as connection:
            row = connection.execute(select(RECORDS).where(RECORDS.c.id == id)).one_or_none()
        if row is None:
            return None
        if not has_record(row):
            raise Damaged(Message("store.record-damaged", id=id[:64]))
        return zlib.decompress(row.data)

    def shares(self, id: str) -> list[Share]:
        """Return the shares of a record, the last one that changed first."""
        query = select(RECORD_SHARES).where(RECORD_SHARES.c.record == id)
        with self._database.reading() as connection:
            return sorted(map(_share, connection.execute(query)), key=lambda share: -share.changed)

    def page(self, owners: tuple[str, ...] | None, limit: int) -> list[Line]:
        """Return the records of some owners, or of all, the last one that changed first."""
        query = select(RECORD_SHARES, RECORDS.c.size).join(RECORDS, RECORD_SHARES.c.record == RECORDS.c.id)
        if owners is not None:
            query = query.where(RECORD_SHARES.c.owner.in_(owners))
        lines: dict[str, Line] = {}
        with self._database.reading() as connection:
            for row in connection.execute(query):
                share, size = _share(row), int(as_number(row.size))
                line = Line(share.record, share.name, size, share.changed)
                known = lines.get(line.id, line)
                if owners is None or share.owner in owners:
                    lines[line.id] = max(known, line, key=lambda one: one.changed)
        return sorted(lines.values(), key=lambda line: (-line.changed, line.id))[:limit]

    def delete_share(self, id: str, owner: str | None) -> bool:
        """Remove an owner's share, or all of them, and the file with the last one; return whether the file is gone."""
        with self._database.writing() as connection:
            mine = RECORD_SHARES.c.record == id
            own = mine if owner is None else mine & (RECORD_SHARES.c.owner == owner)
            connection.execute(delete(RECORD_SHARES).where(own))
            if connection.execute(select(func.count()).select_from(RECORD_SHARES).where(mine)).scalar_one():
                return False
            connection.execute(delete(RECORDS).where(RECORDS.c.id == id))
            return True

    def usage(self, owner: str | None = None) -> int:
        """Return the bytes of all records as they are stored, or of those of an owner."""
        size = func.coalesce(func.sum(cast(func.length(RECORDS.c.data), Float)), 0)
        query = select(size)
        if owner is not None:
            own = select(RECORD_SHARES.c.record).where(RECORD_SHARES.c.owner == owner)
            query = query.where(RECORDS.c.id.in_(own))
        with self._database.reading() as connection:
            return int(as_number(connection.execute(query).scalar_one()))
