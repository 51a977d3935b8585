"""The clock of a session, with a time that the test controls."""

from math import inf

from hypothesis import given
from hypothesis import strategies as st

from thetascope.live.room.playback_clock import FRAME, MeasuredSpeed, MinimumInterval, PlaybackClock, RateLimiter
from thetascope.live.room.room_state import RoomMachine


def clock(record: float) -> PlaybackClock:
    """Return the clock of a paused room."""
    return PlaybackClock(record, RoomMachine())


TIMES = st.lists(st.floats(0.001, 2.0), min_size=1, max_size=30)


@given(TIMES, st.sampled_from([0.1, 1.0, 7.3, 1000.0, 10_000.0]), st.sampled_from([0.001, 0.01, 0.25]))
def test_rows_follow_the_speed_for_any_polling(spacings, speed, record):
    """After T seconds T · speed / record rows are due, and never fewer than before."""
    playback, now, before = clock(record), 0.0, 0
    playback.set_speed(speed, 0, 0.0)
    playback.play(0, 0.0)
    for spacing in spacings:
        now += spacing
        assert playback.due(now) >= before
        before = playback.due(now)
    assert abs(before - now * speed / record) <= 1 + 1e-6


def test_a_change_of_speed_neither_jumps_nor_loses_part_of_a_row():
    """Half a row at one speed and half a row at another are a row."""
    playback = clock(0.1)
    playback.play(0, 0.0)
    for i in range(10):
        playback.set_speed([0.5, 2.0][i % 2], 0, 0.05 * i)
    expected = sum([0.5, 2.0][i % 2] * 0.05 for i in range(10)) / 0.1
    assert playback.due(0.5) == int(expected + 1e-6)


def test_a_clock_that_is_set_back_does_not_catch_up():
    """Set back to the available rows, it continues from there at its speed."""
    playback = clock(0.01)
    playback.play(0, 0.0)
    assert playback.due(10.0) == 1000
    playback.anchor(300, 10.0)
    assert playback.due(10.5) == 350


def test_a_pause_takes_no_time():
    """While paused no row is due; playing continues where it stopped."""
    playback = clock(0.01)
    playback.play(0, 0.0)
    assert playback.due(1.0) == 100
    playback.pause()
    assert playback.due(50.0) == 0 and playback.next(100, 50.0, 50.0) is None
    playback.play(100, 60.0)
    assert playback.due(60.5) == 150


def test_a_step_is_due_immediately_and_ends_at_its_row():
    """Playing stops; the rows are due whatever the time."""
    playback = clock(0.01)
    playback.play(0, 0.0)
    playback.step(0, 70)
    assert (playback.due(0.0), playback.target) == (70, 70)
    assert not playback.reached(69) and playback.target == 70
    assert playback.reached(70) and playback.target is None


def test_as_fast_as_possible_everything_is_due():
    """There is no limit."""
    playback = clock(0.01)
    playback.play(0, 0.0)
    playback.set_speed(None, 0, 0.0)
    assert playback.due(0.0) == inf
    assert playback.next(5, 1.0, 1.0) == 1.0 + FRAME


@given(st.lists(st.floats(0, 0.2), min_size=1, max_size=50))
def test_frames_keep_their_beat_whatever_the_delays(delays):
    """Every frame is due at a whole number of frames from the first, in the future, and none is far away."""
    playback = clock(0.001)
    playback.play(0, 0.0)
    at = 0.0
    for delay in delays:
        now = at + delay
        following = playback.next(playback.due(now), at, now)
        assert now - 1e-9 <= following <= now + FRAME + 1e-9
        assert abs((following - at) / FRAME - round((following - at) / FRAME)) < 1e-6
        at = following


def test_with_rare_rows_the_next_one_sets_the_time():
    """One row per second needs no thirty ticks."""
    playback = clock(1.0)
    playback.play(3, 0.0)
    assert playback.next(3, 0.0, 0.0) == 1.0
    assert playback.due(1.0) == 4


def test_the_rate_is_measured():
    """Simulated seconds over real ones."""
    rate = MeasuredSpeed()
    rate.start(100, 5.0)
    assert rate.value is None
    assert abs(rate.update(350, 6.0, 0.01) - 2.5) < 1e-12


def test_a_minimum_interval_passes_one_at_a_time():
    """The first immediately, the next after the interval."""
    now = [0.0]
    spacing = MinimumInterval(0.1, lambda: now[0])
    taken = []
    for now[0] in (0.0, 0.05, 0.11, 0.15, 0.22):
        taken.append(spacing.take())
    assert taken == [True, False, True, False, True]


@given(st.lists(st.floats(0.0, 0.05), min_size=1, max_size=50))
def test_a_rate_limiter_delays_only_crowds(spacings):
    """Two pass at least the interval apart, in order; one that comes much later does not wait."""
    turnstile, now, last = RateLimiter(0.01), 0.0, -inf
    for spacing in spacings:
        now += spacing
        passes = now + turnstile.wait(now)
        assert passes >= max(now, last + 0.01 - 1e-9)
        last = passes
    assert turnstile.wait(last + 1.0) == 0
