"""How far a session computes ahead, according to the cost of its rows."""

from itertools import pairwise

import pytest

from thetascope.live.room.playback_clock import FRAME, PlaybackClock
from thetascope.live.room.prefetch_plan import LIGHT, SLICE, PrefetchPlan
from thetascope.live.room.room_state import RoomMachine

MOST = 20_000  # rows of one frame


def playing(speed: float) -> PlaybackClock:
    playback = PlaybackClock(0.01, RoomMachine())
    playback.set_speed(speed, 0, 0.0)
    playback.play(0, 0.0)
    return playback


def frames(
    playback: PlaybackClock, call: float, row: float, count: int = 60
) -> list[tuple[int, list[tuple[int, bool]]]]:
    """Return for each frame the rows available for it, and the batches computed before it: (rows, in a thread)."""
    ahead, left, planned = PrefetchPlan(), 0, []
    for _ in range(count):
        pieces = []
        while not pieces or ahead.behind(playback, left):
            wanted = ahead.wanted(playback, left, MOST)
            if wanted is None:
                break
            pieces.append(wanted)
            left += wanted[0]
            ahead.measured(wanted[0], call + row * wanted[0])
        planned.append((left, pieces))
        left -= min(left, playback.rows_in(FRAME))
    return planned


@pytest.mark.parametrize("speed", [0.1, 1, 20, 200, 1000, 10_000])
@pytest.mark.parametrize(("call", "row"), [(2e-4, 1e-6), (1e-3, 5e-6), (5e-3, 1e-5), (2e-4, 2e-4)])
def test_each_frame_has_its_rows_whatever_they_cost(speed, call, row):
    """Even if the rows of one frame take longer than a batch may."""
    playback = playing(speed)
    assert all(left >= playback.rows_in(FRAME) for left, _ in frames(playback, call, row))


@pytest.mark.parametrize(("call", "row"), [(2e-4, 1e-6), (1e-3, 5e-6), (5e-3, 1e-5), (2e-4, 2e-4)])
def test_the_event_loop_is_blocked_for_milliseconds_only(call, row):
    """At most two frames of rows on the loop and a slice in the thread, once the cost of rows is known."""
    for _, pieces in frames(playing(200), call, row)[8:]:
        for rows, thread in pieces:
            assert call + rows * row <= (1.5 * SLICE + call if thread else 2 * LIGHT + call)


def test_batches_grow_step_by_step_after_a_single_call(monkeypatch):
    """One call does not separate its own cost from that of its rows: the next batches grow step by step."""
    pieces = [rows for _, pieces in frames(playing(200), 0.011, 6e-6, count=10) for rows, _ in pieces]
    assert all(later <= 4 * max(earlier, 1000) for earlier, later in pairwise(pieces))


def test_equal_short_calls_do_not_keep_the_batches_short():
    """If every call had few rows their cost cannot be separated; batches grow to the permitted length."""
    playback, ahead = playing(1), PrefetchPlan()
    for _ in range(40):
        ahead.measured(110, 1e-3)
    frame = playback.rows_in(FRAME)
    rows, thread = ahead.wanted(playback, frame, MOST)
    assert not thread and rows >= 4 * 110 - frame
