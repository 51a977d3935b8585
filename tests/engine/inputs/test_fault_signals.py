"""Faults inside the model: θ(t) of every shape against its formula, their sums and their random streams."""

from collections.abc import Callable

import numpy as np
import pytest

from thetascope.engine.inputs.fault_signals import fault, theta

ONSET, END, KEY = 2.0, 8.0, (0, 11, 5)
WALK = {"shape": "random-walk", "intensity": 0.3, "sample_time": 0.05}
FORMULAS: list[tuple[dict, Callable[[float], float]]] = [
    ({"shape": "step", "size": 0.02}, lambda s: 0.02),
    ({"shape": "ramp", "size": -3, "duration": 4}, lambda s: -3 * min(s / 4, 1)),
    ({"shape": "drift", "rate": 0.7}, lambda s: 0.7 * s),
    ({"shape": "exponential", "size": 2, "time_constant": 1.5}, lambda s: 2 * (1 - np.exp(-s / 1.5))),
    ({"shape": "sine", "size": 0.5, "frequency": 0.4, "phase": 1}, lambda s: 0.5 * np.sin(2 * np.pi * 0.4 * s + 1)),
    ({"shape": "pulse-train", "size": 4, "period": 1.5, "width": 0.4}, lambda s: 4 if s % 1.5 < 0.4 else 0),
    (
        {"shape": "table", "times": [0, 1, 4], "values": [1, 3, -1], "interpolation": "linear"},
        lambda s: float(np.interp(s, [0, 1, 4], [1, 3, -1])),
    ),
    (
        {"shape": "table", "times": [0.5, 1, 4], "values": [1, 3, -1], "interpolation": "hold"},
        lambda s: 1 if s < 1 else 3 if s < 4 else -1,
    ),
]
TIMES = np.linspace(0.003, 9.997, 1500)


def full(data: dict, **more) -> dict:
    return {"channel": "c", "onset": ONSET, "end": END} | data | more


@pytest.mark.parametrize(("data", "formula"), FORMULAS, ids=lambda d: d.get("shape") if isinstance(d, dict) else "")
def test_a_shape_is_its_formula_between_onset_and_end(data: dict, formula: Callable[[float], float]):
    """In the time since the onset; zero before the onset and from the end on."""
    expected = [formula(t - ONSET) if ONSET <= t < END else 0.0 for t in TIMES]
    np.testing.assert_allclose(fault(full(data), KEY)(TIMES, TIMES), expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("data", [d for d, _ in FORMULAS] + [WALK], ids=lambda d: d["shape"])
def test_onset_and_end_are_breaks_and_a_right_and_a_left_limit(data: dict):
    """A step that ends at the onset is not affected by the fault; one that begins there is."""
    made = fault(full(data), KEY)
    assert {ONSET, END} <= set(made.breaks(0.0, 10.0))
    both, sides = np.array([ONSET, END]), np.array([-1e-3, 1e-3])
    assert made(both[:1], both[:1] + sides[0])[0] == 0.0
    assert made(both[1:], both[1:] + sides[1])[0] == 0.0
    inside = made(both, np.array([ONSET + 1e-3, END - 1e-3]))
    near = made(np.array([ONSET + 1e-9, END - 1e-9]), np.array([ONSET + 1e-3, END - 1e-3]))
    np.testing.assert_allclose(inside, near, atol=1e-6)


def test_a_random_walk_does_not_depend_on_the_evaluation():
    """All together, in blocks, backwards, or a single time: the same numbers."""
    walk = fault(full(WALK), KEY)
    whole = walk(TIMES, TIMES)
    pieces = np.concatenate([walk(part, part) for part in np.array_split(TIMES, 37)])
    np.testing.assert_array_equal(pieces, whole)
    np.testing.assert_array_equal([walk(t, t)[0] for t in TIMES[::-50, None]], whole[::-50])


def test_a_random_walk_spreads_with_the_root_of_time():
    """Over 400 keys its standard deviation is intensity·√τ, and increments are independent."""
    after = np.array([1.0, 4.0])
    t = ONSET + after - 0.5 * WALK["sample_time"]  # the last increment before τ = 1 and 4
    values = np.array([fault(full(WALK), (i, 11, 5))(t, t) for i in range(400)])
    np.testing.assert_allclose(values.std(axis=0), 0.3 * np.sqrt(after), rtol=0.12)
    assert abs(np.corrcoef(values[:, 0], values[:, 1] - values[:, 0])[0, 1]) < 0.2


def test_a_random_walk_moves_only_every_sample_time():
    """It is held in between, and its breaks are the times at which it changes."""
    walk = fault(full(WALK, end=None), KEY)
    breaks = np.unique(walk.breaks(ONSET - 1e-9, 3.0))
    np.testing.assert_allclose(np.diff(breaks), 0.05, atol=1e-12)
    a, b = (breaks[:-1] + share * 0.05 for share in (0.01, 0.99))
    np.testing.assert_array_equal(walk(a, a), walk(b, b))
    assert len(set(walk(a, a))) == len(a)


def test_theta_is_the_sum_of_the_faults_of_its_channel():
    """Faults of other channels and of measurements do not count; without faults it is zero."""
    several = [
        full({"shape": "step", "size": 1.0}, onset=1.0),
        full({"shape": "drift", "rate": 2.0}),
        full({"shape": "step", "size": 100.0}, channel="d"),
        {"output": "y", "shape": "freeze", "onset": 0, "end": None},
    ]
    mine = theta("c", several, 0)
    expected = ((TIMES >= 1) & (TIMES < END)) * 1.0 + ((TIMES >= ONSET) & (TIMES < END)) * 2.0 * (TIMES - ONSET)
    np.testing.assert_allclose(mine(TIMES, TIMES), expected, atol=1e-12)
    assert not mine.held
    none = theta("e", several, 0)
    assert none.held and not none(TIMES, TIMES).any() and not len(none.breaks(0, 10))


def test_random_walks_differ_by_seed_and_fault():
    """They depend on the experiment's seed; two on one channel are independent unless they are identical."""
    other = full(WALK, onset=2.5)
    values = [
        theta("c", faults, seed)(TIMES, TIMES) for faults, seed in (([full(WALK)], 0), ([full(WALK)], 1), ([other], 0))
    ]
    late = TIMES > 3
    assert all((values[0][late] != v[late]).any() for v in values[1:])
    np.testing.assert_array_equal(theta("c", [other, full(WALK)], 0)(TIMES, TIMES), values[2] + values[0])
