"""Viewers that are slow, lose their connection, or join late, with a clock that the test controls."""

import numpy as np
import pytest

from tests.live.stage import Stage, kinds, settle, staged
from thetascope.live.room.room import RoomFull
from thetascope.live.wire.outbox import MAX_TEXTS
from thetascope_schemas.service.session import CLOSE_SLOW

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def test_a_blocked_viewer_delays_no_other_and_then_gets_one_frame():
    """Session and other viewer continue; missed rows come as one frame, all events in order, one status."""

    async def scenario(stage: Stage) -> None:
        page, slow = await stage.connect(), await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        slow.open.clear()
        had = len(slow.frames)
        for _ in range(4):
            await stage.say(page, "inject", fault=FAULT)
            await stage.go(0.5)
        assert page.rows().shape[1] >= 245 and len(slow.frames) == had
        slow.open.set()
        await settle()
        assert len(slow.frames) - had <= 2, "the one it was given while it hung, and one for all it missed"
        np.testing.assert_array_equal(slow.rows(), page.rows())
        assert kinds(slow.of("event")) == kinds(page.of("event"))
        assert slow.of("status")[-1] == page.of("status")[-1] and len(slow.of("status")) < len(page.of("status"))
        assert slow.frames[-1].sequence == page.frames[-1].sequence

    staged(scenario)


def test_a_viewer_far_behind_skips_rows_and_learns_which():
    """It never waits for old rows, and the server need not keep them."""

    async def scenario(stage: Stage) -> None:
        page, slow = await stage.connect(), await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        slow.open.clear()
        await stage.go(5.0)
        slow.open.set()
        await stage.go(0.2)
        (jump,) = slow.of("jump")
        following = next(frame for frame in slow.frames if frame.first >= jump["row"])
        assert following.first == jump["row"]
        assert slow.frames[-1].end == page.frames[-1].end
        before = max(frame.end for frame in slow.frames if frame.end <= jump["first"])
        assert before == jump["first"]
        columns = following.samples.shape[0]
        assert (jump["row"] - jump["first"]) * 4 * columns > 10_000 / 2

    staged(scenario, backlog=10_000)


def test_a_viewer_with_too_many_unread_events_is_closed():
    """With the code for it; the session continues."""

    async def scenario(stage: Stage) -> None:
        page, dead = await stage.connect(), await stage.connect()
        dead.open.clear()
        for _ in range(MAX_TEXTS + 10):
            stage.room.commands.receive(dead.viewer, "{}", 1000)
        assert dead.viewer.closing[0] == CLOSE_SLOW
        stage.room.leave(dead.viewer)
        await stage.say(page, "play")
        await stage.go(0.5)
        assert page.rows().shape[1] >= 50

    staged(scenario)


def test_a_lost_connection_resumes_without_a_gap():
    """A viewer that names its last frame gets the rows after it, none twice;
    in the end it has those of one that stayed."""

    async def scenario(stage: Stage) -> None:
        page, lost = await stage.connect(), await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        stage.room.leave(lost.viewer)
        lost.viewer.close(1006, "lost")
        await settle()
        await stage.go(2.0)
        again = await stage.connect(after=lost.frames[-1].sequence)
        await stage.go(0.5)
        assert again.texts[0]["epoch"] == lost.texts[0]["epoch"]
        assert again.frames[0].first == lost.frames[-1].end
        lost.frames += again.frames
        np.testing.assert_array_equal(lost.rows(), page.rows())

    staged(scenario)


def test_after_a_rewind_the_whole_past_is_sent():
    """The epoch in hello differs from the viewer's; it gets all rows."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        known = page.frames[-1].sequence
        await stage.say(page, "seek", t=0.3)
        await stage.go(0.5)
        again = await stage.connect(after=known)
        assert again.texts[0]["epoch"] == 1 and again.frames[0].first == 0
        await stage.go(0.1)
        assert again.rows().shape == (page.frames[0].samples.shape[0], page.frames[-1].end)

    staged(scenario)


@pytest.mark.parametrize("after", [None, 0, 10**9])
def test_a_new_viewer_or_an_unknown_frame_gets_the_whole_past(after):
    """In frames of limited size."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "step", rows=20_000)
        await stage.go(2.0)
        late = await stage.connect(after=after)
        assert late.texts[0]["row"] == 20_001
        np.testing.assert_array_equal(late.rows(), page.rows())
        assert max(frame.samples.nbytes for frame in late.frames) <= 256 * 1024 and len(late.frames) > 3

    staged(scenario, backlog=1 << 24)


def test_a_slow_viewer_survives_a_rewind_and_new_columns():
    """Unsent rows are dropped or come in the new columns; in the end it has the rows of the others."""

    async def scenario(stage: Stage) -> None:
        page, slow = await stage.connect(), await stage.connect()
        await stage.say(page, "play")
        await stage.go(0.5)
        slow.open.clear()
        await stage.go(0.5)
        await stage.say(page, "seek", t=0.3)
        await stage.say(page, "add-observer", observer={"label": "other", "kind": "adaptive-kalman"})
        await stage.go(0.5)
        slow.open.set()
        await stage.go(0.2)
        late = await stage.connect()
        epoch = late.texts[0]["epoch"]
        mine = {
            f.first + i: f.samples[:, i] for f in slow.frames if f.epoch == epoch for i in range(f.samples.shape[1])
        }
        theirs = late.rows()
        assert min(mine) <= 30 and max(mine) == theirs.shape[1] - 1
        for row, values in mine.items():
            np.testing.assert_array_equal(values, theirs[:, row])

    staged(scenario)


def test_the_number_of_viewers_is_limited():
    """One more is refused; when one leaves, there is room again."""

    async def scenario(stage: Stage) -> None:
        first, _ = await stage.connect(), await stage.connect()
        with pytest.raises(RoomFull):
            await stage.connect()
        stage.room.leave(first.viewer)
        await stage.connect()
        assert stage.room.status().viewers == 2

    staged(scenario, viewers=2)


def test_frames_are_encoded_once_for_all(monkeypatch: pytest.MonkeyPatch):
    """Fifty viewers need one encoding per frame."""
    from thetascope.live.room import broadcast

    encoded = []
    honest = broadcast.encode_frame
    monkeypatch.setattr(broadcast, "encode_frame", lambda *given: encoded.append(1) or honest(*given))

    async def scenario(stage: Stage) -> None:
        pages = [await stage.connect() for _ in range(50)]
        await stage.say(pages[0], "play")
        encoded.clear()
        before = len(pages[-1].frames)
        await stage.go(1.0)
        assert len(pages[-1].frames) - before == len(encoded) > 25

    staged(scenario, viewers=50)


def test_a_session_keeps_a_bounded_past_and_late_viewers_learn_its_start():
    """It keeps its newest rows; a new viewer begins with the oldest of them; going further back still works."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "step", rows=100)
        await stage.go(1)
        before = page.rows_at(50)
        for _ in range(3):
            await stage.say(page, "step", rows=100_000)
            await stage.go(30)
        assert stage.room.shown == 300_101
        kept = stage.room.shown - stage.room.oldest
        assert 30_000 < kept < 160_000
        late = await stage.connect()
        (jump,) = late.of("jump")
        assert jump["first"] == 0 and late.frames[0].first == jump["row"] == stage.room.oldest
        assert (await stage.say(page, "seek", t=0.5))["row"] == 50
        await stage.say(page, "step", rows=10)
        await stage.go(1)
        assert stage.room.shown == 61, "the row at 0.5 s is shown, and ten more"
        np.testing.assert_array_equal(page.rows_at(50), before)

    staged(scenario, limit=400_000, backlog=1 << 24, past=40_000 * 4 * 9)


def test_a_session_without_viewers_sleeps_and_wakes_where_it_was():
    """After a minute time stops; the next viewer finds it playing from there."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        stage.room.leave(page.viewer)
        await stage.go(600.0)
        slept = stage.room.shown
        assert 5_900 < slept < 6_200
        again = await stage.connect()
        await stage.go(1.0)
        assert again.texts[0]["playing"] and 95 <= stage.room.shown - slept <= 105

    staged(scenario)
