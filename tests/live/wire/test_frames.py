"""Frames as bytes, the rows computed ahead, and the numbers of frames."""

import struct

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from thetascope.live.wire.frames import FrameBuffer, FrameNumbers, as_float32, encode_frame
from thetascope_schemas.service.session import HEADER


def test_a_frame_is_a_header_and_columns_of_float32():
    """Little endian, column after column."""
    rows = np.array([[1.5, 2.5, np.nan], [-1e-3, 0.0, np.inf]], "<f4")
    data = encode_frame(7, 2, 1 << 40, rows)
    assert struct.unpack_from(HEADER, data) == (7, 2, 1 << 40, 3, 2)
    assert data[24:] == struct.pack("<6f", 1.5, 2.5, np.nan, -1e-3, 0.0, np.inf)


def test_numbers_beyond_float32_are_infinite_without_a_warning():
    """A diverging plant is drawn up to its divergence."""
    assert as_float32(np.array([[1e300, -1e300, 1.0]])).tolist() == [[np.inf, -np.inf, 1.0]]


@given(st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), min_size=1, max_size=20))
def test_rows_ahead_are_those_that_were_added(steps):
    """However rows are grouped and however many are dropped: rows that are returned are right, others are missing."""
    ahead, end = FrameBuffer(0, 2), 0
    for count, keep in steps:
        piece = np.arange(end, end + count, dtype=float)
        ahead.append(np.array([piece, -piece]), keep)
        end += count
        assert ahead.end == end and ahead.first <= min(end, max(keep, ahead.first))
        taken = ahead.take(ahead.first, end)
        assert (taken == np.array([np.arange(ahead.first, end), -np.arange(ahead.first, end)])).all()
    assert ahead.take(end, end + 1) is None
    assert ahead.first == 0 or ahead.take(ahead.first - 1, end) is None


@given(st.lists(st.integers(1, 5), min_size=1, max_size=60), st.integers(0, 59))
def test_the_number_of_the_last_frame_gives_the_rows_received(counts, change):
    """Frames of the present epoch are known, earlier ones are not."""
    numbers, end, known = FrameNumbers(), 0, {}
    for place, count in enumerate(counts):
        if place == change:
            numbers.new_epoch()
            known = {}
        end += count
        known[numbers.add(end)] = end
    assert numbers.last == len(counts)
    for number in range(len(counts) + 2):
        assert numbers.rows_after(number) == known.get(number)
    for rows in range(end + 1):
        assert numbers.number_at(rows) == max((n for n, e in known.items() if e <= rows), default=0)


def test_the_memory_for_frame_numbers_is_limited():
    """In a session that plays for a day, the last frames are known."""
    numbers = FrameNumbers()
    for end in range(1, 50_000):
        numbers.add(end)
    assert numbers.rows_after(49_999) == 49_999
    assert numbers.rows_after(49_999 - FrameNumbers.KEPT + 1) is not None
    assert numbers.rows_after(1) is None
    assert len(numbers._ends) <= 2 * FrameNumbers.KEPT
