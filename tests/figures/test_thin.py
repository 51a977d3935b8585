"""Decimation keeps the visible features, and typed arrays keep enough digits for a zoom."""

from base64 import b64decode

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from thetascope.figures import decimation

FINITE = st.floats(-1e6, 1e6, allow_nan=False)


def decoded(packed: dict) -> np.ndarray:
    return np.frombuffer(b64decode(packed["bdata"]), dtype="<" + packed["dtype"]).astype(float)


def test_short_series_stay_whole():
    """A series with few points is not decimated."""
    assert decimation.extremes(np.arange(decimation.LIMIT)) is None
    assert decimation.curve_extremes(np.arange(10.0), np.arange(10.0)) is None


def test_one_sample_spike_survives_a_million_rows():
    """A spike of a single sample in a million is among the 4000 points, at its own time."""
    y = np.sin(np.arange(1_000_000) / 1e5)
    y[654_321], y[123_456] = 9.0, -9.0
    rows = decimation.extremes(y)
    assert rows.size <= decimation.LIMIT + 4
    assert {654_321, 123_456, 0, 999_999} <= set(rows.tolist())


@given(arrays(np.float64, st.integers(90, 400), elements=FINITE))
def test_each_bucket_keeps_its_extremes(y):
    """Within every bucket the kept rows span the same range as all rows; rows ascend, without repeats."""
    rows = decimation.extremes(y, limit=60)
    assert (np.diff(rows) > 0).all()
    width = -(-y.size // 30)
    for start in range(0, y.size, width):
        bucket = y[start : start + width]
        kept = y[rows[(rows >= start) & (rows < start + width)]]
        assert kept.min() == bucket.min() and kept.max() == bucket.max()


def test_gaps_stay_and_do_not_hide_numbers():
    """A stretch of NaN remains a gap; a single NaN does not take its bucket's place."""
    y = np.sin(np.arange(20_000) / 100)
    y[10_000:15_000] = np.nan
    y[5] = np.nan
    rows = decimation.extremes(y)
    assert np.isnan(y[rows[(rows >= 10_020) & (rows < 14_980)]]).all()
    assert np.isfinite(y[rows[rows < 9_900]]).all()


def test_loop_keeps_the_extremes_of_both_coordinates():
    """A curve that is not over time keeps its outermost points in x and in y."""
    angle = np.linspace(0, 40 * np.pi, 50_000)
    x, y = np.cos(angle), np.sin(angle)
    rows = decimation.curve_extremes(x, y)
    assert rows.size <= decimation.LIMIT + 6
    for values in (x, y):
        assert values[rows].min() == values.min() and values[rows].max() == values.max()


def test_peaks_of_an_error_hide_changes_of_sign():
    """Thinned |error| follows the envelope exp(−t), though |sin| passes through zero."""
    t = np.linspace(0, 10, 20_000)
    error = np.abs(np.exp(-t) * np.sin(400 * t))
    rows = decimation.peaks(error)
    np.testing.assert_allclose(error[rows][:-1], np.exp(-t[rows][:-1]), rtol=0.35)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        (np.linspace(0, 100, 50), "f4"),
        (1e5 + 1e-3 * np.arange(50), "f8"),
        (np.zeros(5), "f8"),
        (np.array([1e300, 0.0]), "f8"),
    ],
)
def test_typed_arrays_keep_visible_digits(values, kind):
    """float32 is used only if its rounding is below a ten-thousandth of the drawn range."""
    packed = decimation.typed(values)
    assert packed["dtype"] == kind
    assert np.abs(decoded(packed) - values).max() <= 1e-4 * np.ptp(values)


def test_infinity_becomes_a_gap():
    """Values that are not finite are NaN on the wire, and the others keep their places."""
    back = decoded(decimation.typed(np.array([1.0, np.inf, np.nan, -np.inf, 2.0])))
    assert np.isnan(back[1:4]).all() and back[0] == 1 and back[4] == 2
    assert np.isnan(decoded(decimation.typed(np.full(3, np.nan)))).all()
