"""All sessions of the service together."""

import asyncio

import numpy as np
from pydantic import TypeAdapter

from tests.live.stage import apart
from tests.runs.samples import spec
from thetascope import library
from thetascope.live.scheduling.hub import Hub, share
from thetascope.live.session.session import Session
from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers
from thetascope.settings import Settings
from thetascope_schemas.service.session import ClientMessage

COMMAND = TypeAdapter(ClientMessage)


def test_sessions_on_the_same_experiment_do_not_know_of_each_other(tmp_path):
    """Each has the numbers of a session opened alone, and a command to one does not affect another."""

    async def scenario() -> None:
        hub = Hub(Settings(data=tmp_path), Workers(1, Limits(20.0, 20.0, 1 << 30), 8))
        given = library.resolve(spec(evaluate=0.01))
        try:
            one, two = [await hub.create(lambda: given, play=False) for _ in range(2)]
            fault = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}
            one.session.handle(COMMAND.validate_python({"type": "inject", "id": 1, "fault": fault}))
            one.session.advance(50)
            third = await hub.create(lambda: given, play=False, t=0.5)
            alone = Session(given)
            alone.advance(51)
            for room, rows in ((two, 1), (third, 51)):
                assert room.session.row == rows and len(room.session.spec.faults) == len(given.faults)
                room.session.advance(51 - rows)
                np.testing.assert_array_equal(room.session.rows(0, 51), alone.rows(0, 51))
            assert not np.array_equal(one.session.rows(0, 51), alone.rows(0, 51))
        finally:
            hub.stop()

    apart(scenario())


def test_sessions_that_are_opened_concurrently_are_all_opened(tmp_path):
    """Each of many concurrent requests gets a session of its own."""

    async def scenario() -> None:
        given = library.resolve(spec(evaluate=0.01))
        hub = Hub(Settings(data=tmp_path), Workers(1, Limits(20.0, 20.0, 1 << 30), 8))
        try:
            rooms = await asyncio.gather(*(hub.create(lambda: given, play=False) for _ in range(12)))
            assert len({room.id for room in rooms}) == len(hub) == 12
            assert len({id(room.session) for room in rooms}) == 12
        finally:
            hub.stop()

    apart(scenario())


def test_many_sessions_share_the_memory_for_their_pasts():
    """A few have all of it each; many together keep no more."""
    assert share(1000, 1) == share(1000, 10) == 1000
    assert all(n * share(1000, n) <= 40_000 for n in (40, 100, 400))
    assert share(1000, 400) < share(1000, 100) < 1000
