"""Figures of observers over a window: error, noise and settling of hand-made columns with known results."""

from types import SimpleNamespace

import numpy as np
import pytest

from thetascope.diagnosis.evaluation.metrics import straight_line_noise, too_noisy
from thetascope.diagnosis.evaluation.window_comparison import Samples, settling_of_step, window_figures
from thetascope_schemas.experiment.faults import Site

T = np.arange(1001) / 100
STEP = SimpleNamespace(site=Site("channel", "a"), shape="step", onset=2.0, end=None)
WAVE = np.sin(1.7 * np.arange(T.size)) + np.sin(0.61 * np.arange(T.size))


def rows(estimate: np.ndarray, state: np.ndarray | None = None) -> Samples:
    """Return a step of θ from 0 to 1 at 2 s, an estimate of it, and a state that is 0 with its estimate."""
    columns = {"t": T, "theta.a": (T >= 2) * 1.0, "one.theta.a": estimate, "x.x": 0 * T}
    columns["one.x.x"] = 0 * T if state is None else state
    return Samples(tuple(columns), np.array(list(columns.values())))


def followed(estimate: np.ndarray, **changes) -> tuple:
    """Return how the estimate has followed the step until now."""
    fault = SimpleNamespace(**vars(STEP) | changes)
    return settling_of_step(rows(estimate), "one", "a", fault, [fault])


def test_noise_is_the_spread_about_a_straight_line():
    """A ramp has none, alternating ±1 on a ramp has one; missing values are ignored; two values are too few."""
    sign = np.where(np.arange(T.size) % 2, 1.0, -1.0)
    assert straight_line_noise(T, 3 * T - 7) == pytest.approx(0, abs=1e-9)
    assert straight_line_noise(T, 3 * T + sign) == pytest.approx(1, abs=0.01)
    assert straight_line_noise(T, np.where(T < 5, np.nan, 3 * T)) == pytest.approx(0, abs=1e-9)
    assert straight_line_noise(T[:2], T[:2]) is None


def test_an_estimate_settles_stays_out_or_is_too_noisy():
    """exp(−t) is within 10 % after ln 10; one that stays at half is not; noise alone keeps the third out."""
    late = np.where(T < 2, 0, 1 - np.exp(-(T - 2)))
    time, outcome = followed(late)
    assert outcome == "settled" and 0 <= time - np.log(10) <= 0.011
    assert followed((T >= 2) * 0.5) == (None, "not-yet")
    assert followed((T >= 2) * (1 + 0.1 * WAVE)) == (None, "too-noisy")
    assert followed((T >= 2) * (0.7 + 0.1 * WAVE)) == (None, "not-yet")


def test_settling_is_unknown_without_data():
    """No step, no estimate, too few rows after the onset, or an observer that diverged before it."""
    good = (T >= 2) * 1.0
    assert followed(good, shape="ramp") == (None, "unknown")
    assert settling_of_step(rows(good), "two", "a", STEP, [STEP]) == (None, "unknown")
    assert followed(good, onset=9.99) == (None, "unknown")
    assert followed(np.where(T < 1, 0.0, np.nan)) == (None, "unknown")


def test_too_noisy_requires_values_around_the_truth():
    """Values within the band, or with a missing value in the later half, are not called too noisy."""
    assert not too_noisy(T, 0.01 * WAVE, 0.1)
    assert too_noisy(T, 0.1 * WAVE, 0.1)
    assert not too_noisy(T, np.where(T > 9, np.nan, 0.1 * WAVE), 0.1)


def test_error_and_noise_of_a_window():
    """The error is that of the chosen state, None with a missing value; the noise is of the last quarter."""
    state = np.where(T < 5, 0.3, 0.4)
    estimate = np.where(T < 7.5, 5 * WAVE, 0.0)
    figures = window_figures(rows(estimate, state), "one", "x", "a")
    assert figures.rmse == pytest.approx(np.sqrt((0.3**2 * 500 + 0.4**2 * 501) / 1001))
    assert figures.noise == pytest.approx(0, abs=1e-9)
    lost = window_figures(rows(estimate, np.where(T > 9, np.nan, 0.0)), "one", "x", None)
    assert (lost.rmse, lost.noise) == (None, None)
    assert window_figures(rows(estimate), "two", "x", "a").rmse is None
