"""The curve of a signal in few points: true values, both limits at jumps, samples where it is fast."""

import numpy as np
import pytest

from thetascope.engine.inputs.curve import curve
from thetascope.engine.inputs.signals import signal

EVERY = [
    {"kind": "constant", "value": 0.08},
    {"kind": "steps", "times": [2, 5.5], "values": [1, -2, 3]},
    {"kind": "pulse", "low": -1, "high": 2, "period": 0.7, "width": 0.2, "start": 1.1},
    {"kind": "square", "amplitude": 2, "period": 1.7, "start": 4.1, "offset": 1},
    {"kind": "sine", "amplitude": 2, "frequency": 0.7, "phase": 0.3, "offset": 1},
    {"kind": "ramp", "start": 2, "slope": 0.5, "initial": 1, "end": 6},
    {"kind": "chirp", "amplitude": 2, "f0": 0.2, "f1": 1.4, "duration": 4, "start": 3},
    {"kind": "prbs", "low": -1, "high": 1, "hold": 0.3, "seed": 5},
    {"kind": "noise", "std": 0.5, "hold": 0.3, "seed": 5},
    {"kind": "table", "times": [1, 2, 4], "values": [3, 5, -1], "interpolation": "linear"},
    {"kind": "expression", "text": "sin(t) - exp(-t/3)*t^2"},
]


@pytest.mark.parametrize("data", EVERY, ids=lambda d: d["kind"])
@pytest.mark.parametrize(("start", "end"), [(0.0, 9.7), (3.21, 5.77)])
def test_lines_between_the_points_are_the_signal(data: dict, start: float, end: float):
    """At a thousand times; smooth shapes to half a per cent of their height, held ones exactly."""
    s = signal(data)
    t, values = curve(s, start, end, 200)
    assert (t[0], t[-1]) == (start, end) and (np.diff(t) >= 0).all() and len(t) <= 1200
    times = np.random.default_rng(1).uniform(start, end, 1000)
    near = 0.0 if s.held else 5e-3 * np.ptp(values)
    after = np.searchsorted(t, times, side="right")
    share = (times - t[after - 1]) / (t[after] - t[after - 1])
    drawn = values[after - 1] + share * (values[after] - values[after - 1])
    np.testing.assert_allclose(drawn, s(times, times), rtol=0, atol=near)


@pytest.mark.parametrize(
    "data",
    [
        {"kind": "sine", "amplitude": 2, "frequency": 4321.7, "offset": 1},
        {"kind": "square", "amplitude": 2, "period": 1e-3, "offset": 1},
        {"kind": "prbs", "low": -1, "high": 3, "hold": 1e-9},
        {"kind": "noise", "std": 1, "hold": 1e-12},
    ],
    ids=lambda d: d["kind"],
)
def test_a_signal_that_is_too_fast_for_its_columns_fills_them(data: dict):
    """Few points, from near the least to near the greatest value in every column; no time, no memory."""
    t, values = curve(signal(data), 0.0, 20.0, 100, data.get("hold", data.get("period")))
    assert len(t) <= 600 and np.isfinite(values).all()
    for low in np.arange(0.0, 20.0, 2.0):
        inside = values[(t >= low) & (t < low + 2.0)]
        assert np.ptp(inside) > 1.5
