"""Messages that wait for a viewer: texts in order, the newest status, and samples as a row number."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.live.wire.outbox import MAX_CHARACTERS, MAX_TEXTS, Outbox, Overflow, Span

TEXTS = st.lists(st.tuples(st.sampled_from([None, None, "status", "spec"]), st.booleans()), max_size=60)


@given(TEXTS)
def test_events_arrive_once_and_in_order_and_of_each_status_the_newest(puts):
    """However the viewer reads: no event is lost, and a status is never older than an earlier one."""
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


def test_unread_statuses_take_no_memory():
    """A million of them are one."""
    outbox = Outbox()
    for number in range(10_000):
        outbox.put(str(number), "status")
    assert outbox.text() == "9999" and outbox.text() is None


def test_a_viewer_with_too_many_unread_events_overflows():
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
    """However slowly it reads, and for any size of frame, it gets every row once."""
    outbox, rows, got = Outbox(), 0, []
    for more, takes in [*steps, *[(0, True)] * 3000]:
        rows += more
        span = outbox.span(rows, most) if takes else None
        if span is not None:
            assert 0 < span.last - span.first <= most
            got.append(span)
            outbox.row = span.last
    assert [row for span in got for row in range(span.first, span.last)] == list(range(rows))


def test_missed_rows_are_one_frame():
    """Ten unread frames are one span."""
    outbox = Outbox(30)
    assert outbox.span(60, 1000) == Span(30, 60)


def test_a_viewer_too_far_behind_skips_rows_and_learns_which():
    """It keeps half of the allowed backlog, and does not skip again immediately."""
    outbox = Outbox(100)
    assert outbox.jump(1100, 1000) is None
    assert outbox.jump(1101, 1000) == Span(100, 601)
    assert outbox.row == 601 and outbox.jump(1500, 1000) is None


def test_rows_that_are_no_longer_kept_are_missed():
    """A viewer that requests them begins with the oldest available one."""
    outbox = Outbox(0)
    assert outbox.jump(500, 1000, oldest=200) == Span(0, 200)


def test_a_rewind_takes_a_viewer_back_but_never_forward():
    """Rows from there on are sent again."""
    outbox = Outbox(100)
    outbox.rewind_to(40)
    assert outbox.row == 40
    outbox.rewind_to(70)
    assert outbox.row == 40
