"""A store in the test's own folder."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from thetascope.store import Database, RunStore


@pytest.fixture
def open_store(tmp_path: Path) -> Iterator[Callable[..., RunStore]]:
    """Return a function that opens the same file at each call, as several processes would."""
    opened: list[Database] = []

    def open_one(limit: int = 10**9, timeout: float = 10.0) -> RunStore:
        opened.append(Database(tmp_path / "data" / "runs.sqlite", timeout))
        return RunStore(opened[-1], limit)

    yield open_one
    for database in opened:
        database.close()
