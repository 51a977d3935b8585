"""The comparison of observers on hand-made columns, faults and alarms with known results."""

from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.diagnosis.evaluation import observer_comparison
from thetascope.diagnosis.evaluation.observer_comparison import COVERED, FOUND, MISSED, MOST_WINDOWS, best, windows
from thetascope.engine.model.result import ObserverReport, Result
from thetascope.messages import Message
from thetascope_schemas.experiment.faults import Site

T = np.linspace(0, 100, 1001)
CHANNELS = ("a", "b")


def compare(result, faults):
    """Return the comparison of a hand-made result with its findings."""
    return observer_comparison.compare(result, faults, result.findings)


@dataclass
class Fault:
    """A step in a channel."""

    channel: str
    onset: float
    end: float | None = None
    size: float = 1.0
    shape: str = "step"

    @property
    def site(self) -> Site:
        """As the schemas have it."""
        return Site("channel", self.channel)


@dataclass
class Stuck:
    """A fault on a measurement."""

    output: str
    onset: float
    end: float | None = None
    shape: str = "stuck"

    @property
    def site(self) -> Site:
        """As the schemas have it."""
        return Site("output", self.output)


def alarm(
    t: float,
    channel: str = "",
    *alternatives: str,
    output: str = "",
    cleared: float | None = None,
    onset: float | None = None,
):
    """Return an alarm at t; its fault began at `onset` or later, by default at t."""
    return SimpleNamespace(
        id=f"{channel}{output}{t}",
        t=t,
        kind="fault" if channel else "unexplained",
        channel=channel,
        alternatives=alternatives,
        output=output,
        onset_from=t if onset is None else onset,
        cleared=cleared,
    )


def truth(faults, channel: str) -> np.ndarray:
    value = np.zeros(T.size)
    for f in faults:
        if f.site == ("channel", channel):
            value += f.size * ((f.onset <= T) & ((np.inf if f.end is None else f.end) > T))
    return value


def run(
    faults, alarms: dict | None = None, offsets: dict | None = None, estimated=CHANNELS, settle: float | None = None
):
    """Return a result whose observers have a constant error (label → offset) in every estimate."""
    offsets = offsets or {"one": 0.5}
    columns = {"t": T, "x.x": np.sin(T)} | {f"theta.{c}": truth(faults, c) for c in CHANNELS}
    for label, offset in offsets.items():
        columns[f"{label}.x.x"] = columns["x.x"] + offset
        columns |= {f"{label}.theta.{c}": columns[f"theta.{c}"] + offset for c in estimated}
    reports = tuple(ObserverReport(label, "kind", Message("observer.high-gain.title"), (), None) for label in offsets)
    result = Result(tuple(columns), np.array(list(columns.values())), reports, None, 0.1, 1, (), {}, {"one": 5e-5})
    calibration = None if settle is None else SimpleNamespace(from_time=settle)
    findings = {k: SimpleNamespace(alarms=v, calibration=calibration, note="") for k, v in (alarms or {}).items()}
    return SimpleNamespace(**vars(result), column=result.column, findings=findings)


def judged(faults, *alarms, **options):
    """Return the comparison's row of one observer with these alarms."""
    return compare(run(faults, {"one": alarms}, **options), faults).rows[0]


def outcomes(row) -> list:
    return [(v.name, v.outcome) for v in row.verdicts]


# ---- errors ----------------------------------------------------------------------------------------------------------


def test_errors_are_given_for_each_window_between_events():
    """Windows end at onsets and ends; a constant error is its own RMSE and peak in each."""
    faults = [Fault("a", 20, 50), Stuck("y", 70)]
    found = compare(run(faults, offsets={"one": -0.5}), faults)
    assert [(w.start, w.end) for w in found.windows] == [(0, 20), (20, 50), (50, 70), (70, 100)]
    (row,) = found.rows
    assert set(row.rmse) == set(row.peak) == {"x.x", "theta.a", "theta.b"}
    for errors in (*row.rmse.values(), *row.peak.values()):
        assert errors == pytest.approx((0.5,) * 4)


def test_rmse_and_peak_refer_to_the_window_only():
    """One wrong row of 200: peak 3 and RMSE 3/√200 there, zero in the neighbouring windows."""
    faults = [Fault("a", 20, 40)]
    result = run(faults, offsets={"one": 0.0})
    result.column("one.theta.a")[300] += 3.0
    (row,) = compare(result, faults).rows
    assert row.peak["theta.a"] == (0, 3, 0)
    assert row.rmse["theta.a"] == pytest.approx((0, 3 / np.sqrt(200), 0))


def test_an_observer_has_no_number_for_a_window_in_which_it_diverged():
    """It has other data than the others, so it cannot be the best there; rows without truth are ignored."""
    faults = [Fault("a", 50)]
    result = run(faults, offsets={"one": 0.1, "two": 0.2})
    result.column("one.x.x")[900:] = np.nan
    rows = compare(result, faults).rows
    assert rows[0].rmse["x.x"] == (pytest.approx(0.1), None)
    assert best([row.rmse["x.x"][1] for row in rows]) == frozenset()
    result.column("x.x")[800:] = np.nan
    assert compare(result, faults).rows[0].rmse["x.x"] == pytest.approx((0.1, 0.1))


def test_settling_times_to_ten_and_five_percent():
    """An error exp(−t) of a step is within 10 % after ln 10 and within 5 % after ln 20, to one row."""
    faults = [Fault("a", 20, size=2.0)]
    result = run(faults, offsets={"one": 0.0})
    result.column("one.theta.a")[200:] -= 2 * np.exp(-(T[200:] - 20))
    (step,) = compare(result, faults).rows[0].steps
    assert 0 <= step.ten - np.log(10) <= 0.1 and 0 <= step.five - np.log(20) <= 0.1
    assert (step.channel, step.at, step.size) == ("a", 20, 2)


def test_events_at_the_ends_of_the_run_make_no_empty_window():
    """A fault from 0 s on and one until the end make one event inside, and two windows."""
    faults = [Fault("a", 0, 100), Fault("b", 20, 150)]
    assert [(w.start, w.end) for w in windows(faults, T)] == [(0, 20), (20, 100)]
    assert [v.until for v in judged([*faults, Stuck("y", 30, 150)]).verdicts] == [None] * 3


def test_a_step_that_another_replaces_is_not_a_step():
    """One fault ends as the next of its size begins: θ does not change, so there is no settling."""
    faults = [Fault("a", 20, 50), Fault("a", 50)]
    assert [step.at for step in judged(faults).steps] == [20]


def test_the_number_of_windows_is_limited():
    """Of many events the closest are left out; the windows still cover the run."""
    found = windows([Fault("a", 0.5 * k, 0.5 * k + 0.1) for k in range(1, 150)], T)
    assert len(found) == MOST_WINDOWS
    assert found[0].start == 0 and found[-1].end == 100
    assert all(a.end == b.start for a, b in pairwise(found))


# ---- alarms ----------------------------------------------------------------------------------------------------------


def test_a_fault_is_found_by_the_first_alarm_that_names_it():
    """The delay counts from the onset; later alarms do not matter; the median is over faults found, one is missed."""
    faults = [Fault("a", 10, 20), Fault("b", 50), Fault("a", 70, 80), Fault("a", 90)]
    row = judged(
        faults,
        alarm(82, "b"),
        alarm(79, "a"),
        alarm(52, "b"),
        alarm(11.5, "a", cleared=22),
        alarm(15, "a", cleared=22),
        alarm(80.5, "a", cleared=85),
    )
    assert [v.delay for v in row.verdicts] == [1.5, 2.0, 9.0, None]
    assert (row.count(FOUND), row.delay) == (3, 2.0)


def test_an_alternative_finds_a_fault():
    """An alarm that names b or a finds a as an alternative, and is not an isolation error."""
    row = judged([Fault("a", 20)], alarm(22, "b", "a"))
    assert row.verdicts[0].outcome == FOUND and row.verdicts[0].alternative
    assert row.isolation_errors == 0


def test_naming_only_a_wrong_channel_is_an_isolation_error():
    """The fault in a is missed, and the alarm is not false, since there was a fault."""
    row = judged([Fault("a", 20)], alarm(22, "b"))
    assert outcomes(row) == [("a", MISSED)]
    assert (row.false_alarms, row.isolation_errors) == (0, 1)


def test_an_alarm_without_a_fault_is_false():
    """Before the fault begins, and after the grace that follows its end."""
    row = judged([Fault("a", 20, 40)], alarm(10, "a", cleared=12), alarm(21, "a"), alarm(60, "b"), settle=5)
    assert outcomes(row) == [("a", FOUND)]
    assert (row.false_alarms, row.isolation_errors, row.grace) == (2, 0, 5)


def test_the_grace_after_a_fault_is_the_settling_time_of_the_observer():
    """An alarm 4 s after the end is false for a settling time of 3 s, and not for 5 s."""
    faults = [Fault("a", 20, 40)]
    assert [judged(faults, alarm(44, "a"), settle=s).false_alarms for s in (3, 5)] == [1, 0]
    assert judged(faults, alarm(44, "b"), settle=5).isolation_errors == 1  # nothing was wrong with b
    assert judged(faults, alarm(44, "a")).false_alarms == 0  # without calibration: a twentieth of the run


def test_an_alarm_after_the_end_of_a_fault_comes_too_late():
    """The fault is missed, regardless of the grace."""
    assert outcomes(judged([Fault("a", 20, 22)], alarm(23, "a"))) == [("a", MISSED)]


def test_simultaneous_faults_have_separate_verdicts():
    """a and b are active: one alarm names a, none names b."""
    row = judged([Fault("a", 20), Fault("b", 20, 80)], alarm(21, "a"))
    assert outcomes(row) == [("a", FOUND), ("b", MISSED)]
    assert judged([Fault("a", 20), Fault("b", 20)], alarm(21, "a", "b")).count(FOUND) == 2


def test_a_second_fault_in_a_channel_needs_an_alarm_of_its_own_unless_one_is_on():
    """Alarm on at the second onset: covered. Cleared before: missed. Raised again: found."""
    faults = [Fault("a", 20, 40), Fault("a", 50)]
    assert outcomes(judged(faults, alarm(21, "a"))) == [("a", FOUND), ("a", COVERED)]
    assert outcomes(judged(faults, alarm(21, "a", cleared=45))) == [("a", FOUND), ("a", MISSED)]
    assert outcomes(judged(faults, alarm(21, "a"), alarm(51, "a"))) == [("a", FOUND), ("a", FOUND)]


def test_faults_that_cancel_are_not_a_fault():
    """A second step cancels the first: from then on no fault can be found, and an alarm is false."""
    row = judged([Fault("a", 20), Fault("a", 50, size=-1.0)], alarm(21, "a", cleared=51), alarm(80, "a"))
    assert outcomes(row) == [("a", FOUND)]
    assert row.false_alarms == 1


def test_a_fault_below_another_in_its_channel_continues_when_that_ends():
    """a is active from 20 s on, with an addition from 40 to 50 s: an alarm at 80 s is correct."""
    row = judged(
        [Fault("a", 20), Fault("a", 40, 50)], alarm(21, "a", cleared=39), alarm(41, "a", cleared=60), alarm(80, "a")
    )
    assert outcomes(row) == [("a", FOUND), ("a", FOUND)]
    assert (row.false_alarms, row.isolation_errors) == (0, 0)


def test_a_fault_of_a_measurement_is_found_by_an_alarm_that_the_model_does_not_explain():
    """An unexplained alarm on that output or on none in particular; naming a channel is an isolation error."""
    faults = [Stuck("y", 30, 60)]
    assert judged(faults, alarm(32, output="y")).verdicts[0].delay == 2
    assert judged(faults, alarm(32)).count(FOUND) == 1
    for wrong in (alarm(32, output="z"), alarm(32, "a")):
        row = judged(faults, wrong)
        assert (row.count(MISSED), row.isolation_errors) == (1, 1)


def test_of_two_faults_on_a_measurement_the_first_ends_at_the_second():
    """The first can only be found before the second begins."""
    assert outcomes(judged([Stuck("y", 20), Stuck("y", 50)], alarm(60))) == [("y", MISSED), ("y", FOUND)]


def test_a_fault_that_the_model_explains_must_be_named():
    """ "Not explained" is wrong for a channel that the observer estimates, and right for one that it does not."""
    faults = [Fault("a", 20)]
    assert judged(faults, alarm(22)).isolation_errors == 1
    row = judged(faults, alarm(22), estimated=("b",))
    assert outcomes(row) == [("a", FOUND)] and row.isolation_errors == 0


def test_without_tests_nothing_is_counted():
    """Without findings, or with a note that says why there are none, counts are null, not "all missed"."""
    faults = [Fault("a", 20)]
    result = run(faults)
    silent = {"one": SimpleNamespace(alarms=(), calibration=None, note="it estimates no faults")}
    for findings in ({}, silent):
        result.findings = findings
        (row,) = compare(result, faults).rows
        assert (row.verdicts, row.count(MISSED), row.false_alarms, row.isolation_errors) == (None,) * 4
    assert judged(faults).count(MISSED) == 1


TIMES = st.integers(0, 99).map(float)
FAULTS = st.lists(
    st.builds(Fault, st.sampled_from(CHANNELS), TIMES) | st.builds(Stuck, st.just("y"), TIMES), max_size=4
)
ALARMS = st.lists(st.builds(alarm, TIMES, st.sampled_from(["", *CHANNELS])), max_size=5, unique_by=lambda a: a.t)


@given(FAULTS, st.lists(ALARMS, min_size=3, max_size=3), st.permutations(["one", "two", "three"]))
def test_the_order_of_observers_affects_only_the_order_of_rows(faults, alarms, order):
    """Permuting the observers permutes the rows."""
    offsets = dict(zip(("one", "two", "three"), (0.1, 0.2, 0.3), strict=True))
    given_alarms = dict(zip(offsets, alarms, strict=True))
    straight = {row.label: row for row in compare(run(faults, given_alarms, offsets), faults).rows}
    permuted = compare(run(faults, given_alarms, {label: offsets[label] for label in order}), faults).rows
    assert list(permuted) == [straight[label] for label in order]


@given(FAULTS, ALARMS)
def test_every_fault_has_one_outcome_and_no_alarm_is_wrong_twice(faults, alarms):
    """Found, covered and missed add up; an alarm that found a fault is neither false nor an isolation error."""
    row = judged(faults, *alarms)
    assert sum(row.count(o) for o in (FOUND, COVERED, MISSED)) == len(row.verdicts) <= len(faults)
    right = {v.onset + v.delay for v in row.verdicts if v.delay is not None}
    assert row.false_alarms + row.isolation_errors <= len(alarms) - len(right)


def test_the_best_is_the_smallest_if_values_differ():
    """No best of one or of equal values; several within 1 % are best, also for negative numbers."""
    assert best([3.0, 1.0, None, 1.005, 1.02]) == {1, 3}
    assert best([-3, 0, -3]) == {0, 2} and best([0, 0, 1]) == {0, 1}
    assert best([1.0, None]) == best([2.0, 2.0]) == best([]) == frozenset()
