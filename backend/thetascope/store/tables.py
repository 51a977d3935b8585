"""The tables of the newest schema, the checksums of their rows, and fields that may be damaged."""

import hashlib
import json
from collections.abc import Callable
from typing import Any

from sqlalchemy import Column, Dialect, Float, LargeBinary, MetaData, Table, Text
from sqlalchemy.types import BigInteger


class Blob(LargeBinary):
    """Bytes that are written from a buffer, and read as the driver returns them: a damaged row may hold other types."""

    cache_ok = True

    def bind_processor(self, dialect: Dialect) -> Callable[..., Any] | None:
        """Return how a value is passed to the driver: SQLite reads from the buffer itself."""
        return None if dialect.name == "sqlite" else bytes

    def result_processor(self, dialect: Dialect, coltype: object) -> None:
        """Return that values are left as they are."""
        return


METADATA = MetaData()

#: Specs are kept. `spec_sum` and `outcome_sum` are checksums of what is posted and of what is computed. `pinned`
#: changes without the rest and is in neither, as is `removed`: the time at which it was removed, null before.
RUNS = Table(
    "runs",
    METADATA,
    Column("id", Text, primary_key=True),
    Column("spec", Text, nullable=False),
    Column("title", Text, nullable=False),
    Column("status", Text, nullable=False),
    Column("error", Text),
    Column("summary", Text),
    Column("engine", Text, nullable=False),
    Column("created", Float, nullable=False),
    Column("pinned", BigInteger, nullable=False),
    Column("spec_sum", Text),
    Column("outcome_sum", Text),
    Column("removed", Float),
)

#: Results can be computed again, and are deleted to free space.
RESULTS = Table(
    "results",
    METADATA,
    Column("id", Text, primary_key=True),
    Column("engine", Text, primary_key=True),
    Column("used", Float, nullable=False),
    Column("size", BigInteger, nullable=False),
    Column("rows", BigInteger, nullable=False),
    Column("head", Text, nullable=False),
    Column("data", Blob, nullable=False),
    Column("checksum", Text),
)

#: Who posted a run: equal experiments share one row of `runs`, so a run may have several owners, or none.
OWNERS = Table(
    "owners",
    METADATA,
    Column("run", Text, primary_key=True),
    Column("owner", Text, primary_key=True),
)

#: Facts by which runs are listed, sought and sorted. They follow from spec and outcome, and are computed once. `words`,
#: `numbers`, `changes` and `shown`: see thetascope.store.notebook.
RUN_FACTS = Table(
    "run_facts",
    METADATA,
    Column("run", Text, primary_key=True),
    Column("experiment", Text, nullable=False),
    Column("kind", Text, nullable=False),
    Column("rmse", Float),
    Column("delay", Float),
    Column("false_alarms", BigInteger),
    Column("words", Text, nullable=False),
    Column("numbers", Text, nullable=False),
    Column("changes", Text, nullable=False),
    Column("shown", Text, nullable=False),
)

#: What an owner calls a run, its tags as a JSON list, and the time at which the owner removed it, null before.
RUN_NOTES = Table(
    "run_notes",
    METADATA,
    Column("run", Text, primary_key=True),
    Column("owner", Text, primary_key=True),
    Column("name", Text, nullable=False),
    Column("tags", Text, nullable=False),
    Column("removed", Float),
)

#: What an owner notes about a comparison of runs; `runs` has their ids in alphabetical order, with commas.
COMPARISON_NOTES = Table(
    "comparison_notes",
    METADATA,
    Column("runs", Text, primary_key=True),
    Column("owner", Text, primary_key=True),
    Column("text", Text, nullable=False),
)

#: Files of records: the id is the hash of the unpacked bytes, and so their checksum. They cannot be computed again.
RECORDS = Table(
    "records",
    METADATA,
    Column("id", Text, primary_key=True),
    Column("size", BigInteger, nullable=False),
    Column("created", Float, nullable=False),
    Column("data", Blob, nullable=False),
)

#: What each owner calls a record, and its plant and mapping as JSON.
RECORD_SHARES = Table(
    "record_shares",
    METADATA,
    Column("record", Text, primary_key=True),
    Column("owner", Text, primary_key=True),
    Column("name", Text, nullable=False),
    Column("plant", Text),
    Column("mapping", Text),
    Column("changed", Float, nullable=False),
)

#: Plants that clients have saved, one row a version. `title`, `format`, `faults` and `ready` are facts of the text;
#: `removed` is the time at which it was deleted, null before, and `checksum` covers all columns but this one.
PLANTS = Table(
    "plants",
    METADATA,
    Column("owner", Text, primary_key=True),
    Column("id", Text, primary_key=True),
    Column("version", BigInteger, primary_key=True),
    Column("title", Text, nullable=False),
    Column("format", Text, nullable=False),
    Column("faults", BigInteger, nullable=False),
    Column("ready", BigInteger, nullable=False),
    Column("text", Text, nullable=False),
    Column("saved", Float, nullable=False),
    Column("removed", Float),
    Column("checksum", Text, nullable=False),
)


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
    return isinstance(created, float | int) and 0 <= created < 253402300800


def has_result(row: Any) -> bool:
    """Return whether a row of `results` is what was written."""
    return row.checksum == result_sum(row.id, row.engine, row.rows, row.head, row.data)


def plant_sum(row: Any) -> str:
    """Return the checksum of a version of a plant."""
    facts = (row.title, row.format, row.faults, row.ready)
    return checksum(row.owner, row.id, row.version, *facts, row.text, row.saved)


def has_plant(row: Any) -> bool:
    """Return whether a row of `plants` is what was written."""
    return row.checksum == plant_sum(row)


def as_text(value: object) -> str:
    """Return the text in a field that may be damaged, in characters that can be sent; "" for another value."""
    return value.encode("utf-8", "replace").decode("utf-8") if isinstance(value, str) else ""


def as_number(value: object) -> float:
    """Return the number in a field that may be damaged; 0 for another value."""
    return float(value) if isinstance(value, int | float) and abs(value) < 1e300 else 0.0
