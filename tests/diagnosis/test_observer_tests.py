"""Tests on estimates: on sequences whose answer is known."""

from typing import get_args

import numpy as np
import pytest

from thetascope.diagnosis.evaluation.observer_tests import CalibratedTest, alarms, prepare, statistic
from thetascope_schemas.experiment.diagnosis import Test

RATE, INTERVAL, BEGIN = 1.0, 0.1, 10


def noise(runs: int, count: int, channels: int = 1, seed: int = 0) -> np.ndarray:
    """White sequences of variance one."""
    return np.random.default_rng(seed).standard_normal((runs, count, channels))


@pytest.mark.parametrize("test", get_args(Test))
def test_a_step_is_found_where_it_is_and_cleared_where_it_ends(test: str):
    """Six standard deviations from decision 300 to 500: one alarm, its onset within 3 decisions, over soon after."""
    judged = prepare(noise(16, 1000), test, INTERVAL, RATE, BEGIN)
    z = noise(1, 1000, seed=5)[0]
    z[300:500] += 8.0
    (found,) = alarms(z, judged)
    assert 300 <= found.at <= 303 and abs(found.onset - 300) <= 3
    assert 500 <= found.cleared <= 700


@pytest.mark.parametrize("test", get_args(Test))
def test_thresholds_keep_the_rate_asked_for(test: str):
    """100 fresh runs of 100 s each with one false alarm per hour asked: at most 3 times what is due on average."""
    judged = prepare(noise(24, 1000), test, INTERVAL, RATE, BEGIN)
    raised = sum(len(alarms(z, judged)) for z in noise(100, 1000, seed=9))
    assert raised <= 3 * 100 * 100 / 3600 * RATE + 1


def test_a_sum_is_pages():
    """CUSUM by hand: 0.5 is taken off each value, the sum never falls below zero, the onset is where it last was there."""
    judged = CalibratedTest("cusum", 3.0, 0, np.array([1]), np.array([1.0]))
    z = np.array([0.0, 2.0, 0.0, -4.0, 2.5, 2.0])[:, None]
    g, onset = statistic(z, judged)
    assert g[:, 0].tolist() == [0.0, 1.5, 1.0, 3.5, 2.0, 3.5]
    assert onset[5, 0] == 4


def test_a_glr_is_the_largest_of_all_windows():
    """Against every window looked at one by one."""
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
