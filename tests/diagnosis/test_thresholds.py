"""Thresholds: the level that is exceeded at the required rate, and noise as it was simulated."""

import numpy as np
import pytest

from thetascope.diagnosis.detection.thresholds import calibrate, level
from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowSums, scan

NO_BOUNDS = ThetaBounds(np.array([-np.inf]), np.array([np.inf]), np.ones(1))


@pytest.mark.parametrize("rate", [20.0, 4.0, 1.0])
def test_a_level_is_exceeded_at_the_required_rate(rate):
    """50 hours of independent χ² with one degree of freedom: new ones exceed it within a factor of 1.6 of the rate."""
    rng = np.random.default_rng(5)
    threshold = level(rng.chisquare(1, (20, 9000)), 50.0, rate)
    again = rng.chisquare(1, (1600, 9000)) > threshold  # 4000 hours
    assert 1 / 1.6 < again.sum() / 4000 / rate < 1.6


def white(seeds: int, decisions: int, rng: np.random.Generator) -> list[WindowSums]:
    """Return runs without a fault: Ω is 1, x is white with variance 4 instead of one."""
    ones = np.ones((decisions, 1, 1, 1))
    return [WindowSums.empty(1, 1).extended(ones, 2.0 * rng.standard_normal((decisions, 1, 1))) for _ in range(seeds)]


def test_thresholds_follow_the_simulated_noise():
    """With four times the declared variance v and the energy of windows increase, and alarms do not."""
    rng = np.random.default_rng(1)
    found = calibrate(white(40, 1500, rng), 0.1, 1.0, 2, NO_BOUNDS)
    assert found.noise.v == pytest.approx(4.0, rel=0.35) and found.noise.v[:8] == pytest.approx(4.0, rel=0.1)
    assert found.noise.energy[:8] == pytest.approx(4.0 * found.noise.lengths[:8], rel=0.1)
    assert found.hours == pytest.approx(40 * (1500 - found.begin) * 0.1 / 3600)


def test_fewer_false_alarms_need_higher_thresholds():
    """Thresholds increase as the accepted rate decreases."""
    runs = white(30, 1000, np.random.default_rng(2))
    found = [calibrate(runs, 0.1, rate, 2, NO_BOUNDS) for rate in (10.0, 1.0, 0.1)]
    assert found[0].glr < found[1].glr < found[2].glr and found[0].residual < found[1].residual < found[2].residual


def test_the_initial_transient_is_left_out():
    """If the first hundred decisions are noisier, testing begins soon after them."""
    rng = np.random.default_rng(3)
    loud = np.where(np.arange(1000) < 100, 8.0, 1.0)[:, None, None]
    runs = [
        WindowSums.empty(1, 1).extended(np.ones((1000, 1, 1, 1)), loud * rng.standard_normal((1000, 1, 1)))
        for _ in range(30)
    ]
    assert 100 <= calibrate(runs, 0.1, 1.0, 2, NO_BOUNDS).begin <= 160


def swelling(seeds: int, decisions: int, rng: np.random.Generator) -> list[WindowSums]:
    """Return runs without a fault whose noise has four times the variance in a tenth of each."""
    loud = np.where(np.arange(decisions) // (decisions // 20) % 10 == 7, 2.0, 1.0)[:, None, None]
    ones = np.ones((decisions, 1, 1, 1))
    return [WindowSums.empty(1, 1).extended(ones, loud * rng.standard_normal((decisions, 1, 1))) for _ in range(seeds)]


def test_temporarily_larger_noise_keeps_the_rate():
    """With four times the noise variance for a tenth of the time the GLR exceeds its level at most three times as
    often."""
    rng = np.random.default_rng(4)
    found = calibrate(swelling(32, 2000, rng), 0.1, 0.5, 2, NO_BOUNDS)
    ends, over = np.arange(found.begin + 1, 2001), 0
    for run in swelling(500, 2000, rng):
        over += (scan(run, ends, found.begin, np.inf, found.noise, NO_BOUNDS)[0] > found.glr).any()
    hours = 500 * len(ends) * 0.1 / 3600
    assert over <= 3 * 0.9 * 0.5 * hours
    assert found.noise.largest_v[0] == pytest.approx(4.0, rel=0.2) and found.noise.v[0] == pytest.approx(1.3, rel=0.1)


def test_windows_of_an_unsettled_filter_have_less_weight():
    """If the first hundred decisions are a third noisier, too little to be left out, windows that begin there count
    less."""
    rng = np.random.default_rng(6)
    loud = np.where(np.arange(1000) < 100, 1.5**0.5, 1.0)[:, None, None]
    runs = [
        WindowSums.empty(1, 1).extended(np.ones((1000, 1, 1, 1)), loud * rng.standard_normal((1000, 1, 1)))
        for _ in range(60)
    ]
    noise = calibrate(runs, 0.1, 1.0, 2, NO_BOUNDS, ready=100).noise
    assert noise.ready == 100 and noise.early_v[0] == pytest.approx(1.5, rel=0.15)
