"""The detector: what it finds in runs whose faults are known, and what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

from backend import library
from backend.assembly import prepare
from backend.assembly.diagnosis import asked, calibration_key
from backend.assembly.trial import trial
from backend.diagnosis.detector import detector
from backend.engine.run import spans_of
from backend.engine.simulation import row_values
from shared import Experiment
from shared.diagnosis import Diagnosis


def changed(name: str, **changes) -> Experiment:
    """An experiment of the library, changed."""
    return Experiment.model_validate(library.experiment(name).model_dump(mode="json") | changes)


def told(spec: Experiment) -> Diagnosis:
    return Diagnosis.model_validate(prepare(spec).run().diagnosis)


def test_zhaos_faults_are_named_and_nothing_else_is():
    """Ten seeds, with three faults and with none: thirty named, none wrong, none false (README has a hundred)."""
    (ours, *_) = trial(prepare(library.experiment("zhao-2012")), 10).tallies
    assert (ours.without, ours.before, ours.wrong, sum(ours.found.values())) == (0, 0, 0, 30)


def test_friction_is_found_within_half_a_second():
    """Twenty seeds: no false alarm with the fault or without, found in all, by a median of at most 0.5 s."""
    (ours, *_) = trial(prepare(library.experiment("friction-motor")), 20).tallies
    assert (ours.without, ours.before, ours.wrong, ours.found) == (0, 0, 0, {"friction": 20})
    assert ours.delay <= 0.5


def test_noise_that_drowns_two_faults_is_said():
    """With the variance as printed θ1 and θ2 are not resolved: said beforehand, and nothing is claimed to be either alone."""
    found = told(library.experiment("zhao-2012-variance-as-printed")).detector
    resolved = {r.channel: r.resolvable for r in found.resolution}
    assert not resolved["theta1"] and not resolved["theta2"]
    for alarm in found.alarms:
        assert alarm.channel != "theta1" or "theta2" in alarm.alternatives
        assert alarm.channel != "theta2" or "theta1" in alarm.alternatives


def test_sizes_are_within_their_intervals_and_faults_end():
    """θ3 from 20 to 50 s: sized within three half-widths, cleared within 2 s of its end, nothing after it."""
    fault = {"channel": "theta3", "shape": "step", "onset": 20, "end": 50, "size": 0.02}
    (alarm,) = told(changed("zhao-2012", faults=[fault])).detector.alarms
    half = (alarm.size_to - alarm.size_from) / 2
    assert alarm.channel == "theta3" and abs(alarm.size - 0.02) < 3 * half
    assert 50 <= alarm.cleared < 52


@pytest.mark.parametrize("pieces", [7, 64, 1999])
def test_cutting_rows_changes_no_decision(pieces: int):
    """Rows taken in at once or a few at a time: the same findings, thresholds, and sums bit for bit."""
    spec = library.experiment("zhao-2012")
    spec = spec.with_plant(library.plant(spec.plant))
    experiment = prepare(spec).stages[0].experiment
    made = detector(experiment, experiment.context, asked(spec), calibration_key(spec))
    tables, times = [], []
    for _, rows in spans_of(replace(experiment, estimators=()), 1):
        tables.append(made.filter.table(rows.index, rows.y, row_values(experiment, rows.index, rows.plant)))
        times.append(rows.index * experiment.step)
    table, t = np.concatenate(tables)[:5000], np.concatenate(times)[:5000]
    whole = made.advance(made.begin(), table, t)
    cut = made.begin()
    for k in range(0, len(t), pieces):
        cut = made.advance(cut, table[k : k + pieces], t[k : k + pieces])
    assert cut.standing.found == whole.standing.found
    assert len(whole.standing.found) == 2
    assert np.array_equal(cut.sums.q[-50:], whole.sums.q[-50:]) and np.array_equal(cut.states[-1], whole.states[-1])


def test_readings_that_no_filter_survives_are_reported():
    """Outliers of 500 standard deviations drive the filter out of all numbers: the run is diagnosed, as unexplained."""
    fault = {"output": "y", "shape": "outliers", "onset": 30, "probability": 0.02, "size": 0.5, "sample_time": 0.1}
    found = told(changed("zhao-2012", faults=[fault], observers=[], figures=[])).detector.alarms
    assert found[0].kind == "unexplained" and found[0].output == "y.y" and found[0].t > 30


def test_a_noise_burst_is_no_fault_of_the_model():
    """Noise that grows fiftyfold for good: not explained, and no channel is blamed."""
    fault = {"output": "y", "shape": "noise-burst", "onset": 30, "std": 0.05, "sample_time": 0.01}
    found = told(changed("zhao-2012", faults=[fault], observers=[], figures=[])).detector.alarms
    assert found and {a.kind for a in found} == {"unexplained"} and 30 < found[0].t < 33
