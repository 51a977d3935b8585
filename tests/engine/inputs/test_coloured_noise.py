"""Coloured noise, process noise and sample instants as sequences with random access."""

import numpy as np
import pytest

from thetascope.engine.inputs.coloured_noise import BLOCK, coloured, process_noise
from thetascope.engine.inputs.sampling import Sampling

KEY = (1, 3, 0)


@pytest.mark.parametrize("decay", [1e-3, 0.1])
def test_coloured_noise_has_variance_one_and_an_exponential_autocorrelation(decay: float):
    """Variance and autocorrelation agree with 1 and e^(−decay·lag), also across the boundaries of blocks."""
    streams = np.stack([coloured((seed, 3), decay, BLOCK - 40, 80) for seed in range(1500)])
    error = 5 / np.sqrt(len(streams))
    assert np.abs(streams.mean(axis=0)).max() < error
    assert np.abs(streams.var(axis=0) - 1).max() < np.sqrt(2) * error
    expected = np.exp(-decay * np.abs(np.arange(80)[:, None] - np.arange(80)))
    assert np.abs(streams.T @ streams / len(streams) - expected).max() < np.sqrt(2) * error


@pytest.mark.parametrize("decay", [1e-5, 0.3])
def test_coloured_noise_does_not_depend_on_how_it_is_read(decay: float):
    """Any part of the sequence has the bits of the whole."""
    whole = coloured(KEY, decay, 0, 3 * BLOCK)
    for first, count in ((0, 1), (BLOCK - 1, 2), (BLOCK, BLOCK), (700, 1900)):
        assert (coloured(KEY, decay, first, count) == whole[first : first + count]).all()
    assert np.abs(np.diff(whole)).max() < 6 * np.sqrt(-np.expm1(-2 * decay)) + 6 * decay  # no jump between blocks


def test_process_noise_sums_to_a_wiener_process():
    """Its integral over 1 s has the variance std², for any step."""
    for step in (0.01, 0.002):
        anchor = (np.arange(round(1 / step)) + 0.5) * step
        ends = [step * process_noise(0.3, step, (seed, 11))(anchor, anchor).sum() for seed in range(2000)]
        assert np.var(ends) == pytest.approx(0.09, rel=0.15)


def test_samples_come_at_the_period_late_by_up_to_the_jitter_and_some_are_lost():
    """Shares of lost samples and delays are as declared, and any span has the samples of the whole."""
    sampling = Sampling(10, missing=0.2, late=4.0, key=KEY)
    taken = sampling.taken(0, 100_000)
    delay = taken % 10
    assert taken[0] == 0
    assert delay.max() == 4
    assert np.mean(delay) == pytest.approx(2.0, abs=0.1)
    assert len(taken) == pytest.approx(8000, abs=150)
    assert len(np.unique(taken // 10)) == len(taken)
    parts = [sampling.taken(a, b) for a, b in zip([0, 7, 13, 500], [7, 13, 500, 1000], strict=True)]
    assert (np.concatenate(parts) == taken[taken < 1000]).all()
    index = np.arange(0, 1000, 5)
    fresh = sampling.fresh(index, 5)
    assert (np.concatenate([sampling.fresh(index[:40], 5), sampling.fresh(index[40:], 5)]) == fresh).all()
    assert fresh.sum() == (taken <= 995).sum()
