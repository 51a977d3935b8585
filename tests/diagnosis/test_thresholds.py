"""Thresholds: the level that is crossed as often as is asked for, and noise as it was simulated."""

import numpy as np
import pytest

from thetascope.diagnosis.detection.thresholds import calibrate, level
from thetascope.diagnosis.detection.window_tests import ThetaBounds, WindowSums, scan

NO_BOUNDS = ThetaBounds(np.array([-np.inf]), np.array([np.inf]))


@pytest.mark.parametrize("rate", [20.0, 4.0, 1.0])
def test_a_level_is_crossed_as_often_as_asked(rate):
    """Independent χ² with one degree of freedom, 50 hours of them: fresh ones cross the level within a factor of 1.6 as often."""
    rng = np.random.default_rng(5)
    threshold = level(rng.chisquare(1, (20, 9000)), 50.0, rate)
    again = rng.chisquare(1, (1600, 9000)) > threshold  # 4000 hours
    assert 1 / 1.6 < again.sum() / 4000 / rate < 1.6


def white(seeds: int, decisions: int, rng: np.random.Generator) -> list[WindowSums]:
    """Runs without a fault: Ω is 1, x white with variance 4 in place of one."""
    ones = np.ones((decisions, 1, 1, 1))
    return [WindowSums.empty(1, 1).extended(ones, 2.0 * rng.standard_normal((decisions, 1, 1))) for _ in range(seeds)]


def test_noise_is_taken_as_it_was_simulated():
    """Noise of four times the declared variance: v and the energy of windows say so, and no alarm comes more often for it."""
    rng = np.random.default_rng(1)
    found = calibrate(white(40, 1500, rng), 0.1, 1.0, 2, NO_BOUNDS)
    assert found.noise.v == pytest.approx(4.0, rel=0.35) and found.noise.v[:8] == pytest.approx(4.0, rel=0.1)
    assert found.noise.energy[:8] == pytest.approx(4.0 * found.noise.lengths[:8], rel=0.1)
    assert found.hours == pytest.approx(40 * (1500 - found.begin) * 0.1 / 3600)


def test_fewer_false_alarms_ask_for_more():
    """Thresholds go up as the rate of false alarms goes down."""
    runs = white(30, 1000, np.random.default_rng(2))
    found = [calibrate(runs, 0.1, rate, 2, NO_BOUNDS) for rate in (10.0, 1.0, 0.1)]
    assert found[0].glr < found[1].glr < found[2].glr and found[0].residual < found[1].residual < found[2].residual


def test_what_the_first_guess_does_is_left_out():
    """Runs that are loud for their first hundred decisions: judging begins after these, and soon."""
    rng = np.random.default_rng(3)
    loud = np.where(np.arange(1000) < 100, 8.0, 1.0)[:, None, None]
    runs = [
        WindowSums.empty(1, 1).extended(np.ones((1000, 1, 1, 1)), loud * rng.standard_normal((1000, 1, 1)))
        for _ in range(30)
    ]
    assert 100 <= calibrate(runs, 0.1, 1.0, 2, NO_BOUNDS).begin <= 160


def swelling(seeds: int, decisions: int, rng: np.random.Generator) -> list[WindowSums]:
    """Runs without a fault whose noise has four times the variance in a tenth of each."""
    loud = np.where(np.arange(decisions) // (decisions // 20) % 10 == 7, 2.0, 1.0)[:, None, None]
    ones = np.ones((decisions, 1, 1, 1))
    return [WindowSums.empty(1, 1).extended(ones, loud * rng.standard_normal((decisions, 1, 1))) for _ in range(seeds)]


def test_noise_that_swells_raises_no_more_alarms_than_asked():
    """Noise four times as strong for a tenth of the time: in fresh runs the GLR is above its level at most three times as often as asked."""
    rng = np.random.default_rng(4)
    found = calibrate(swelling(32, 2000, rng), 0.1, 0.5, 2, NO_BOUNDS)
    ends, over = np.arange(found.begin + 1, 2001), 0
    for run in swelling(500, 2000, rng):
        over += (scan(run, ends, found.begin, np.inf, found.noise, NO_BOUNDS)[0] > found.glr).any()
    hours = 500 * len(ends) * 0.1 / 3600
    assert over <= 3 * 0.9 * 0.5 * hours
    assert found.noise.largest_v[0] == pytest.approx(4.0, rel=0.2) and found.noise.v[0] == pytest.approx(1.3, rel=0.1)


def test_a_filter_that_is_not_yet_sure_is_believed_less():
    """Runs of which the first hundred decisions are a third louder, too little to be left out: windows that begin there count less."""
    rng = np.random.default_rng(6)
    loud = np.where(np.arange(1000) < 100, 1.5**0.5, 1.0)[:, None, None]
    runs = [
        WindowSums.empty(1, 1).extended(np.ones((1000, 1, 1, 1)), loud * rng.standard_normal((1000, 1, 1)))
        for _ in range(60)
    ]
    noise = calibrate(runs, 0.1, 1.0, 2, NO_BOUNDS, ready=100).noise
    assert noise.ready == 100 and noise.early_v[0] == pytest.approx(1.5, rel=0.15)
