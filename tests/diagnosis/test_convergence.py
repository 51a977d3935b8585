"""Whether an observer still converges: exponential approaches and noise with known results."""

import numpy as np
import pytest

from thetascope.diagnosis.evaluation.convergence import converges, looked_at, misses

NOISE = np.random.default_rng(1).normal(0, 0.01, 4001)


def after(seconds: float, *, bias: float = 1.0, scale: float = 1.0) -> bool | None:
    """Return the answer some seconds after a start with a bias that decays with 1 s, in units of `scale`."""
    t = np.arange(4001) / 100
    value = bias * np.exp(-t) + NOISE
    rows = (t >= looked_at(0, seconds)) & (t <= seconds)
    return converges(t[rows], scale * value[rows], np.full(rows.sum(), 0.01 * scale))


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e7])
def test_an_estimate_converges_until_its_bias_is_as_small_as_its_noise(scale):
    """Units do not matter; after eight time constants 1 has become 0.0003, far below the noise."""
    assert after(1, scale=scale) is True and after(3, scale=scale) is True
    assert after(8, scale=scale) is False and after(40, scale=scale) is False


def test_noise_alone_is_no_convergence():
    """An estimate that begins at the truth, at any time."""
    assert not any(after(seconds, bias=0) for seconds in (0.5, 1, 2, 5, 10, 40))


def test_too_few_values_give_no_answer():
    """Just after the start, and where the observer has diverged."""
    assert after(0.1) is None
    assert converges(np.arange(20.0), np.full(20, np.nan), np.ones(20)) is None


def test_a_residual_beyond_the_noise_is_noticed():
    """An offset of three standard deviations, but not the noise itself; unknown without noise or values."""
    assert misses(NOISE, 0.01) is False
    assert misses(NOISE + 0.03, 0.01) is True
    assert misses(NOISE, 0.0) is None and misses(np.full(20, np.nan), 0.01) is None
