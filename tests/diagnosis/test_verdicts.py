"""Verdicts on faults and alarms: the rules of verdicts.py, case by case and at their limits."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from thetascope.diagnosis.evaluation.verdicts import fault_ids, judge, presences
from thetascope_schemas.experiment.faults import Site

OWN = {"a", "b"}


@dataclass
class Fault:
    """A step in a channel, or a fault on an output."""

    name: str
    onset: float
    end: float | None = None
    kind: str = "channel"
    shape: str = "step"

    @property
    def site(self) -> Site:
        """As the schemas have it."""
        return Site(self.kind, self.name)


def alarm(t, channel="", *alternatives, output="", onset=None, cleared=None):
    """Return an alarm raised at t whose fault began at `onset` or later, by default at t."""
    return SimpleNamespace(
        id=f"{channel}{output}-{t:g}",
        t=t,
        kind="fault" if channel else "unexplained",
        channel=channel,
        alternatives=alternatives,
        output=output,
        onset_from=t if onset is None else onset,
        cleared=cleared,
    )


def judged(faults, *alarms, grace=0.0, horizon=100.0, zero=()):
    """Return the judgement at the horizon; θ of the channels in `zero` is zero."""
    present = presences(faults, horizon, lambda channel, start, end: channel not in zero)
    return judge(alarms, faults, present, OWN, grace)


def outcome(faults, *alarms, **options):
    """Return outcome and delay of the first fault."""
    first = judged(faults, *alarms, **options).faults[0]
    return first.outcome, first.delay


def verdict(faults, *alarms, **options):
    """Return the verdict on the first alarm."""
    return judged(faults, *alarms, **options).alarms[0].verdict


# ---- the two cases that had two answers ------------------------------------------------------------------------------


def test_a_late_alarm_finds_a_fault_if_its_estimated_onset_lies_within():
    """A fault from 20 to 25 s, an alarm at 26 s with onset 20.1 s: found after 6 s, and not a false alarm."""
    result = judged([Fault("a", 20, 25)], alarm(26, "a", onset=20.1, cleared=27))
    assert (result.faults[0].outcome, result.faults[0].delay) == ("found", 6)
    assert result.faults[0].alarm == "a-26"
    assert result.alarms[0].verdict == "correct"
    assert result.alarms[0].found == ("a@20.0",)


def test_a_late_alarm_with_a_later_onset_does_not_find_the_fault():
    """The same alarm with an onset at or after the end of the fault refers to something else."""
    assert outcome([Fault("a", 20, 25)], alarm(26, "a", onset=25)) == ("missed", None)
    assert outcome([Fault("a", 20, 25)], alarm(26, "a", onset=24.9)) == ("found", 6)
    assert verdict([Fault("a", 20, 25)], alarm(26, "a", onset=25.5)) == "false"


def test_a_fault_is_not_covered_by_an_alarm_that_has_its_channel_as_an_alternative():
    """An alarm since 10 s for a, alternatively b: a fault in b at 20 s is missed. As the first choice, b is covered."""
    faults = [Fault("b", 20)]
    assert outcome(faults, alarm(10, "a", "b")) == ("missed", None)
    assert outcome(faults, alarm(10, "b", "a")) == ("covered", None)


def test_an_alternative_finds_a_fault_that_began_before_the_alarm():
    """For an alarm after the onset, the alternatives are possible causes of this change."""
    result = judged([Fault("b", 20)], alarm(21, "a", "b"))
    assert (result.faults[0].outcome, result.faults[0].delay, result.faults[0].alternative) == ("found", 1, True)
    assert not judged([Fault("b", 20)], alarm(21, "b", "a")).faults[0].alternative


# ---- limits ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("t", "expected"),
    [(19.9, ("covered", None)), (20, ("found", 0)), (39.9, ("found", pytest.approx(19.9))), (40, ("missed", None))],
)
def test_a_fault_is_found_from_its_onset_to_before_its_end(t, expected):
    """At the onset it can be found, at the end not; an earlier alarm that stays on covers it."""
    assert outcome([Fault("a", 20, 40)], alarm(t, "a")) == expected


@pytest.mark.parametrize(
    ("cleared", "expected"), [(19.9, "missed"), (20, "missed"), (20.1, "covered"), (None, "covered")]
)
def test_an_alarm_covers_a_fault_only_if_it_is_still_on_at_the_onset(cleared, expected):
    """An alarm cleared at the onset does not cover: from then on it can be raised again."""
    assert outcome([Fault("a", 20)], alarm(10, "a", cleared=cleared))[0] == expected


def test_a_fault_that_is_found_is_not_covered():
    """An alarm on since before the onset does not change that another one found the fault."""
    result = judged([Fault("a", 20)], alarm(10, "a"), alarm(23, "a"))
    assert [(f.outcome, f.alarm) for f in result.faults] == [("found", "a-23")]


def test_only_the_first_alarm_finds_a_fault():
    """Alarms may be in any order; a later one is correct, but finds nothing."""
    result = judged([Fault("a", 20)], alarm(25, "a"), alarm(22, "a", cleared=24))
    assert (result.faults[0].delay, result.faults[0].alarm) == (2, "a-22")
    assert [(a.id, a.verdict, a.found, a.delay) for a in result.alarms] == [
        ("a-22", "correct", ("a@20.0",), 2),
        ("a-25", "correct", (), None),
    ]


@pytest.mark.parametrize(("t", "expected"), [(19.9, "false"), (20, "correct"), (45, "correct"), (45.1, "false")])
def test_an_alarm_is_false_before_the_fault_and_after_the_grace(t, expected):
    """The grace of 5 s begins at the end of the fault at 40 s."""
    assert verdict([Fault("a", 20, 40)], alarm(t, "a", onset=max(t, 40.5)), grace=5) == expected


def test_an_alarm_whose_onset_reaches_back_into_a_fault_is_not_false():
    """Raised 20 s after the fault without grace, it refers to the time of the fault and is correct or an isolation
    error."""
    faults = [Fault("a", 20, 40)]
    assert verdict(faults, alarm(60, "a", onset=39)) == "correct"
    assert verdict(faults, alarm(60, "b", onset=39)) == "isolation-error"
    assert verdict(faults, alarm(60, "b", onset=41)) == "false"


def test_one_alarm_may_find_two_faults_and_its_delay_is_from_the_newer():
    """a at 20 s and b at 22 s, neither named before the alarm at 25 s that names both."""
    result = judged([Fault("a", 20), Fault("b", 22)], alarm(25, "a", "b"))
    assert (result.alarms[0].found, result.alarms[0].delay) == (("a@20.0", "b@22.0"), 3)
    assert [f.delay for f in result.faults] == [5, 3]


def test_counts_are_sums_of_verdicts():
    """One found, one missed, one false alarm and one isolation error."""
    result = judged([Fault("a", 20, 30), Fault("b", 50)], alarm(10, "b", cleared=12), alarm(21, "a"), alarm(55, "a"))
    counts = {v: result.count(v) for v in ("found", "missed", "covered", "correct", "false", "isolation-error")}
    assert counts == {"found": 1, "missed": 1, "covered": 0, "correct": 1, "false": 1, "isolation-error": 1}


# ---- measurements ----------------------------------------------------------------------------------------------------


def test_a_fault_on_an_output_is_named_by_its_name_with_or_without_the_prefix():
    """The detector names the column y.speed, a fault the output speed; no output matches any."""
    faults = [Fault("speed", 20, kind="output")]
    assert outcome(faults, alarm(21, output="y.speed")) == ("found", 1)
    assert outcome(faults, alarm(21)) == ("found", 1)
    assert outcome(faults, alarm(21, output="y.torque")) == ("missed", None)
    assert outcome(faults, alarm(21, "a")) == ("missed", None)


# ---- presence and ids ------------------------------------------------------------------------------------------------


def test_a_fault_whose_theta_is_zero_is_not_present():
    """It cannot be found, and an alarm for it is false."""
    result = judged([Fault("a", 20)], alarm(21, "a"), zero=("a",))
    assert result.faults == () and result.alarms[0].verdict == "false"


def test_a_fault_counts_from_its_onset_on_and_an_end_that_is_not_reached_does_not():
    """Judged at 20 s a fault of 20 s is in the future; at 40 s a fault until 40 s is active."""
    for kind in ("channel", "output"):
        faults = [Fault("a", 20, 40, kind)]
        assert judged(faults, horizon=20).faults == ()
        assert judged(faults, horizon=40).faults[0].until is None
        assert judged(faults, horizon=40.1).faults[0].until == 40


def test_a_fault_id_follows_from_site_and_onset():
    """Clearing does not change it; equal faults are counted; removing another fault changes no id."""
    faults = [Fault("b", 5), Fault("a", 20.5), Fault("a", 20.5)]
    assert fault_ids(faults) == ("b@5.0", "a@20.5", "a@20.5#2")
    assert fault_ids([Fault("a", 20.5, end=30)]) == ("a@20.5",)


# ---- state at the time of judging ------------------------------------------------------------------------------------


def state(faults, *alarms, **options):
    """Return the state of the first alarm."""
    return judged(faults, *alarms, **options).alarms[0].state


def test_the_states_of_an_alarm():
    """Each state once: its fault is active, another one is, it has ended, there never was one, the alarm is cleared."""
    faults = [Fault("a", 20, 40)]
    assert state(faults, alarm(21, "a"), horizon=30) == "acting"
    assert state(faults, alarm(21, "b", "a"), horizon=30) == "acting"
    assert state(faults, alarm(21, "b"), horizon=30) == "other-fault"
    assert state(faults, alarm(21, "a"), horizon=50) == "fault-over"
    assert state(faults, alarm(21, "b"), horizon=50) == "fault-over"
    assert state(faults, alarm(10, "a"), horizon=15) == "no-fault"
    assert state(faults, alarm(21, "a", cleared=25), horizon=30) == "cleared"


def test_an_alarm_that_outlives_its_fault_covers_the_next_one_in_its_channel():
    """The alarm states this, with the time, while that fault is active; it found the first."""
    faults = [Fault("a", 20, 40), Fault("a", 45, 60)]
    first = judged(faults, alarm(21, "a"), horizon=50).alarms[0]
    assert (first.state, first.covers_since, first.found) == ("covering", 45, ("a@20.0",))
    later = judged(faults, alarm(21, "a"), horizon=70).alarms[0]
    assert (later.state, later.covers_since) == ("fault-over", None)


def test_of_two_covered_faults_the_newer_is_reported():
    """An unexplained alarm for no output in particular covers faults on two of them, of 20 and 30 s, both active."""
    faults = [Fault("y1", 20, kind="output"), Fault("y2", 30, kind="output")]
    assert judged(faults, alarm(10), horizon=35).alarms[0].covers_since == 30


def test_a_verdict_refers_to_the_newer_fault_in_a_channel():
    """At 40 s a second fault begins in a channel with an active one: the alarm of 41 s found the second."""
    result = judged([Fault("a", 20), Fault("a", 40)], alarm(41, "a"))
    assert [(f.id, f.outcome) for f in result.faults] == [("a@20.0", "missed"), ("a@40.0", "found")]


def test_a_fault_below_another_in_its_channel_stays_active():
    """a from 20 s on, an addition from 40 to 50 s: at 45 and at 60 s the alarm of 21 s still has its fault."""
    faults = [Fault("a", 20), Fault("a", 40, 50)]
    assert [state(faults, alarm(21, "a", onset=20), horizon=t) for t in (30, 45, 60)] == ["acting"] * 3
