"""The end of sessions: their viewers, forks and memory afterwards."""

import weakref

import numpy as np

from tests.live.stage import Stage, same, staged
from thetascope.live.session.session import Session
from thetascope.messages import Message
from thetascope_schemas.service.session import CLOSE_ENDED

ENDED = Message("session.close.ended")


def test_a_session_ends_at_its_limit():
    """It stops, reports its end, refuses to play, and can go back."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(2.0)
        assert stage.room.shown == 120 and page.of("status")[-1]["ended"] is True
        assert (await stage.say(page, "play"))["type"] == "refused"
        assert (await stage.say(page, "seek", t=0.5))["type"] == "ack"
        assert (await stage.say(page, "play"))["type"] == "ack"
        await stage.go(0.2)
        assert 65 <= stage.room.shown <= 75

    staged(scenario, limit=120)


def test_closing_ends_every_connection_with_its_reason():
    """No further tick is scheduled."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        stage.room.close(CLOSE_ENDED, ENDED)
        assert page.viewer.closing == (CLOSE_ENDED, ENDED) and page.viewer.closed.is_set()
        assert stage.room.tick(1.0) is None

    staged(scenario)


def test_a_fork_has_the_past_and_a_future_of_its_own():
    """It continues from an earlier row; the first session is unaffected."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(2.0)
        fork: Session = await stage.room.fork(0.8)
        assert fork.row == 81
        await stage.go(0.2)
        ours = page.rows()
        np.testing.assert_array_equal(fork.rows(0, 81), ours[:, :81])
        np.testing.assert_array_equal(fork.advance(20).astype("<f4"), ours[:, 81:101])  # as long as nobody acts
        same(page.rows(), stage.session.spec, page.texts[0]["columns"])

    staged(scenario)


def test_a_closed_session_frees_its_past():
    """Immediately, although the room object may live longer; a fork keeps the common rows."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(2.0)
        fork = await stage.room.fork(1.0)
        kept = fork.rows(0, 100).copy()
        past = weakref.ref(stage.session.history)
        stage.room.close(CLOSE_ENDED, ENDED)
        assert past() is None and stage.session.history.end == 0 and stage.session.log == ()
        np.testing.assert_array_equal(fork.rows(0, 100), kept)
        fork.advance(10)
        assert fork.row == 111

    staged(scenario)
