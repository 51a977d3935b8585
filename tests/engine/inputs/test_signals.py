"""Time functions: each against its formula, left and right limits at jumps, and breaks that are complete."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.engine.errors import ExpressionError
from thetascope.engine.inputs import signals
from thetascope.engine.inputs.signals import Signal, gated, signal, total

END = 10.0
FORMULAS: list[tuple[dict, Callable[[float], float]]] = [
    ({"kind": "constant", "value": 0.08}, lambda t: 0.08),
    ({"kind": "steps", "times": [2, 5.5], "values": [1, -2, 3]}, lambda t: 1 if t < 2 else -2 if t < 5.5 else 3),
    (
        {"kind": "pulse", "low": -1, "high": 2, "period": 0.7, "width": 0.2, "start": 1.1},
        lambda t: 2 if t >= 1.1 and (t - 1.1) - 0.7 * int((t - 1.1) / 0.7) < 0.2 else -1,
    ),
    ({"kind": "pulse", "low": 0, "high": 1, "period": 2, "width": 2, "start": 0.5}, lambda t: 1 if t >= 0.5 else 0),
    (
        {"kind": "sine", "amplitude": 2, "frequency": 0.7, "phase": 0.3, "offset": 1},
        lambda t: 1 + 2 * np.sin(2 * np.pi * 0.7 * t + 0.3),
    ),
    (
        {"kind": "ramp", "start": 2, "slope": 0.5, "initial": 1, "end": 6},
        lambda t: 1 if t < 2 else 1 + 0.5 * (min(t, 6) - 2),
    ),
    ({"kind": "ramp", "start": 2, "slope": -1, "initial": 0, "end": None}, lambda t: -max(0, t - 2)),
    (
        {"kind": "chirp", "amplitude": 2, "f0": 0.2, "f1": 1.4, "duration": 4, "offset": 1},
        lambda t: 1 + 2 * np.sin(2 * np.pi * (0.2 * t + 0.15 * t**2 if t < 4 else 3.2 + 1.4 * (t - 4))),
    ),
    (
        {"kind": "table", "times": [1, 2, 4], "values": [3, 5, -1], "interpolation": "linear"},
        lambda t: float(np.interp(t, [1, 2, 4], [3, 5, -1])),
    ),
    (
        {"kind": "table", "times": [1, 2, 4], "values": [3, 5, -1], "interpolation": "hold"},
        lambda t: 3 if t < 2 else 5 if t < 4 else -1,
    ),
    ({"kind": "table", "times": [1], "values": [3], "interpolation": "linear"}, lambda t: 3),
    ({"kind": "expression", "text": "sin(t) - exp(-t/3)*t^2"}, lambda t: np.sin(t) - np.exp(-t / 3) * t**2),
]
IDS = [f"{data['kind']}-{i}" for i, (data, _) in enumerate(FORMULAS)]
HELD = [data for data, _ in FORMULAS if signal(data).held] + [
    {"kind": "prbs", "low": -1, "high": 2, "hold": 0.3, "seed": 5}
]


def at(s: Signal, times: np.ndarray) -> np.ndarray:
    return s(times, times)


def pieces(s: Signal, end: float = END) -> list[tuple[float, float]]:
    """Return the intervals between breaks."""
    edges = [0.0, *np.unique(s.breaks(0.0, end)), end]
    return [(a, b) for a, b in pairwise(edges) if b - a > 1e-9]


@pytest.mark.parametrize(("data", "formula"), FORMULAS, ids=IDS)
def test_a_signal_is_its_formula(data: dict, formula: Callable[[float], float]):
    """At a thousand times other than jumps."""
    times = np.random.default_rng(1).uniform(0, END, 1000)
    np.testing.assert_allclose(at(signal(data), times), [formula(t) for t in times], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("data", "formula"), FORMULAS, ids=IDS)
def test_limits_at_a_break_are_those_of_the_pieces_beside_it(data: dict, formula: Callable[[float], float]):
    """With an anchor before the break the value there is the left limit, with one after it the right limit."""
    s = signal(data)
    for time in s.breaks(0.0, END):
        for anchor in (time - 1e-3, time + 1e-3):
            limit = formula(time + np.sign(anchor - time) * 1e-10)
            np.testing.assert_allclose(s(np.array([time]), np.array([anchor]))[0], limit, rtol=0, atol=1e-8)


@pytest.mark.parametrize("data", HELD, ids=lambda d: d["kind"])
@given(where=st.floats(0, 1), share=st.floats(0.01, 0.99), other=st.floats(0.01, 0.99))
def test_a_held_signal_is_constant_between_its_breaks(data: dict, where: float, share: float, other: float):
    """Therefore a kernel needs one value per segment."""
    s = signal(data)
    found = pieces(s)
    a, b = found[min(int(where * len(found)), len(found) - 1)]
    low, high = at(s, np.array([a + share * (b - a), a + other * (b - a)]))
    assert low == high


@pytest.mark.parametrize("data", [d for d, _ in FORMULAS if not signal(d).held], ids=lambda d: d["kind"])
def test_a_smooth_signal_has_no_kink_between_its_breaks(data: dict):
    """Second differences within a piece are as small as those of the formula: no jump of value or slope."""
    s, h = signal(data), 1e-3
    for a, b in pieces(s):
        grid = np.arange(a + 1e-9, b - 1e-9, h)
        bend = np.diff(at(s, grid), 2) / h**2
        assert np.abs(bend).max(initial=0) < 400  # a kink of slope 0.5 would give 500


@given(a=st.floats(0, 5), b=st.floats(5, 10), middle=st.floats(0, 1))
def test_breaks_of_a_span_are_those_of_its_parts(a: float, b: float, middle: float):
    """However the horizon is divided, no break is lost or added."""
    middle = a + middle * (b - a)
    for data in (*HELD, *(d for d, _ in FORMULAS)):
        s = signal(data)
        whole = np.unique(s.breaks(a, b))
        parts = np.unique(np.concatenate([s.breaks(a, middle), s.breaks(middle, b)]))
        np.testing.assert_array_equal(whole[whole != middle], parts)


def test_prbs_is_binary_fair_and_depends_on_its_seed():
    """Two values, each about half of the time, drawn anew after every hold time;
    another seed gives another sequence."""

    def make(seed: int):
        return signal({"kind": "prbs", "low": -1, "high": 2, "hold": 0.5, "seed": seed})

    times = 0.25 + 0.5 * np.arange(4000)
    values = at(make(1), times)
    assert set(values) == {-1.0, 2.0} and abs(np.mean(values == 2) - 0.5) < 0.03
    assert abs(np.mean(values[1:] == values[:-1]) - 0.5) < 0.03
    assert abs(np.mean(at(make(2), times) == values) - 0.5) < 0.03
    np.testing.assert_array_equal(at(make(1), times[100:110]), values[100:110])


def test_a_sum_has_the_values_and_breaks_of_all_its_parts():
    """Held only if every part is; an empty sum is zero."""
    one, two = signal(HELD[1]), signal({"kind": "ramp", "start": 3, "slope": 1})
    times = np.linspace(0.01, 9.99, 500)
    both = total([one, two])
    np.testing.assert_array_equal(at(both, times), at(one, times) + at(two, times))
    assert set(both.breaks(0, END)) == {*one.breaks(0, END), *two.breaks(0, END)}
    assert not both.held and total([one, one]).held
    assert not at(total([]), times).any()


@pytest.mark.parametrize("data", [d for d, _ in FORMULAS], ids=IDS)
def test_gating_counts_time_from_the_onset_and_ends(data: dict):
    """Zero before the onset and from the end on; the signal's own time in between; breaks at both."""
    onset, end = 2.3, 7.1
    inner, outer = signal(data), gated(signal(data), onset, end)
    times = np.linspace(0.005, 9.995, 2000)
    inside = (times >= onset) & (times < end)
    expected = np.where(inside, inner(times - onset, times - onset), 0.0)
    np.testing.assert_allclose(at(outer, times), expected, rtol=1e-12, atol=1e-12)
    own = [b + onset for b in inner.breaks(0, end - onset)]
    np.testing.assert_allclose(np.unique(outer.breaks(0, END)), np.unique([onset, *own, end]), atol=1e-12)
    assert outer.held == inner.held


def test_a_signal_without_end_stays():
    """With end = None it never ends."""
    forever = gated(signals.constant(2.0), 1.0, None)
    assert at(forever, np.array([0.5, 1.5, 1e6])).tolist() == [0.0, 2.0, 2.0]
    assert forever.breaks(0, 1e6).tolist() == [1.0]


def test_a_signal_with_too_many_switching_times_is_refused():
    """More than ten million switching times are refused, not computed."""
    with pytest.raises(ValueError, match="switches more than"):
        signal({"kind": "prbs", "low": 0, "high": 1, "hold": 1e-9, "seed": 0}).breaks(0.0, 1.0)


def test_an_expression_may_contain_only_the_time():
    """Any other name is an error that points into the text."""
    with pytest.raises(ExpressionError, match="x1"):
        signal({"kind": "expression", "text": "sin(x1)"})
