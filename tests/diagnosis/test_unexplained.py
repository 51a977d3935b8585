"""Faults of the measurement that the model does not contain, distinguished from faults in its channels."""

import numpy as np
import pytest

from tests.diagnosis.watching import names, step, watching
from thetascope.diagnosis.detection.window_tests import WindowSums

ZHAO = {
    "stuck": {"value": 0.1},
    "freeze": {},
    "dropout": {"probability": 0.9, "sample_time": 0.1},
    "outliers": {"probability": 0.05, "size": 0.02, "sample_time": 0.01},
    "noise-burst": {"std": 0.005, "sample_time": 0.01},
    "quantisation": {"resolution": 0.01},
}
MOTOR = {
    "stuck": {"value": 150},
    "freeze": {},
    "dropout": {"probability": 0.9, "sample_time": 0.02},
    "outliers": {"probability": 0.03, "size": 20, "sample_time": 0.005},
    "noise-burst": {"std": 3, "sample_time": 0.005},
    "quantisation": {"resolution": 5},
    "delay": {"delay": 0.1},
}


@pytest.mark.parametrize("shape", ZHAO)
def test_a_failure_of_the_only_output_is_not_attributed_to_a_channel(shape):
    """It fails for 15 s: one alarm, not explained by the model, cleared soon after."""
    fault = {"output": "y", "shape": shape, "onset": 45, "end": 60} | ZHAO[shape]
    (found,) = watching("zhao-2012", [fault]).alarms(1)
    assert (found["kind"], found["output"]) == ("unexplained", "y.y")
    assert 45 < found["t"] < 48 and 60 <= found["cleared"] < 64


@pytest.mark.parametrize("shape", MOTOR)
def test_the_failing_output_of_two_is_named(shape):
    """It is named within 0.35 s and no channel is, although there is one for its bias."""
    fault = {"output": "y_speed", "shape": shape, "onset": 12, "end": 16} | MOTOR[shape]
    for seed in (1, 2):
        alarms = watching("dc-motor", [fault]).alarms(seed)
        assert set(names(alarms)) == {"y_speed"} and 12 < alarms[0]["t"] < 12.35
        assert 15.8 <= alarms[-1]["cleared"] < 17  # what is rounded may look right before it is


OTHERS = [
    ("dc-motor", "y_current", "noise-burst", {"std": 0.5, "sample_time": 0.005}, 12),
    ("dc-motor", "y_current", "freeze", {}, 12),
    ("dc-motor", "y_current", "stuck", {"value": 2.0}, 12),
    ("dc-motor", "y_current", "delay", {"delay": 0.1}, 12),
    ("dc-motor", "y_current", "outliers", {"probability": 0.03, "size": 3, "sample_time": 0.005}, 12),
    ("quadruple-tank", "y1", "freeze", {}, 800),
    ("quadruple-tank", "y1", "stuck", {"value": 5.0}, 800),
    ("quadruple-tank", "y1", "noise-burst", {"std": 0.3, "sample_time": 1.0}, 800),
    ("dts200", "y2", "freeze", {}, 800),
    ("dts200", "y2", "stuck", {"value": 20.0}, 800),
    ("dts200", "y2", "noise-burst", {"std": 0.3, "sample_time": 1.0}, 800),
]


@pytest.mark.parametrize(("name", "output", "shape", "more", "onset"), OTHERS)
def test_failing_outputs_of_other_plants(name, output, shape, more, onset):
    """Two seeds each: only the failing output is named, and it is trusted again afterwards."""
    end = onset * 4 // 3 if name == "dc-motor" else onset * 3 // 2
    for seed in (1, 2):
        alarms = watching(name, [{"output": output, "shape": shape, "onset": onset, "end": end} | more]).alarms(seed)
        assert set(names(alarms)) == {output} and alarms[0]["onset"] == pytest.approx(onset, rel=0.03)
        assert all(a["cleared"] is not None for a in alarms)


def test_a_fault_is_found_while_an_output_fails():
    """While the speed sensor is frozen, a fault that the current shows is found."""
    frozen = {"output": "y_speed", "shape": "freeze", "onset": 10, "end": None}
    alarms = watching("dc-motor", [frozen, step("gain_loss", 18, 0.3)]).alarms(1)
    assert names(alarms)[0] == "y_speed" and "gain_loss" in names(alarms)[1:]
    named = alarms[names(alarms).index("gain_loss")]
    assert 18 < named["t"] < 19 and named["size"] == pytest.approx(0.3, rel=0.1)


def test_readings_that_make_the_filter_diverge_are_reported():
    """Outliers of 500 standard deviations restart the filter, and are unexplained."""
    fault = {"output": "y", "shape": "outliers", "onset": 30, "probability": 0.02, "size": 0.5, "sample_time": 0.1}
    seen = watching("zhao-2012", [fault])
    assert seen.alarms(1)[0]["kind"] == "unexplained"
    assert np.isfinite(seen.watched(1).states[-1]).all()


def test_repeated_numbers_are_counted():
    """`repeats` counts rows equal to the one before, across blocks."""
    y = np.array([1.0, 1, 1, 2, 2, 3, 3, 3, 3])[:, None]
    none = WindowSums.empty(1, 1)
    whole = none.extended(np.zeros((8, 1, 1, 1)), np.zeros((8, 1, 1)), y=y)
    assert whole.repeats[:, 0].tolist() == [0, 1, 2, 0, 1, 0, 1, 2, 3]
    cut = none.extended(np.zeros((2, 1, 1, 1)), np.zeros((2, 1, 1)), y=y[:3])
    cut = cut.extended(np.zeros((6, 1, 1, 1)), np.zeros((6, 1, 1)), y=y[2:])
    np.testing.assert_array_equal(cut.repeats, whole.repeats)
