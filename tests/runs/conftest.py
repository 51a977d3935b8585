"""A run manager over a store in the test's own folder; called again, it is the next start of the service."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from thetascope.api.http.services import Services
from thetascope.runs.jobs.manager import RunManager
from thetascope.settings import load


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., RunManager]]:
    """Start a manager with changed settings; the one before is stopped first."""
    running: list[Services] = []

    def start_one(**changes: object) -> RunManager:
        if running:
            running.pop().close()
        running.append(Services.start(load({}, data=tmp_path, **changes)))
        return running[0].runs

    yield start_one
    for services in running:
        services.close()
