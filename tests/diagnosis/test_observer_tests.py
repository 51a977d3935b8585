"""Tests on estimates, with sequences whose result is known."""

from typing import get_args

import numpy as np
import pytest

from thetascope.diagnosis.evaluation.observer_tests import CalibratedTest, alarms, prepare, statistic
from thetascope_schemas.experiment.diagnosis import Test

RATE, INTERVAL, BEGIN = 1.0, 0.1, 10


def noise(runs: int, count: int, channels: int = 1, seed: int = 0) -> np.ndarray:
    """Return white sequences of variance one."""
    return np.random.default_rng(seed).standard_normal((runs, count, channels))


@pytest.mark.parametrize("test", get_args(Test))
def test_a_step_is_found_at_its_onset_and_cleared_at_its_end(test: str):
    """Six standard deviations from decision 300 to 500: one alarm, its onset within 3 decisions, cleared soon after."""
    judged = prepare(noise(16, 1000), test, INTERVAL, RATE, BEGIN)
    z = noise(1, 1000, seed=5)[0]
    z[300:500] += 8.0
    (found,) = alarms(z, judged)
    assert 300 <= found.at <= 303 and abs(found.onset - 300) <= 3
    assert 500 <= found.cleared <= 700


@pytest.mark.parametrize("test", get_args(Test))
def test_thresholds_keep_the_required_rate(test: str):
    """In 100 new runs of 100 s there are at most three times the accepted false alarms."""
    judged = prepare(noise(24, 1000), test, INTERVAL, RATE, BEGIN)
    raised = sum(len(alarms(z, judged)) for z in noise(100, 1000, seed=9))
    assert raised <= 3 * 100 * 100 / 3600 * RATE + 1


def test_cusum_is_pages():
    """By hand: 0.5 is subtracted from each value, the sum is never negative, the onset is its last zero."""
    judged = CalibratedTest("cusum", 3.0, 0, np.array([1]), np.array([1.0]))
    z = np.array([0.0, 2.0, 0.0, -4.0, 2.5, 2.0])[:, None]
    g, onset = statistic(z, judged)
    assert g[:, 0].tolist() == [0.0, 1.5, 1.0, 3.5, 2.0, 3.5]
    assert onset[5, 0] == 4


def test_the_glr_is_the_largest_of_all_windows():
    """It equals the largest value of windows evaluated one by one."""
    judged = CalibratedTest("glr", 9.0, 0, np.array([1, 2, 5]), np.array([1.0, 0.5, 0.2]))
    z = noise(1, 40)[0]
    g, _ = statistic(z, judged)
    for k in range(40):
        every = [
            z[k + 1 - n : k + 1, 0].mean() ** 2 / v
            for n, v in zip((1, 2, 5), (1.0, 0.5, 0.2), strict=True)
            if n <= k + 1
        ]
        assert g[k, 0] == pytest.approx(max(every))
