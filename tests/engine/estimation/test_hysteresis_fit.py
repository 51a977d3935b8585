"""Operators of a hysteresis from records: the paper's, others in other units, with noise, and what cannot be fitted."""

import numpy as np
import pytest

from thetascope.engine.errors import SpecError
from thetascope.engine.estimation.hysteresis_fit import identify

T = np.arange(2000) * 0.01


def play(x, width):
    """Return a play operator as (6)–(9) have it, row by row, from rest."""
    z, out = 0.0, []
    for before, now in zip([x[0], *x[:-1]], x, strict=True):
        if now > before and now > z + width:
            z = now - width
        elif now < before and now < z - width:
            z = now + width
        out.append(z)
    return np.array(out)


@pytest.mark.parametrize("unit", [1.0, 1e6, 1e-9])
def test_thresholds_and_weights_are_recovered_exactly(unit):
    """Seven operators of the paper's widths, driven by a growing sine: exact without noise, in any unit."""
    x = 0.18 * np.sin(2 * np.pi * T) * np.minimum(T / 5, 1)
    widths = np.arange(1, 8) / 100
    v = sum(play(x, d) for d in widths)
    fit = identify(unit * x, v, 7)
    np.testing.assert_allclose(fit.thresholds, unit * widths, rtol=1e-4)
    np.testing.assert_allclose(fit.weights, 1 / unit, rtol=1e-3)
    assert fit.direct * unit == pytest.approx(0, abs=1e-3) and fit.residual < 1e-6


def test_a_share_without_memory_and_an_offset_are_found():
    """v = 0.7 + 0.3 x + 1.6 z(0.12) + 0.4 z(0.37), with noise: within four of their own standard deviations."""
    x = (1 + 0.3 * np.sin(0.37 * T)) * np.sin(2 * T)
    clean = 0.7 + 0.3 * x + 1.6 * play(x, 0.12) + 0.4 * play(x, 0.37)
    misses = []
    for seed in range(10):
        v = clean + 0.002 * np.random.default_rng(seed).standard_normal(len(x))
        fit = identify(x, v, 2, thresholds=[0.37, 0.12])
        assert list(fit.thresholds) == [0.12, 0.37] and fit.residual == pytest.approx(0.002, rel=0.1)
        assert fit.direct == pytest.approx(0.3, abs=0.01) and fit.offset == pytest.approx(0.7, abs=0.001)
        misses += list((fit.weights - [1.6, 0.4]) / fit.deviations)
    assert np.abs(misses).max() < 4 and 0.5 < np.std(misses) < 1.6


def test_missing_readings_are_left_out():
    """Rows without v are no part of the fit; the operators are driven by all of x."""
    x = np.sin(3 * T) * (1 + 0.2 * np.cos(T))
    v = 2 * play(x, 0.2)
    v[::3] = np.nan
    fit = identify(x, v, 1)
    assert fit.thresholds == pytest.approx([0.2], rel=1e-4) and fit.weights == pytest.approx([2], rel=1e-4)


@pytest.mark.parametrize(
    ("x", "v", "more", "words"),
    [
        (np.zeros(100), np.zeros(100), {}, "does not move"),
        (np.sin(T), np.full(len(T), np.nan), {}, "0 rows with numbers"),
        (np.sin(T), np.sin(T), {"thresholds": [1.5]}, "stays in its memory"),
        (np.sin(T), np.sin(T), {"thresholds": [-0.1]}, "positive"),
        (np.sin(T), np.sin(T)[1:], {}, "different lengths"),
        (np.zeros(60_000), np.zeros(60_000), {}, "at most 50000"),
    ],
)
def test_what_cannot_be_fitted_is_refused(x, v, more, words):
    """An input that rests, no readings, thresholds that nothing reaches, and records that take too long."""
    with pytest.raises(SpecError) as refused:
        identify(x, v, **more)
    assert words in str(refused.value)
