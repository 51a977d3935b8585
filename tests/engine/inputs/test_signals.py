"""Time functions: each against its formula, left and right limits at jumps, and breaks that are complete."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
import scipy.signal
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from thetascope.engine.errors import ExpressionError
from thetascope.engine.inputs import signals
from thetascope.engine.inputs.signals import Signal, gated, signal, total

END = 10.0


def chirp_cycles(run: float, f0: float, f1: float, duration: float) -> float:
    """Return the cycles of a chirp after `run` s, by the trapezoidal rule, which is exact for a linear frequency."""
    times = np.array([0.0, run] if run < duration else [0.0, duration, run])
    frequency = np.interp(times, [0, duration], [f0, f1])
    return float(np.trapezoid(frequency, times))


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
        {"kind": "chirp", "amplitude": 2, "f0": 0.4, "f1": 1.6, "duration": 4, "offset": 1, "start": 3.3},
        lambda t: 1 + 2 * np.sin(2 * np.pi * chirp_cycles(t - 3.3, 0.4, 1.6, 4)),
    ),
    (
        {"kind": "square", "amplitude": 2, "period": 1.7, "start": 4.1, "offset": 1},
        lambda t: 1 + 2 * float(scipy.signal.square(2 * np.pi * (t - 4.1) / 1.7)),
    ),
    (
        {"kind": "square", "amplitude": -0.5, "period": 30, "start": -7},
        lambda t: -0.5 * float(scipy.signal.square(2 * np.pi * (t + 7) / 30)),
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
    {"kind": "prbs", "low": -1, "high": 2, "hold": 0.3, "seed": 5},
    {"kind": "prbs", "low": -1, "high": 2, "hold": 0.3, "seed": 5, "order": 5},
    {"kind": "noise", "std": 0.5, "hold": 0.3, "seed": 5, "offset": 2},
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


@pytest.mark.parametrize("order", range(2, 17))
def test_a_prbs_with_an_order_is_the_maximum_length_sequence(order: int):
    """The same bits as SciPy's over one period and into the next; the seed shifts it."""
    bits = scipy.signal.max_len_seq(order)[0]
    times = 0.5 * (np.arange(min(len(bits) + 20, 3000)) + 0.5)
    for seed in (0, 3, 2**53 - 1):
        s = signal({"kind": "prbs", "low": -1, "high": 2, "hold": 0.5, "seed": seed, "order": order})
        expected = np.where(bits[(np.arange(len(times)) + seed) % len(bits)] > 0, 2.0, -1.0)
        np.testing.assert_array_equal(at(s, times), expected)


def test_a_maximum_length_sequence_has_a_flat_spectrum():
    """All frequencies but 0 have the same power, to rounding; independent draws have not."""
    times = 0.5 * (np.arange(1023) + 0.5)
    data = {"kind": "prbs", "low": -1, "high": 1, "hold": 0.5, "seed": 4}
    power = np.abs(np.fft.rfft(at(signal(data | {"order": 10}), times)))[1:] ** 2
    np.testing.assert_allclose(power, 1024, rtol=1e-9)
    assert np.ptp(np.abs(np.fft.rfft(at(signal(data), times)))[1:] ** 2) > 1024


@pytest.mark.parametrize("phase", [0.0, 1.1])
def test_a_chirp_is_that_of_scipy_while_it_sweeps(phase: float):
    """scipy.signal.chirp is a cosine: a sine is the same 90° later; here the sweep begins at 1.5 s."""
    times = np.linspace(1.5, 9.4, 999)
    s = signal({"kind": "chirp", "amplitude": 2, "f0": 0.2, "f1": 3, "duration": 8, "offset": phase, "start": 1.5})
    np.testing.assert_allclose(
        at(s, times), phase + 2 * scipy.signal.chirp(times - 1.5, 0.2, 8, 3, phi=-90), rtol=0, atol=1e-11
    )


def test_noise_is_gaussian_white_and_depends_on_its_seed():
    """Kolmogorov–Smirnov, variance and lag-one correlation over 4000 draws; draws do not depend on their block."""

    def make(seed: int):
        return signal({"kind": "noise", "std": 0.5, "hold": 0.5, "seed": seed, "offset": 2})

    times = 0.25 + 0.5 * np.arange(4000)
    values = at(make(1), times)
    scaled = (values - 2) / 0.5
    assert scipy.stats.kstest(scaled, "norm").pvalue > 0.01
    assert abs(np.mean(scaled[1:] * scaled[:-1])) < 0.06 and abs(np.mean(scaled * (at(make(2), times) - 2))) < 0.03
    np.testing.assert_array_equal(at(make(1), times[1234:1300]), values[1234:1300])


@pytest.mark.parametrize("start", [-1e308, 1e308, 1e30, -1e30])
@pytest.mark.parametrize(
    "shape", [{"kind": "pulse", "low": 0, "high": 1, "width": 5e-4}, {"kind": "square", "amplitude": 1}]
)
def test_a_start_beyond_double_precision_ends_nothing(start: float, shape: dict):
    """Pulses and square waves that begin at absurd times have finite values, in no time."""
    if shape["kind"] == "pulse" or abs(start) <= 1e30:  # the schema of a square wave has no greater ones
        s = signal({**shape, "period": 1e-3, "start": start})
        assert len(s.breaks(0.0, 1.0)) <= 4000 and np.isfinite(at(s, np.linspace(0.0, 1.0, 50))).all()


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
