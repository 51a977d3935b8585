"""Workers that end with the test, and the outcome of their computations."""

from collections.abc import Callable, Iterator

import pytest

from thetascope.api.http.services import PRELOADED
from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers
from thetascope.runs.workers.process import preload

WIDE = Limits(60.0, 60.0, 1 << 30)
TIMEOUT = 60


@pytest.fixture
def start() -> Iterator[Callable[..., Workers]]:
    preload(PRELOADED)  # as for the service: the server that all workers of this process are copies of starts once
    running: list[Workers] = []

    def start_one(limits: Limits = WIDE, places: int = 1, queue: int = 8) -> Workers:
        running.append(Workers(places, limits, queue))
        return running[-1]

    yield start_one
    for workers in running:
        workers.close()


def outcome(computation) -> object:
    """Return the value or the exception of a computation."""
    return computation.result.exception(TIMEOUT) or computation.result.result()
