"""Measures of the estimates against closed forms."""

import json

import numpy as np
import pytest

from thetascope.diagnosis.evaluation import metrics


@pytest.fixture
def run(experiment, result):
    spec = experiment()
    return result(spec), spec


def test_settling_time_of_an_exponential(run):
    """An error exp(−rate·t) of a step stays within 10 % after ln(10)/rate, to one recorded row."""
    outcome, spec = run
    summary = metrics.summary(outcome, spec.faults)
    for label, rate in (("adaptive", 1.2), ("slow", 0.3)):
        found = {entry["channel"]: entry["time"] for entry in summary[label]["settling"]}
        assert set(found) == {"theta1", "theta2", "theta3"}
        assert all(0 <= time - np.log(10) / rate <= 0.01 for time in found.values())


def test_rmse_of_a_known_error(run):
    """RMSE of 0.05·exp(−rate·t) over [0, 100] is 0.05/√(200·rate)."""
    outcome, _ = run
    found = metrics.state_rmse(outcome, "adaptive")
    assert found["x1"] == pytest.approx(0.05 / np.sqrt(2 * 1.2 * 100), rel=0.01)
    assert metrics.state_rmse(outcome, "adaptive", last=0.1)["x1"] < 1e-15


def test_noise_that_leaves_the_band_has_not_settled():
    """An estimate whose noise leaves the band until the end reaches it, but does not settle."""
    t = np.arange(0, 10, 0.01)
    error = np.where(t < 2, 1.0, 0.0) + 0.5 * (np.arange(t.size) % 50 == 0)
    assert metrics.settling_time(t, error, 0, np.inf, 0.1) is None
    assert metrics.reaching_time(t, error, 0, np.inf, 0.1) == pytest.approx(2.01)


def test_a_step_is_judged_until_the_next_event():
    """The effect of a later fault does not count against the earlier step."""
    t = np.arange(0, 10, 0.01)
    error = np.where((t < 2) | (t >= 6), 1.0, 0.0)
    assert metrics.settling_time(t, error, 0, 6.0, 0.1) == pytest.approx(2.0)
    assert metrics.settling_time(t, error, 0, np.inf, 0.1) is None


def test_the_end_of_a_step_is_a_step_too(experiment):
    """A step that ends makes two changes; ramps and measurement faults make none."""
    spec = experiment(
        faults=[
            {"channel": "theta1", "shape": "step", "onset": 10, "end": 30, "size": 1},
            {"channel": "theta2", "shape": "ramp", "onset": 5, "size": 1, "duration": 3},
            {"output": "y", "shape": "freeze", "onset": 50},
        ]
    )
    assert metrics.step_changes(spec.faults, 100.0) == [("theta1", 10), ("theta1", 30)]
    assert metrics.event_times(spec.faults) == [5, 10, 30, 50]


def test_diverged_observers_have_numbers_up_to_the_divergence(experiment, result):
    """After it the final estimate is null, the RMSE is of the finite rows, and all of it is JSON."""
    spec = experiment()
    summary = metrics.summary(result(spec, lost={"slow": 50.0}), spec.faults)
    assert summary["slow"]["theta"]["theta1"]["estimate"] is None
    assert summary["slow"]["rmse"]["x1"] > 0 and summary["slow"]["diverged"] == {
        "time": 50.0,
        "cause": "Υ grew without bound: A − KC is not stable along this run",
    }
    assert summary["slow"]["settling"][-1]["time"] is None
    json.dumps(summary, allow_nan=False)


def test_final_values_over_the_last_tenth(run):
    """Truth, estimate and error at the end; mean and standard deviation of the error over the last tenth."""
    outcome, _ = run
    final = metrics.final_values(outcome, "adaptive")["theta3"]
    assert final["truth"] == 0.02 and final["error"] == pytest.approx(0, abs=1e-12) and final["std"] < 1e-12
