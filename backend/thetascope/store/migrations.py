"""The tables as a list of migrations: entry n upgrades a store from version n to n + 1. Entries are never edited."""

from collections.abc import Callable
from typing import Any

from sqlalchemy import Connection, Table, select, update

from thetascope.store.tables import (
    COMPARISON_NOTES,
    OWNERS,
    RECORD_SHARES,
    RESULTS,
    RUN_FACTS,
    RUN_NOTES,
    RUNS,
    comparison_sum,
    facts_sum,
    note_sum,
    outcome_sum,
    owner_sum,
    result_sum,
    share_sum,
    spec_sum,
)


def add_checksums(connection: Connection) -> None:
    """Give the rows of an earlier version checksums, one row after the other."""
    columns = (RUNS.c.spec, RUNS.c.title, RUNS.c.created, RUNS.c.status, RUNS.c.error, RUNS.c.summary, RUNS.c.engine)
    for id in connection.execute(select(RUNS.c.id)).scalars().all():
        spec, title, created, *outcome = connection.execute(select(*columns).where(RUNS.c.id == id)).one()
        sums = {"spec_sum": spec_sum(id, spec, title, created), "outcome_sum": outcome_sum(id, *outcome)}
        connection.execute(update(RUNS).where(RUNS.c.id == id).values(**sums))
    for id, engine in connection.execute(select(RESULTS.c.id, RESULTS.c.engine)).all():
        place = (RESULTS.c.id == id) & (RESULTS.c.engine == engine)
        row = connection.execute(select(RESULTS.c.rows, RESULTS.c.head, RESULTS.c.data).where(place)).one()
        connection.execute(update(RESULTS).where(place).values(checksum=result_sum(id, engine, *row)))


def add_sums_of_facts(connection: Connection) -> None:
    """Give the facts of runs checksums."""
    columns = [column for column in RUN_FACTS.c if column.name != "checksum"]
    for row in connection.execute(select(*columns)).all():
        here = RUN_FACTS.c.run == row.run
        connection.execute(update(RUN_FACTS).where(here).values(checksum=facts_sum(row.run, row)))


def add_sums_of_owners(connection: Connection) -> None:
    """Give owners of runs and records, names, tags and notes checksums."""
    added: dict[Table, Callable[[Any], dict[str, str]]] = {
        OWNERS: lambda row: {"checksum": owner_sum(row.run, row.owner)},
        RUN_NOTES: lambda row: {"checksum": note_sum(row.run, row.owner, row.name, row.tags)},
        COMPARISON_NOTES: lambda row: {"checksum": comparison_sum(row.runs, row.owner, row.text)},
        RECORD_SHARES: lambda row: {"owner_sum": owner_sum(row.record, row.owner), "checksum": share_sum(row)},
    }
    for table, sums in added.items():
        keys = list(table.primary_key)
        columns = [column for column in table.c if column.name not in ("checksum", "owner_sum")]
        for row in connection.execute(select(*columns)).all():
            here = [key == getattr(row, key.name) for key in keys]
            connection.execute(update(table).where(*here).values(**sums(row)))


#: SQL for SQLite, whose types are translated for other databases, and functions for what SQL cannot do.
MIGRATIONS: tuple[tuple[str | Callable[[Connection], None], ...], ...] = (
    (
        """CREATE TABLE runs (
            id TEXT PRIMARY KEY,
            spec TEXT NOT NULL,
            title TEXT NOT NULL,
            status TEXT NOT NULL,
            error TEXT,
            summary TEXT,
            engine TEXT NOT NULL,
            created REAL NOT NULL,
            pinned INTEGER NOT NULL DEFAULT 0
        )""",
        "CREATE INDEX runs_created ON runs (created)",
        """CREATE TABLE results (
            id TEXT NOT NULL,
            engine TEXT NOT NULL,
            used REAL NOT NULL,
            size INTEGER NOT NULL,
            rows INTEGER NOT NULL,
            head TEXT NOT NULL,
            data BLOB NOT NULL,
            PRIMARY KEY (id, engine)
        )""",
        "CREATE INDEX results_used ON results (used, size)",
    ),
    (
        "ALTER TABLE runs ADD COLUMN spec_sum TEXT",
        "ALTER TABLE runs ADD COLUMN outcome_sum TEXT",
        "ALTER TABLE results ADD COLUMN checksum TEXT",
        "CREATE TABLE owners (run TEXT NOT NULL, owner TEXT NOT NULL, PRIMARY KEY (run, owner))",
        "CREATE INDEX owners_owner ON owners (owner)",
        add_checksums,
    ),
    (
        """CREATE TABLE records (
            id TEXT PRIMARY KEY,
            size INTEGER NOT NULL,
            created REAL NOT NULL,
            data BLOB NOT NULL
        )""",
        """CREATE TABLE record_shares (
            record TEXT NOT NULL,
            owner TEXT NOT NULL,
            name TEXT NOT NULL,
            plant TEXT,
            mapping TEXT,
            changed REAL NOT NULL,
            PRIMARY KEY (record, owner)
        )""",
        "CREATE INDEX record_shares_owner ON record_shares (owner)",
    ),
    (
        """CREATE TABLE plants (
            owner TEXT NOT NULL,
            id TEXT NOT NULL,
            version INTEGER NOT NULL,
            title TEXT NOT NULL,
            format TEXT NOT NULL,
            faults INTEGER NOT NULL,
            ready INTEGER NOT NULL,
            text TEXT NOT NULL,
            saved REAL NOT NULL,
            removed REAL,
            checksum TEXT NOT NULL,
            PRIMARY KEY (owner, id, version)
        )""",
    ),
    (
        "ALTER TABLE runs ADD COLUMN removed REAL",
        "CREATE INDEX runs_listed ON runs (removed, created, id, pinned)",
        """CREATE TABLE run_facts (
            run TEXT PRIMARY KEY,
            experiment TEXT NOT NULL,
            kind TEXT NOT NULL,
            rmse REAL,
            delay REAL,
            false_alarms INTEGER,
            words TEXT NOT NULL,
            numbers TEXT NOT NULL,
            changes TEXT NOT NULL,
            shown TEXT NOT NULL
        )""",
        """CREATE TABLE run_notes (
            run TEXT NOT NULL,
            owner TEXT NOT NULL,
            name TEXT NOT NULL,
            tags TEXT NOT NULL,
            removed REAL,
            PRIMARY KEY (run, owner)
        )""",
    ),
    (
        """CREATE TABLE comparison_notes (
            runs TEXT NOT NULL,
            owner TEXT NOT NULL,
            text TEXT NOT NULL,
            PRIMARY KEY (runs, owner)
        )""",
    ),
    (
        "ALTER TABLE run_facts ADD COLUMN checksum TEXT",
        add_sums_of_facts,
    ),
    (
        """CREATE TABLE lessons (
            owner TEXT NOT NULL,
            id TEXT NOT NULL,
            version INTEGER NOT NULL,
            title TEXT NOT NULL,
            format TEXT NOT NULL,
            faults INTEGER NOT NULL,
            ready INTEGER NOT NULL,
            text TEXT NOT NULL,
            saved REAL NOT NULL,
            removed REAL,
            checksum TEXT NOT NULL,
            PRIMARY KEY (owner, id, version)
        )""",
    ),
    (
        "ALTER TABLE owners ADD COLUMN checksum TEXT",
        "ALTER TABLE run_notes ADD COLUMN checksum TEXT",
        "ALTER TABLE comparison_notes ADD COLUMN checksum TEXT",
        "ALTER TABLE record_shares ADD COLUMN owner_sum TEXT",
        "ALTER TABLE record_shares ADD COLUMN checksum TEXT",
        add_sums_of_owners,
    ),
)
