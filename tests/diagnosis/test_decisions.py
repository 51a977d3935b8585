"""Decisions of the detector on library experiments: channel, onset, size and end of faults."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.watching import names, step, watching
from tests.runs.samples import spec_data
from thetascope import library
from thetascope.assembly import prepare
from thetascope.diagnosis.yield_points import run_to_end
from thetascope_schemas import Experiment


@pytest.fixture(scope="module")
def zhao():
    """Return the alarms of zhao-2012 for twenty seeds."""
    return [watching("zhao-2012").alarms(seed) for seed in range(1, 21)]


def test_the_three_faults_of_zhao_2012_are_identified(zhao):
    """In twenty seeds theta3, theta1 and theta2 are found within a second, without alternatives or other alarms."""
    for alarms in zhao:
        assert names(alarms) == ["theta3", "theta1", "theta2"]
        assert all(a["alternatives"] == () and a["cleared"] is None for a in alarms)
        assert all(0 <= a["t"] - onset < 1.5 for a, onset in zip(alarms, (20, 40, 70), strict=True))


def test_intervals_cover_the_truth(zhao):
    """Of sixty 95 % intervals of onsets and of sizes at least 90 % cover, and nearly all are narrow."""
    truth = [(20, 0.02), (40, 0.01), (70, 0.015)]
    pairs = [(a, t) for alarms in zhao for a, t in zip(alarms, truth, strict=True)]
    sizes = np.mean([a["size_from"] <= size <= a["size_to"] for a, (_, size) in pairs])
    onsets = np.mean([a["onset_from"] <= onset <= a["onset_to"] for a, (onset, _) in pairs])
    assert sizes >= 0.9 and onsets >= 0.9
    assert np.quantile([(a["size_to"] - a["size_from"]) / a["size"] for a, _ in pairs], 0.9) < 0.05
    assert max(a["onset_to"] - a["onset_from"] for a, _ in pairs) < 2.0


def test_friction_is_found_early_and_without_false_alarms():
    """Forty seeds of the tutorial's motor: no alarm without the fault, all found, median delay at most 0.5 s."""
    motor = watching("friction-motor")
    assert [motor.alarms(seed, faults=False) for seed in range(1, 41)] == [[]] * 40
    found = [motor.alarms(seed) for seed in range(1, 41)]
    assert all(names(a) == ["friction"] for a in found)
    assert np.median([a[0]["t"] - 10 for a in found]) <= 0.5


@pytest.mark.parametrize("name", ["dc-motor", "dts200", "quadruple-tank"])
def test_no_alarm_without_a_fault(name):
    """Five seeds of each plant without faults raise no alarm."""
    assert [watching(name).alarms(seed, faults=False) for seed in range(1, 6)] == [[]] * 5


def test_indistinguishable_faults_are_reported_as_such():
    """At the literal noise variance theta1 and theta2 are not resolvable, and they are named together."""
    result = prepare(library.resolve(library.experiment("zhao-2012-variance-as-printed"))).run()
    diagnosis = result.diagnosis["detector"]
    able = {r["channel"]: r["resolvable"] for r in diagnosis["resolution"]}
    assert able == {"theta1": False, "theta2": False, "theta3": True}
    later = [a for a in diagnosis["alarms"] if a["t"] > 40]
    assert later and all({a["channel"], *a["alternatives"]} >= {"theta1", "theta2"} for a in later)
    assert {a["text"]["code"] for a in later} == {"diagnosis.alarm.ambiguous"}


@pytest.mark.parametrize(
    ("name", "channel", "size", "onset", "end", "again"),
    [
        ("zhao-2012", "theta1", 0.01, 30, 50, 70),
        ("zhao-2012", "theta3", 0.02, 30, 50, 70),
        ("dc-motor", "gain_loss", 0.15, 6, 12, 18),
        ("dc-motor", "speed_bias", 5, 6, 12, 18),
        ("quadruple-tank", "leak1", 0.006, 600, 1200, 2000),
        ("dts200", "clog32", 0.3, 600, 1200, 2000),
    ],
)
def test_a_fault_that_ends_and_recurs(name, channel, size, onset, end, again):
    """There is one alarm each time, with the size of the fault; the first ends soon after the fault."""
    horizon = library.experiment(name).horizon
    seen = watching(name, [step(channel, onset, size, end=end), step(channel, again, size)])
    for seed in (1, 2):
        first, second = seen.alarms(seed)
        assert names([first, second]) == [channel, channel] and first["cleared"] and second["cleared"] is None
        assert end <= first["cleared"] <= end + 0.03 * horizon
        assert all(abs(a["size"] / size - 1) < 0.1 for a in (first, second))
        standing = seen.watched(seed).decisions
        assert np.count_nonzero(standing.known.level) == 1


@pytest.mark.parametrize(
    ("name", "one", "two"),
    [
        ("zhao-2012", ("theta1", 0.01), ("theta3", 0.02)),
        ("zhao-2012", ("theta2", 0.015), ("theta3", 0.02)),
        ("dc-motor", ("gain_loss", 0.15), ("current_bias", 0.5)),
        ("dc-motor", ("load_torque", 0.08), ("speed_bias", 10)),
        ("quadruple-tank", ("pump1", 0.1), ("level2", 0.2)),
        ("quadruple-tank", ("pump1", 0.1), ("pump2", 0.1)),
    ],
)
def test_two_simultaneous_faults(name, one, two):
    """Both are named with their sizes, and no other."""
    onset = 0.3 * library.experiment(name).horizon
    seen = watching(name, [step(c, onset, size) for c, size in (one, two)])
    for seed in (1, 2):
        alarms = seen.alarms(seed)
        assert sorted(names(alarms)) == sorted((one[0], two[0]))
        sizes = {a["channel"]: a["size"] for a in alarms}
        assert all(abs(sizes[c] / size - 1) < 0.15 for c, size in (one, two))


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("zhao-2012", {"channel": "theta1", "shape": "ramp", "onset": 30, "size": 0.02, "duration": 10}),
        ("zhao-2012", {"channel": "theta3", "shape": "exponential", "onset": 30, "size": 0.02, "time_constant": 5}),
        ("dc-motor", {"channel": "gain_loss", "shape": "ramp", "onset": 8, "size": 0.15, "duration": 3}),
        ("dc-motor", {"channel": "current_bias", "shape": "exponential", "onset": 8, "size": 0.6, "time_constant": 2}),
        ("quadruple-tank", {"channel": "level1", "shape": "ramp", "onset": 1000, "size": 0.3, "duration": 300}),
        ("quadruple-tank", {"channel": "pump2", "shape": "ramp", "onset": 1000, "size": 0.1, "duration": 300}),
        ("dts200", {"channel": "leak1", "shape": "ramp", "onset": 1000, "size": 0.06, "duration": 200}),
        ("dts200", {"channel": "flow2", "shape": "ramp", "onset": 1000, "size": 8, "duration": 200}),
        ("dts200", {"channel": "level2", "shape": "ramp", "onset": 1000, "size": 2, "duration": 200}),
    ],
)
def test_a_slow_fault_is_one_finding(name, fault):
    """A growing fault is named once, finally with the size that it has reached."""
    (found,) = watching(name, [fault]).alarms(1)
    assert found["channel"] == fault["channel"] and found["cleared"] is None
    assert abs(found["size"] / fault["size"] - 1) < 0.05


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("zhao-2012", {"channel": "theta1", "shape": "ramp", "onset": 30, "size": 0.02, "duration": 10}),
        ("dc-motor", {"channel": "current_bias", "shape": "exponential", "onset": 8, "size": 0.6, "time_constant": 2}),
    ],
)
def test_the_interval_of_a_slow_fault_covers_its_size(name, fault):
    """The shape is estimated, too: in at least seven of eight runs the narrow 95 % interval covers the size."""
    found = [
        next(a for a in watching(name, [fault]).alarms(seed) if a["channel"] == fault["channel"])
        for seed in range(1, 9)
    ]
    assert sum(a["size_from"] <= fault["size"] <= a["size_to"] for a in found) >= 7
    assert np.median([a["size_to"] - a["size_from"] for a in found]) < 0.1 * fault["size"]


@pytest.mark.parametrize("seed", [103, 130, 157])
def test_later_data_correct_early_findings(seed):
    """quadruple-tank: alternatives and wrong names of early findings are corrected; three faults remain."""
    stand = [a for a in watching("quadruple-tank").alarms(seed) if a["cleared"] is None]
    assert [a["channel"] for a in stand] == ["pump1", "level2", "leak1"] and not any(a["alternatives"] for a in stand)
    assert [a["size"] for a in stand] == pytest.approx([0.1, 0.2, 0.006], rel=0.05)


@pytest.mark.parametrize("onset", [8.01, 8.17])
def test_onsets_are_found_to_the_row(onset):
    """The onset of a large sensor fault between two decisions is found to a row."""
    (found,) = watching("zhao-2012", [step("theta3", onset, 0.02)]).alarms(2)
    assert names([found]) == ["theta3"] and found["onset"] == pytest.approx(onset, abs=0.011)


def test_a_fault_from_the_start():
    """A fault that is present from the start is found with its size."""
    first = watching("zhao-2012", [step("theta1", 0.5, 0.01)]).alarms(1)
    assert names(first) == ["theta1"] and first[0]["t"] < 4 and first[0]["size"] == pytest.approx(0.01, rel=0.05)


@cache
def at_one_go(kind: str):
    """Return a detector, rows and their times, and the monitor after all of them."""
    faults = {
        "own": None,
        "stuck": [{"output": "y", "shape": "stuck", "onset": 45, "end": 60, "value": 0.1}],
        "ramp": [{"channel": "theta1", "shape": "ramp", "onset": 30, "size": 0.02, "duration": 10}],
    }[kind]
    made = watching("zhao-2012", faults).made
    table, t = watching("zhao-2012", faults).rows(3)
    return made, table, t, run_to_end(made.advance(made.begin(), table, t))


@given(st.lists(st.integers(1, 700), min_size=1, max_size=30), st.sampled_from(["own", "stuck", "ramp"]))
@settings(max_examples=6)
def test_cutting_rows_changes_no_decision(pieces, kind):
    """Rows in blocks of any length give the same findings and the same filter, bit for bit."""
    made, table, t, whole = at_one_go(kind)
    cut, at, k = made.begin(), 0, 0
    while at < len(t):
        rows = slice(at, at + pieces[k % len(pieces)])
        cut = run_to_end(made.advance(cut, table[rows], t[rows]))
        at, k = at + pieces[k % len(pieces)], k + 1
    assert repr(cut.decisions.findings) == repr(whole.decisions.findings)
    np.testing.assert_array_equal(cut.states[-1], whole.states[-1])
    np.testing.assert_array_equal(cut.decisions.known.level, whole.decisions.known.level)


@pytest.mark.parametrize("row", [7413, 7626, 8265])
def test_faults_that_end_together_keep_their_sizes(row):
    """All three faults of zhao-2012 end together: each alarm ends within ten seconds,
    and nothing remains unexplained."""
    end = row * 0.01
    faults = [
        step(c, onset, size, end=end)
        for c, onset, size in (("theta3", 20, 0.02), ("theta1", 40, 0.01), ("theta2", 70, 0.015))
    ]
    alarms = watching("zhao-2012", faults, horizon=end + 10, diagnosis={"span": 100}).alarms(1)
    assert not [a for a in alarms if a["cleared"] is None]
    for channel, size in (("theta3", 0.02), ("theta1", 0.01), ("theta2", 0.015)):
        assert next(a for a in alarms if a["channel"] == channel)["size"] == pytest.approx(size, rel=0.03)


@pytest.mark.parametrize(
    ("frequency", "evaluate", "refused"), [(2.0, 0.3, True), (0.05, 0.3, False), (2.0, 0.01, False)]
)
def test_undersampled_inputs_are_refused_with_the_remedy(frequency, evaluate, refused):
    """A sine of less than two rows per period is refused; a slower one, or shorter rows, are accepted."""
    data = spec_data(
        horizon=60,
        evaluate=evaluate,
        inputs={"u": {"kind": "sine", "amplitude": 1, "frequency": frequency}},
        observers=[],
    )
    diagnosis = prepare(library.resolve(Experiment.model_validate(data))).run().diagnosis["detector"]
    note = diagnosis["note"]
    assert (note is not None) == refused
    if refused:
        assert (note["code"], note["args"]) == ("diagnosis.none.undersampled", {"signal": "u", "interval": evaluate})
