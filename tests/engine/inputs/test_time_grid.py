"""The time grid: exact coverage, no step across a break, rows at their times, for any division into blocks."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from thetascope.engine.compiler.jit import NEVER
from thetascope.engine.inputs.time_grid import Grid, cut, sort_out

H = 0.004
spans = st.tuples(st.integers(0, 500), st.integers(1, 40)).map(lambda s: (s[0], s[0] + s[1]))
on_grid = st.integers(0, 600).map(lambda k: k * H)
anywhere = st.floats(0.0, 2.4, allow_nan=False)
breaks = st.lists(on_grid | anywhere, max_size=12).map(np.array)


def recorded(grid: Grid, every: int) -> list[int]:
    """Return the numbers of the steps after which the kernel records, by its own counting."""
    rows, done = [], 0
    for steps, first in zip(grid.segments.steps.tolist(), grid.segments.first.tolist(), strict=True):
        left = first
        for _ in range(steps):
            done, left = done + 1, left - 1
            if left == 0:
                rows.append(done)
                left = every
    return rows


@given(span=spans, breaks=breaks, every=st.integers(1, 7), substeps=st.integers(1, 3))
def test_steps_cover_the_span_without_gap_or_overlap(span, breaks, every: int, substeps: int):
    """Each step begins where the last ended, the first at the beginning and the last at the end of the span."""
    grid = cut(*span, H, breaks, every, substeps)
    edges = [grid.start[0], *grid.end]
    np.testing.assert_allclose(edges[0], span[0] * H, rtol=0, atol=1e-12)
    np.testing.assert_allclose(edges[-1], span[1] * H, rtol=0, atol=1e-12)
    np.testing.assert_allclose(grid.start, edges[:-1], rtol=0, atol=1e-12)
    assert (grid.end > grid.start).all() and (grid.end - grid.start).max() < H / substeps * (1 + 1e-9)


@given(span=spans, breaks=breaks, substeps=st.integers(1, 3))
def test_no_step_goes_across_a_break(span, breaks, substeps: int):
    """Every break inside the span is an end of a step, and of a segment."""
    grid = cut(*span, H, breaks, 1, substeps)
    first = np.concatenate([[0], np.cumsum(grid.segments.steps)[:-1]])
    opening = grid.start[first]
    for time in breaks[(breaks > span[0] * H + 1e-8) & (breaks < span[1] * H - 1e-8)]:
        assert np.abs(opening - time).min() < 1.1e-6 * H


@given(span=spans, breaks=breaks, every=st.integers(1, 7), substeps=st.integers(1, 3))
def test_rows_fall_on_whole_multiples_of_every(span, breaks, every: int, substeps: int):
    """The base steps every, 2·every, … that end within the span are recorded once each, however steps are divided."""
    grid = cut(*span, H, breaks, every, substeps)
    times = [grid.end[i - 1] for i in recorded(grid, every * substeps)]
    due = [k * H for k in range(span[0] + 1, span[1] + 1) if k % every == 0]
    np.testing.assert_allclose(times, due, rtol=0, atol=1e-12)


@given(span=spans, breaks=breaks, substeps=st.integers(1, 3))
def test_base_has_the_first_step_of_each_base_step(span, breaks, substeps: int):
    """Its last entry is the number of steps."""
    grid = cut(*span, H, breaks, 1, substeps)
    assert len(grid.base) == span[1] - span[0] + 1 and grid.base[-1] == len(grid.start)
    np.testing.assert_allclose(grid.start[grid.base[:-1]], np.arange(*span) * H, rtol=0, atol=1e-12)


@given(span=spans, breaks=breaks, where=st.floats(0, 1))
def test_two_spans_have_the_times_of_one(span, breaks, where: float):
    """Dividing a span changes no bit of any step's time: live sessions and runs use the same signals."""
    middle = span[0] + round(where * (span[1] - span[0]))
    whole = cut(*span, H, breaks, 1, 1)
    parts = [cut(a, b, H, breaks, 1, 1) for a, b in ((span[0], middle), (middle, span[1])) if b > a]
    for name in ("start", "end", "anchor"):
        np.testing.assert_array_equal(np.concatenate([getattr(p, name) for p in parts]), getattr(whole, name))


def test_several_breaks_in_one_step_make_as_many_pieces():
    """Two breaks inside step 3 make three pieces; the row at its end is recorded once."""
    grid = cut(0, 5, 0.1, np.array([0.33, 0.37, 0.37]), 1, 1)
    np.testing.assert_allclose(grid.start, [0, 0.1, 0.2, 0.3, 0.33, 0.37, 0.4], atol=1e-15)
    assert recorded(grid, 1) == [1, 2, 3, 6, 7]


def test_a_break_that_rounding_moved_is_on_the_grid():
    """0.1 + 0.2 counts as the grid point 0.3: there is no step of 4e-17 s."""
    marks, off = sort_out(np.array([0.1 + 0.2, 0.35]), 0.1)
    assert marks.tolist() == [3]
    np.testing.assert_allclose(off, [3.5])
    assert (cut(0, 5, 0.1, np.array([0.1 + 0.2]), 1, 1).end > 0).sum() == 5


def test_a_span_without_rows_records_nothing():
    """A segment in which no row is due is marked as such."""
    grid = cut(0, 4, 0.1, np.empty(0), 10, 1)
    assert grid.segments.first.tolist() == [NEVER]
