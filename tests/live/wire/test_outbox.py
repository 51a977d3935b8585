"""What waits for a viewer: texts in order, the newest status, and samples as one number."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.live.wire.outbox import MAX_CHARACTERS, MAX_TEXTS, Outbox, Overflow, Span

TEXTS = st.lists(st.tuples(st.sampled_from([None, None, "status", "spec"]), st.booleans()), max_size=60)


@given(TEXTS)
def test_events_arrive_once_and_in_order_and_of_each_status_the_newest(puts):
    """Whatever the viewer takes in between: no event is lost, and a status is never older than one that came before."""
    outbox, got = Outbox(), []
    for number, (key, takes) in enumerate(puts):
        outbox.put(f"{key}:{number}", key)
        if takes:
            got.append(outbox.text())
    while (text := outbox.text()) is not None:
        got.append(text)
    sent = [f"{key}:{number}" for number, (key, _) in enumerate(puts)]
    for key in ("None", "status", "spec"):
        mine = [text for text in got if text.startswith(key)]
        all_of_key = [text for text in sent if text.startswith(key)]
        if key == "None":
            assert mine == all_of_key
        else:
            assert [t for t in all_of_key if t in mine] == mine
            assert mine[-1:] == all_of_key[-1:]


def test_a_status_that_nobody_takes_takes_no_room():
    """A million of them are one."""
    outbox = Outbox()
    for number in range(10_000):
        outbox.put(str(number), "status")
    assert outbox.text() == "9999" and outbox.text() is None


def test_a_viewer_that_lets_events_pile_up_is_given_up():
    """By their number, and by their size."""
    outbox = Outbox()
    with pytest.raises(Overflow):
        for _ in range(MAX_TEXTS + 1):
            outbox.put("event")
    large = Outbox()
    with pytest.raises(Overflow):
        for _ in range(20):
            large.put("x" * (MAX_CHARACTERS // 10))


@given(st.lists(st.tuples(st.integers(0, 40), st.booleans()), max_size=60), st.integers(1, 50))
def test_the_spans_of_a_viewer_join_without_a_gap(steps, most):
    """However slowly it takes them, and however large a frame may be, it gets every row once."""
    outbox, rows, got = Outbox(), 0, []
    for more, takes in [*steps, *[(0, True)] * 3000]:
        rows += more
        span = outbox.span(rows, most) if takes else None
        if span is not None:
            assert 0 < span.last - span.first <= most
            got.append(span)
            outbox.row = span.last
    assert [row for span in got for row in range(span.first, span.last)] == list(range(rows))


def test_what_a_slow_viewer_missed_is_one_frame():
    """Ten frames that it did not take are one span."""
    outbox = Outbox(30)
    assert outbox.span(60, 1000) == Span(30, 60)


def test_a_viewer_too_far_behind_jumps_and_is_told_what_it_misses():
    """It keeps half of the allowed backlog, and does not jump again immediately."""
    outbox = Outbox(100)
    assert outbox.jump(1100, 1000) is None
    assert outbox.jump(1101, 1000) == Span(100, 601)
    assert outbox.row == 601 and outbox.jump(1500, 1000) is None


def test_rows_that_are_no_longer_kept_are_missed():
    """A viewer that asks for them begins with the oldest there is."""
    outbox = Outbox(0)
    assert outbox.jump(500, 1000, oldest=200) == Span(0, 200)


def test_a_rewind_takes_a_viewer_back_but_never_forward():
    """Rows from there on are sent again."""
    outbox = Outbox(100)
    outbox.rewind_to(40)
    assert outbox.row == 40
    outbox.rewind_to(70)
    assert outbox.row == 40
