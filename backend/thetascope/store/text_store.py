"""Saved plants and lessons in the store: the text of every version, for each owner."""

import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from sqlalchemy import Float, LargeBinary, Table, and_, cast, delete, desc, func, insert, literal, select, update

from thetascope.messages import Message
from thetascope.store.database import Database
from thetascope.store.errors import Damaged
from thetascope.store.tables import LESSONS, PLANTS, as_number, as_text, has_text, text_sum, was_removed

ROW = 1024
"""Bytes that a version counts in addition to its text."""
_MOST = 10**9  # versions; a higher number is damage
_KEPT = 30 * 24 * 3600.0  # s that a deleted text can be restored


@dataclass(frozen=True)
class TextVersion:
    """One version of a plant or a lesson of an owner.

    Args:
        owner, id, version: whose it is, its id, and the number of the version, from 1.
        title, faults: of a plant its title and the number of its fault channels, as far as the text can be read; of a
            lesson the words that a list shows, as JSON, and the number of its steps.
        format: yaml or json.
        ready: whether the text was complete and without errors when it was saved.
        text: the text, as it was typed.
        saved: time in s since 1970.
    """

    owner: str
    id: str
    version: int
    title: str
    format: str
    faults: int
    ready: bool
    text: str
    saved: float


class TextStore:
    """Reads and writes the texts of all owners, in the table of a subclass."""

    table: Table
    damaged: str  # code of the error for a version that is not what was written

    def __init__(self, database: Database) -> None:
        self._database = database
        listed = [column for column in self.table.c if column.name not in ("text", "checksum")]
        self._without_text = (*listed, literal("").label("text"))

    def put(self, version: TextVersion) -> TextVersion:
        """Store a text as the next version, and return it; the latest one if it is the same text.

        Its number follows that in `version`, and those of all versions that the owner ever had. One that was deleted
        comes back with the new version only.
        """
        clean = replace(version, text=_without_nul(version.text), title=_without_nul(version.title))
        mine = (self.table.c.owner == clean.owner) & (self.table.c.id == clean.id)
        with self._database.writing() as connection:
            connection.execute(delete(self.table).where(was_removed(self.table.c.removed, time.time() - _KEPT)))
            last = connection.execute(
                select(self.table)
                .where(mine & self.table.c.version.between(1, _MOST))
                .order_by(desc(self.table.c.version))
                .limit(1)
            ).one_or_none()
            same = last is not None and last.removed is None and last.text == clean.text and last.ready == clean.ready
            if same and has_text(last):
                return self._version(last)
            stored = replace(clean, version=max(clean.version, 0 if last is None else last.version) + 1)
            row = {**vars(stored), "ready": int(stored.ready), "saved": float(stored.saved)}
            connection.execute(insert(self.table), row | {"checksum": text_sum(_Row(row))})
        return stored

    def get(self, owner: str | None, id: str, version: int | None = None) -> TextVersion | None:
        """Return a version of an owner, or of anybody, by default the latest; None: unknown. Raises Damaged."""
        query = select(self.table).where((self.table.c.id == id) & self.table.c.removed.is_(None))
        if owner is not None:
            query = query.where(self.table.c.owner == owner)
        if version is not None:
            query = query.where(self.table.c.version == version)
        with self._database.reading() as connection:
            latest = query.order_by(desc(self.table.c.version), desc(self.table.c.saved)).limit(1)
            row = connection.execute(latest).one_or_none()
        return None if row is None else self._version(row)

    def latest(self) -> list[TextVersion]:
        """Return the latest version of each text of each owner without texts, the one that was saved last first."""
        newest = (
            select(self.table.c.owner, self.table.c.id, func.max(self.table.c.version).label("version"))
            .where(self.table.c.removed.is_(None))
            .group_by(self.table.c.owner, self.table.c.id)
            .subquery()
        )
        same = [self.table.c[name] == newest.c[name] for name in ("owner", "id", "version")]
        query = select(*self._without_text).join(newest, and_(*same)).order_by(desc(self.table.c.saved))
        with self._database.reading() as connection:
            return _listed(connection.execute(query))

    def versions(self, owner: str, id: str) -> list[TextVersion]:
        """Return all versions of an id without texts, the latest first."""
        query = select(*self._without_text).where(
            (self.table.c.owner == owner) & (self.table.c.id == id) & self.table.c.removed.is_(None)
        )
        with self._database.reading() as connection:
            return _listed(connection.execute(query.order_by(desc(self.table.c.version))))

    def owners(self, id: str) -> list[str]:
        """Return the owners of an id, the one with the highest version first."""
        highest = func.max(self.table.c.version)
        query = (
            select(self.table.c.owner)
            .where((self.table.c.id == id) & self.table.c.removed.is_(None))
            .group_by(self.table.c.owner)
        )
        with self._database.reading() as connection:
            return list(connection.execute(query.order_by(desc(highest), desc(func.max(self.table.c.saved)))).scalars())

    def remove(self, owner: str, id: str) -> bool:
        """Delete all versions of an id, which can be restored; return whether there were any."""
        mine = (self.table.c.owner == owner) & (self.table.c.id == id) & self.table.c.removed.is_(None)
        with self._database.writing() as connection:
            return connection.execute(update(self.table).where(mine).values(removed=time.time())).rowcount > 0

    def restore(self, owner: str, id: str) -> bool:
        """Bring back all versions of an id that was deleted; return whether there were any."""
        mine = (self.table.c.owner == owner) & (self.table.c.id == id) & self.table.c.removed.is_not(None)
        with self._database.writing() as connection:
            return connection.execute(update(self.table).where(mine).values(removed=None)).rowcount > 0

    def erase_removed(self, owner: str) -> int:
        """Erase what an owner has deleted, which can be restored no more; return the number of versions."""
        gone = (self.table.c.owner == owner) & self.table.c.removed.is_not(None)
        with self._database.writing() as connection:
            return connection.execute(delete(self.table).where(gone)).rowcount

    def usage(self) -> dict[str, int]:
        """Return the bytes that the versions of each owner take, those that can be restored included."""
        with self._database.reading() as connection:
            is_sqlite = connection.dialect.name == "sqlite"
            length = (
                func.length(cast(self.table.c.text, LargeBinary)) if is_sqlite else func.octet_length(self.table.c.text)
            )
            size = func.sum(cast(length, Float)) + ROW * func.count()
            rows = connection.execute(select(self.table.c.owner, size).group_by(self.table.c.owner))
            return {as_text(owner): int(as_number(used)) for owner, used in rows}

    def _version(self, row) -> TextVersion:
        if not has_text(row):
            raise Damaged(Message(self.damaged, id=as_text(row.id)[:64], version=int(as_number(row.version))))
        facts = (row.title, row.format, row.faults, bool(row.ready))
        return TextVersion(row.owner, row.id, row.version, *facts, row.text, row.saved)


def _without_nul(text: str) -> str:
    """Return a text that every database can hold."""
    return text.replace("\0", "\ufffd")


def _listed(rows: Iterable[Any]) -> list[TextVersion]:
    """Return the versions in rows without texts. They are not verified, and a damaged field is empty."""
    return [
        TextVersion(
            *(as_text(row.owner), as_text(row.id), int(as_number(row.version))),
            *(as_text(row.title), as_text(row.format), int(as_number(row.faults)), row.ready == 1),
            *("", as_number(row.saved)),
        )
        for row in rows
    ]


class PlantStore(TextStore):
    """Reads and writes the plants of all owners."""

    table, damaged = PLANTS, "store.plant-damaged"


class LessonStore(TextStore):
    """Reads and writes the lessons of all owners."""

    table, damaged = LESSONS, "store.lesson-damaged"


class _Row:
    """The values of a row by name, before it is written."""

    def __init__(self, values: dict) -> None:
        vars(self).update(values)
