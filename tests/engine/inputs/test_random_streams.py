"""Random numbers: their definition, random access, independence of streams."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.random_streams import Streams, normal, uniform

KEY = (3, 1, 4)
_MASK = (1 << 64) - 1


def fits(x: np.ndarray, distribution: str) -> bool:
    """Return whether the test of Kolmogorov and Smirnov accepts a distribution for numbers."""
    from scipy.stats import kstest  # slow to import: not for every worker

    return kstest(x, distribution).pvalue > 0.01


def threefry(k0: int, k1: int, c0: int, c1: int) -> tuple[int, int]:
    """Return Threefry-2x64 with 20 rounds, from the paper, with Python's integers."""
    keys = (k0, k1, 0x1BD11BDAA9FC1A22 ^ k0 ^ k1)
    x0, x1 = (c0 + k0) & _MASK, (c1 + k1) & _MASK
    for i in range(20):
        turn = (16, 42, 12, 31, 16, 32, 24, 21)[i % 8]
        x0 = (x0 + x1) & _MASK
        x1 = ((x1 << turn | x1 >> (64 - turn)) & _MASK) ^ x0
        if i % 4 == 3:
            s = i // 4 + 1
            x0, x1 = (x0 + keys[s % 3]) & _MASK, (x1 + keys[(s + 1) % 3] + s) & _MASK
    return x0, x1


@pytest.mark.parametrize(
    ("key", "counter", "words"),
    [
        ((0, 0), (0, 0), (0xC2B6E3A8C2C69865, 0x6F81ED42F350084D)),
        ((_MASK, _MASK), (_MASK, _MASK), (0xE02CB7C4D95D277A, 0xD06633D0893B8B68)),
    ],
)
def test_the_reference_is_threefry(key, counter, words):
    """The reference in this file gives the known answers published with Random123."""
    assert threefry(*key, *counter) == words


def test_uniform_numbers_are_the_upper_bits_of_threefry():
    """Number j is the upper 52 bits of word j mod 2 of counter j div 2."""
    words = [w for c in range(500) for w in threefry(*random_streams._words(KEY), c, 0)]
    np.testing.assert_array_equal(uniform(KEY, 0, 1000), [(w >> 12) * 2.0**-52 for w in words])


def test_normal_numbers_are_those_of_box_and_muller():
    """They agree with NumPy's √(−2 ln u) (cos, sin) of an angle within ±45° and a quarter turn."""
    words = np.array([threefry(*random_streams._words(KEY), c, 0) for c in range(2000)], dtype=np.uint64)
    u = (words[:, 0] >> np.uint64(12)) * 2.0**-52 + 2.0**-53
    angle = ((words[:, 1] >> np.uint64(12)) * 2.0**-52 - 0.5) * np.pi / 2
    turned, sign = words[:, 1] & np.uint64(1) > 0, np.where(words[:, 1] & np.uint64(2) > 0, -1.0, 1.0)
    straight, aside = np.cos(angle), np.sin(angle)
    pair = np.stack([np.where(turned, aside, straight), np.where(turned, straight, aside)], axis=1)
    expected = (np.sqrt(-2 * np.log(u)) * sign)[:, None] * pair
    np.testing.assert_allclose(normal(KEY, 0, 4000), expected.ravel(), rtol=1e-14, atol=1e-15)


@given(first=st.integers(0, 10**12), count=st.integers(0, 300), cut=st.integers(0, 300))
def test_random_access_equals_sequential_access(first: int, count: int, cut: int):
    """Draws first … first+count−1 together, in two calls, or one by one have the same bits."""
    cut = min(cut, count)
    for draw in (normal, uniform):
        whole = draw(KEY, first, count)
        parts = np.concatenate([draw(KEY, first, cut), draw(KEY, first + cut, count - cut)])
        np.testing.assert_array_equal(whole, parts)
        if count:
            assert draw(KEY, first + count - 1, 1) == whole[-1]


@given(first=st.integers(0, 10**9), count=st.integers(1, 50), lanes=st.sampled_from([8, 16]))
def test_streams_drawn_together_equal_single_streams(first: int, count: int, lanes: int):
    """Each column of Streams.normal has the bits of normal with that key."""
    keys = [(seed, 3, 0) for seed in range(lanes)]
    together = Streams(keys).normal(first, count)
    assert together.shape == (count, lanes)
    for lane, key in enumerate(keys):
        np.testing.assert_array_equal(together[:, lane], normal(key, first, count))


def test_normal_numbers_are_normal():
    """Half a million of them: Kolmogorov–Smirnov, moments, tails, and no correlation between neighbours."""
    n = 500_000
    x = normal(KEY, 0, n)
    assert fits(x, "norm")
    for power, moment in ((1, 0), (2, 1), (3, 0), (4, 3), (6, 15)):
        spread = np.sqrt(np.var(x**power) / n)
        assert abs(np.mean(x**power) - moment) < 4 * spread
    assert 4.2 < np.abs(x).max() < 6.5
    for lag in (1, 2, 3, 8, 16):
        assert abs(np.corrcoef(x[lag:], x[:-lag])[0, 1]) < 4 / np.sqrt(n)


def test_uniform_numbers_are_uniform():
    """In [0, 1), Kolmogorov–Smirnov."""
    x = uniform(KEY, 0, 500_000)
    assert x.min() >= 0 and x.max() < 1
    assert fits(x, "uniform")


def test_streams_of_different_keys_are_uncorrelated():
    """Also for neighbouring seeds, and for keys whose parts are equal when joined."""
    keys = [(0,), (1,), (2,), (12,), (1, 2), (2, 1), (1, 2, 0), (2**64,), (2**64 + 1,)]
    n = 20_000
    rows = np.array([normal(k, 0, n) for k in keys])
    between = np.corrcoef(rows) - np.eye(len(keys))
    assert np.abs(between).max() < 5 / np.sqrt(n)


def test_a_fault_keeps_its_stream_whatever_its_place_and_end():
    """key_of depends on the fault, but neither on its end nor on the order of faults."""
    fault = {"channel": "c", "shape": "random-walk", "onset": 1.0, "end": None, "intensity": 1.0, "sample_time": 0.1}
    assert random_streams.key_of(fault) == random_streams.key_of(dict(reversed(fault.items())) | {"end": 4.0})
    assert random_streams.key_of(fault) != random_streams.key_of(fault | {"onset": 2.0})


def test_threads_get_the_same_numbers():
    """Eight threads that draw concurrently get the numbers of one."""
    keys = [(i,) for i in range(64)]
    with ThreadPoolExecutor(8) as pool:
        drawn = list(pool.map(lambda k: normal(k, 5, 5000), keys))
    for key, values in zip(keys, drawn, strict=True):
        np.testing.assert_array_equal(values, normal(key, 5, 5000))


FIRST_USE = """
import threading
from thetascope.engine.inputs import random_streams

load, meet, drawn = random_streams.load, threading.Barrier(4), []

def together(*args):
    meet.wait()
    engine = load(*args)
    meet.wait()
    return engine

random_streams.load = together
draw = lambda: drawn.append(random_streams.normal((1,), 0, 200_000).tobytes())
threads = [threading.Thread(target=draw) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert len(drawn) == 4 and len(set(drawn)) == 1
"""


def test_threads_that_come_first_together_get_the_same_numbers():
    """Each loads the machine code, of which one copy is kept: the others must exist until their calls have ended."""
    done = subprocess.run([sys.executable, "-c", FIRST_USE], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, (done.returncode, done.stderr)
