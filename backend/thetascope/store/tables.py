"""The tables of the newest schema, the checksums of their rows, and fields that may be damaged."""

import hashlib
import json
from typing import Any

from sqlalchemy import Column, ColumnElement, MetaData, Table

from thetascope.store.backends.column_types import Blob, Characters, Real, Whole

METADATA = MetaData()

_EARLIEST, _LATEST = 1e9, 253402300800.0
"""Times in s since 1970: before the first removal, and the year 10000."""

UNKNOWN = "? unknown"
"""The owner in a damaged row. It is never written, and no client has this name."""

#: Specs are kept. `spec_sum` and `outcome_sum` are checksums of what is posted and of what is computed. `pinned`
#: changes without the rest and is in neither, as is `removed`: the time at which it was removed, null before.
RUNS = Table(
    "runs",
    METADATA,
    Column("id", Characters, primary_key=True),
    Column("spec", Characters, nullable=False),
    Column("title", Characters, nullable=False),
    Column("status", Characters, nullable=False),
    Column("error", Characters),
    Column("summary", Characters),
    Column("engine", Characters, nullable=False),
    Column("created", Real, nullable=False),
    Column("pinned", Whole, nullable=False),
    Column("spec_sum", Characters),
    Column("outcome_sum", Characters),
    Column("removed", Real),
)

#: Results can be computed again, and are deleted to free space.
RESULTS = Table(
    "results",
    METADATA,
    Column("id", Characters, primary_key=True),
    Column("engine", Characters, primary_key=True),
    Column("used", Real, nullable=False),
    Column("size", Whole, nullable=False),
    Column("rows", Whole, nullable=False),
    Column("head", Characters, nullable=False),
    Column("data", Blob, nullable=False),
    Column("checksum", Characters),
)

#: Who posted a run: equal experiments share one row of `runs`, so a run may have several owners, or none.
OWNERS = Table(
    "owners",
    METADATA,
    Column("run", Characters, primary_key=True),
    Column("owner", Characters, primary_key=True),
    Column("checksum", Characters),
)

#: Facts by which runs are listed, sought and sorted. They follow from spec and outcome, and are computed once. `words`,
#: `numbers`, `changes` and `shown`: see thetascope.store.notebook.
RUN_FACTS = Table(
    "run_facts",
    METADATA,
    Column("run", Characters, primary_key=True),
    Column("experiment", Characters, nullable=False),
    Column("kind", Characters, nullable=False),
    Column("rmse", Real),
    Column("delay", Real),
    Column("false_alarms", Whole),
    Column("words", Characters, nullable=False),
    Column("numbers", Characters, nullable=False),
    Column("changes", Characters, nullable=False),
    Column("shown", Characters, nullable=False),
    Column("checksum", Characters),
)

#: What an owner calls a run, its tags as a JSON list, and the time at which the owner removed it, null before, which is
#: in no checksum.
RUN_NOTES = Table(
    "run_notes",
    METADATA,
    Column("run", Characters, primary_key=True),
    Column("owner", Characters, primary_key=True),
    Column("name", Characters, nullable=False),
    Column("tags", Characters, nullable=False),
    Column("removed", Real),
    Column("checksum", Characters),
)

#: What an owner notes about a comparison of runs; `runs` has their ids in alphabetical order, with commas.
COMPARISON_NOTES = Table(
    "comparison_notes",
    METADATA,
    Column("runs", Characters, primary_key=True),
    Column("owner", Characters, primary_key=True),
    Column("text", Characters, nullable=False),
    Column("checksum", Characters),
)

#: Files of records: the id is the hash of the unpacked bytes, and so their checksum. They cannot be computed again.
RECORDS = Table(
    "records",
    METADATA,
    Column("id", Characters, primary_key=True),
    Column("size", Whole, nullable=False),
    Column("created", Real, nullable=False),
    Column("data", Blob, nullable=False),
)

#: What each owner calls a record, and its plant and mapping as JSON. `owner_sum` is the checksum of record and owner.
RECORD_SHARES = Table(
    "record_shares",
    METADATA,
    Column("record", Characters, primary_key=True),
    Column("owner", Characters, primary_key=True),
    Column("name", Characters, nullable=False),
    Column("plant", Characters),
    Column("mapping", Characters),
    Column("changed", Real, nullable=False),
    Column("owner_sum", Characters),
    Column("checksum", Characters),
)


def _versions(name: str) -> Table:
    """Return a table of texts that clients have saved, one row a version.

    `title`, `format`, `faults` and `ready` are facts of the text; `removed` is the time at which it was deleted, null
    before, and `checksum` covers all columns but this one.
    """
    return Table(
        name,
        METADATA,
        Column("owner", Characters, primary_key=True),
        Column("id", Characters, primary_key=True),
        Column("version", Whole, primary_key=True),
        Column("title", Characters, nullable=False),
        Column("format", Characters, nullable=False),
        Column("faults", Whole, nullable=False),
        Column("ready", Whole, nullable=False),
        Column("text", Characters, nullable=False),
        Column("saved", Real, nullable=False),
        Column("removed", Real),
        Column("checksum", Characters, nullable=False),
    )


PLANTS = _versions("plants")
#: `title` is JSON of the words that a list shows, `faults` the number of steps, and every version is ready.
LESSONS = _versions("lessons")


def checksum(*parts: object) -> str:
    """Return the SHA-256 of texts, bytes, numbers and None, in hexadecimal digits. Types and lengths count, too."""
    digest, short = hashlib.sha256(), []
    for part in parts:
        if part is None:
            short.append(b"n0:")
        elif isinstance(part, bytes | memoryview):
            digest.update(b"".join((*short, b"b%d:" % len(part))))
            digest.update(part)
            short = []
        else:
            kind = b"s" if isinstance(part, str) else b"j"
            data = (part if isinstance(part, str) else json.dumps(part)).encode("utf-8", "surrogateescape")
            short += (kind, b"%d:" % len(data), data)
    digest.update(b"".join(short))
    return digest.hexdigest()


def spec_sum(id: str, spec: object, title: object, created: object) -> str:
    """Return the checksum of the experiment of a run."""
    return checksum(id, spec, title, created)


def outcome_sum(id: str, status: object, error: object, summary: object, engine: object) -> str:
    """Return the checksum of the outcome of a run."""
    return checksum(id, status, error, summary, engine)


def result_sum(id: str, engine: str, rows: object, head: object, data: object) -> str:
    """Return the checksum of a result."""
    return checksum(id, engine, rows, head, data)


def has_spec(row: Any) -> bool:
    """Return whether the experiment in a row of `runs` is the one that was written."""
    return row.spec_sum == spec_sum(row.id, row.spec, row.title, row.created)


def is_whole(row: Any) -> bool:
    """Return whether a row of `runs` is what was written."""
    fits = row.outcome_sum == outcome_sum(row.id, row.status, row.error, row.summary, row.engine)
    return fits and has_spec(row) and is_time(row.created)


def is_time(created: object) -> bool:
    """Return whether a value is a time in seconds since 1970, before the year 10000."""
    return isinstance(created, float | int) and 0 <= created < _LATEST


def was_removed(removed: ColumnElement[Any], before: float = _LATEST) -> ColumnElement[bool]:
    """Return the condition that a row was removed before a time. No other value erases a row: it is damage."""
    return removed.between(_EARLIEST, before)


def has_result(row: Any) -> bool:
    """Return whether a row of `results` is what was written."""
    return row.checksum == result_sum(row.id, row.engine, row.rows, row.head, row.data)


def text_sum(row: Any) -> str:
    """Return the checksum of a version of a plant or a lesson."""
    facts = (row.title, row.format, row.faults, row.ready)
    return checksum(row.owner, row.id, row.version, *facts, row.text, row.saved)


def has_text(row: Any) -> bool:
    """Return whether a row of `plants` or `lessons` is what was written."""
    return row.checksum == text_sum(row)


def facts_sum(run: str, row: Any) -> str:
    """Return the checksum of the facts of a run but their kind, which a session that is saved changes."""
    measures = (row.rmse, row.delay, row.false_alarms)
    return checksum(run, row.experiment, *measures, row.words, row.numbers, row.changes, row.shown)


def has_facts(row: Any) -> bool:
    """Return whether a row of `run_facts` is what was written."""
    return row.checksum == facts_sum(row.run, row)


def owner_sum(item: object, owner: object) -> str:
    """Return the checksum of the owner of a run or a record."""
    return checksum(item, owner)


def has_owner(row: Any) -> bool:
    """Return whether a row of `owners` is what was written."""
    return row.checksum == owner_sum(row.run, row.owner)


def note_sum(run: object, owner: object, name: object, tags: object) -> str:
    """Return the checksum of the name and the tags of a run."""
    return checksum(run, owner, name, tags)


def has_note(row: Any) -> bool:
    """Return whether a row of `run_notes` is what was written."""
    return row.checksum == note_sum(row.run, row.owner, row.name, row.tags)


def comparison_sum(runs: object, owner: object, text: object) -> str:
    """Return the checksum of notes about a comparison."""
    return checksum(runs, owner, text)


def has_comparison_note(row: Any) -> bool:
    """Return whether a row of `comparison_notes` is what was written."""
    return row.checksum == comparison_sum(row.runs, row.owner, row.text)


def share_sum(row: Any) -> str:
    """Return the checksum of an owner's share of a record."""
    return checksum(row.record, row.owner, row.name, row.plant, row.mapping, row.changed)


def has_share(row: Any) -> bool:
    """Return whether a row of `record_shares` is what was written."""
    return row.checksum == share_sum(row) and has_share_owner(row)


def has_share_owner(row: Any) -> bool:
    """Return whether record and owner in a row of `record_shares` are those that were written."""
    return row.owner_sum == owner_sum(row.record, row.owner)


def as_text(value: object) -> str:
    """Return the text in a field that may be damaged, in characters that can be sent; "" for another value."""
    return value.encode("utf-8", "replace").decode("utf-8") if isinstance(value, str) else ""


def as_json(text: str | None) -> Any:
    """Return the data in a JSON text, in characters that can be sent. Raises ValueError, TypeError, RecursionError."""
    data = json.loads(text or "null")
    if text and "\\u" in text:  # an escape may be half of a pair
        data = json.loads(json.dumps(data, ensure_ascii=False).encode("utf-8", "replace"))
    return data


def as_number(value: object) -> float:
    """Return the number in a field that may be damaged; 0 for another value."""
    return float(value) if isinstance(value, int | float) and abs(value) < 1e300 else 0.0
