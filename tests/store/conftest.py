"""A store of the test's own, in a file and in a PostgreSQL database."""

from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import quote

import pytest

from tests.store.postgresql_cluster import cluster
from thetascope.store import Database, RunStore


@pytest.fixture(scope="session")
def server() -> Iterator[str]:
    """Return the URL of a PostgreSQL server."""
    with cluster() as url:
        yield url


@pytest.fixture
def postgresql(server: str, request: pytest.FixtureRequest) -> str:
    """Return the URL of an empty store on the server: a schema of the test's own."""
    import psycopg

    schema = f"test_{abs(hash(request.node.nodeid))}"
    with psycopg.connect(server, autocommit=True) as connection:
        connection.execute(f"CREATE SCHEMA {schema}")
    return f"{server}&options={quote(f'-c search_path={schema}')}"


@pytest.fixture(params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Return the path or URL of an empty store."""
    if request.param == "postgresql":
        return request.getfixturevalue("postgresql")
    return str(tmp_path / "data" / "runs.sqlite")


@pytest.fixture
def open_store(place: str) -> Iterator[Callable[..., RunStore]]:
    """Return a function that opens the same store at each call, as several processes would."""
    opened: list[Database] = []

    def open_one(limit: int = 10**9, **options: object) -> RunStore:
        opened.append(Database(place, **options))
        return RunStore(opened[-1], limit)

    yield open_one
    for database in opened:
        database.close()
