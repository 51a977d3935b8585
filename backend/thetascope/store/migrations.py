"""The tables as a list of migrations: entry n upgrades a file from version n to n + 1. Entries are never edited."""

#: Specs are kept. Results can be recomputed and are deleted to free space, so they are a separate table. The blob is
#: the last column of its row, so that reading the other columns does not read it.
MIGRATIONS: tuple[tuple[str, ...], ...] = (
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
)
