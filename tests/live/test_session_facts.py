"""The facts of a session: the state at the row that is shown, and verdicts equal to those of the run of its spec."""

from dataclasses import replace

import pytest

from tests.live import stage as stage_of_tests
from tests.live.session.test_session import do, zhao
from tests.live.stage import Stage, staged
from thetascope import library
from thetascope.assembly import prepare
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.engine.inputs.fault_signals import theta
from thetascope.live.facts.past_facts import past_facts
from thetascope.live.facts.session_facts import FactsMemory, facts_of
from thetascope.live.session.session import Session
from thetascope.runs.results.summary import summarise

FAULT = {"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02}
NOISE = {"y": {"std": 0.001, "sample_time": 0.01}}


def facts_now(session: Session):
    """Return the facts at the newest row."""
    return facts_of(session, session.row, FactsMemory(session.record))


def summary_of_run(session: Session):
    """Return the summary of the session's spec as a run up to the newest row."""
    t = (session.row - 1) * session.record
    spec = session.spec.model_copy(update={"horizon": t, "record": session.record})
    return summarise(prepare(spec).run(), spec)


def test_the_verdicts_of_a_session_are_those_of_the_run_of_its_spec():
    """Faults found, cleared, injected again and changed: outcome, delay, alarm ids and the sentence are the run's."""
    session = Session(zhao(noise=NOISE))
    session.advance(1500)
    do(session, "inject", fault=FAULT)
    session.advance(1000)
    do(session, "clear", channel="theta3")
    session.advance(700)
    do(session, "inject", fault=FAULT | {"channel": "theta1", "size": 0.05})
    session.advance(800)
    live = facts_now(session)
    run = summary_of_run(session).facts
    assert [f.outcome for f in live.fault_outcomes] == ["found", "found"]
    assert live.fault_outcomes == run.fault_outcomes
    assert live.alarm_verdicts == run.alarm_verdicts
    assert live.undetected == run.undetected == ()
    assert live.summary == run.summary and live.summary.code == "diagnosis.summary.one-found"
    assert live.observers == run.observers and live.faults == run.faults and live.noise == run.noise


def test_a_fault_injected_while_paused_is_active_immediately():
    """At the newest row it is active and not found yet; its id is in the log."""
    session = Session(zhao(noise=NOISE))
    session.advance(1500)
    before = facts_now(session)
    do(session, "inject", fault=FAULT)
    now = facts_now(session)
    assert before.faults == () and before.summary.code == "diagnosis.summary.quiet"
    (fault,) = now.faults
    assert fault.active and now.undetected == (fault.id,) and now.summary.code == "diagnosis.summary.looking"
    assert session.log[-1].fault == fault.id


def test_observers_gains_and_noise_are_those_of_the_shown_row():
    """Also at times before later commands: two commands, three states."""
    session = Session(zhao())
    session.advance(100)
    do(session, "set-gain", observer="adaptive", gain="rho", value=9)
    session.advance(100)
    do(session, "set-noise", output="y", std=0.003)
    do(session, "add-observer", observer={"label": "ekf", "kind": "joint-ekf"})
    session.advance(100)
    memory = FactsMemory(session.record)
    early, middle, late = (facts_of(session, row, memory) for row in (50, 150, 250))
    assert [f.observers[0].gains.get("rho") == 9 for f in (early, middle, late)] == [False, True, True]
    assert [len(f.observers) for f in (early, middle, late)] == [1, 1, 2]
    assert late.observers[1].since == pytest.approx(200 * session.record)
    assert middle.noise == early.noise != late.noise and late.noise["y"].std == 0.003


def test_an_alarm_is_on_until_the_row_at_which_it_clears_is_shown():
    """Judged at an earlier row, a cleared alarm is still on and a later one does not exist."""
    session = Session(zhao(noise=NOISE))
    session.advance(1500)
    do(session, "inject", fault=FAULT)
    session.advance(1000)
    do(session, "clear", channel="theta3")
    session.advance(1000)
    (alarm,) = facts_now(session).alarms
    assert alarm.cleared is not None
    memory = FactsMemory(session.record)
    row = round(alarm.cleared / session.record)
    assert facts_of(session, row, memory).alarms[0].cleared is None
    assert facts_of(session, row + 1, memory).alarms[0].cleared == alarm.cleared
    assert facts_of(session, round(alarm.t / session.record), memory).alarms == ()


def test_intervals_of_zero_theta_are_found_as_rows_arrive():
    """A ramp that begins late in an interval is found when its rows exist; a replaced signal is evaluated again."""
    memory = FactsMemory(0.01)
    late = {"channel": "a", "shape": "table", "times": [0, 9], "values": [0, 1], "onset": 0}
    signal = theta("a", [late], 0)
    assert not memory.nonzero(signal, "a", 0.0, 5.0)
    assert memory.nonzero(signal, "a", 0.0, 20.0)
    assert not memory.nonzero(theta("a", [late | {"values": [0, 0]}], 0), "a", 0.0, 20.0)
    assert memory.nonzero(signal, "a", 0.001, 0.002), "no row at all"


def test_a_room_sends_the_facts_when_they_change_and_only_then():
    """With hello, when tests begin, when a planned fault begins, after a command and after going back;
    not otherwise."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        planned = page.texts[0]["facts"]["faults"]
        assert [fault["active"] for fault in planned] == [False]
        await stage.say(page, "play")
        await stage.go(0.4)
        assert [one["facts"]["summary"]["code"] for one in page.of("facts")] == ["diagnosis.summary.quiet"]
        await stage.go(0.4)
        begun = page.of("facts")[1]
        assert begun["facts"]["faults"][0]["active"] and begun["facts"]["t"] == pytest.approx(0.5, abs=0.03)
        await stage.say(page, "set-noise", output="y", std=0.5)
        assert page.of("facts")[-1]["facts"]["noise"]["y"]["std"] == 0.5
        await stage.say(page, "seek", t=0.2)
        back = page.of("facts")[-1]["facts"]
        assert not back["faults"][0]["active"] and back["noise"] == page.texts[0]["facts"]["noise"]

    staged(scenario)


def test_a_room_sends_an_alarm_with_its_verdict_when_its_row_is_shown():
    """Rows are computed and judged ahead: the facts follow the event within a few rows."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        for _ in range(30):
            await stage.go(0.05)
        (event,) = [event for event in page.of("event") if event["kind"] == "alarm"]
        first = next(one["facts"] for one in page.of("facts") if one["facts"]["alarms"])
        assert first["alarms"][0]["id"] == event["value"]["id"] == first["alarm_verdicts"][0]["id"]
        assert 0 <= first["t"] - event["t"] < 0.15
        assert first["fault_outcomes"][0]["alarm"] == event["value"]["id"] and first["undetected"] == []

    staged(scenario)


def test_the_divergence_of_the_plant_is_reported_with_the_last_row(monkeypatch):
    """The run of this experiment escapes at 2.517 s: the facts say so when the last row has been shown, and time has
    ended."""
    given = library.experiment("reduced-order-mimo")
    given = given.with_plant(library.plant(given.plant))
    monkeypatch.setattr(stage_of_tests, "spec", lambda **_: given)

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "speed", value=None)
        await stage.say(page, "play")
        await stage.go(4.0)
        last = page.of("facts")[-1]
        assert last["row"] == page.of("status")[-1]["row"] and page.of("status")[-1]["ended"]
        assert last["facts"]["broken"] == pytest.approx(2.516, abs=0.002)
        assert last["facts"]["summary"]["code"] == "diagnosis.summary.broken"

    staged(scenario)


def test_facts_keep_alarms_while_the_detector_catches_up():
    """Going back takes the detector to an earlier row: alarms of the log stay found until it has tested the rows
    again."""
    session = Session(zhao(noise=NOISE))
    session.leave_detection()
    memory = FactsMemory(session.record)

    def catch_up() -> None:
        progress = session.pending_detection()
        assert progress is not None
        session.add_detection(progress, run_to_end(session.detector.catch_up(progress)))

    session.advance(1500)
    catch_up()
    do(session, "inject", fault=FAULT)
    session.advance(100)
    catch_up()
    found = facts_of(session, session.row, memory)
    assert found.summary.code == "diagnosis.summary.one-found" and found.alarms[0].t < 15.3
    do(session, "seek", t=15.5)
    do(session, "inject", fault={"output": "y", "shape": "stuck", "onset": 0, "value": 0.1})
    assert session.pending_detection() is not None
    waiting = facts_of(session, session.row, memory)
    assert [alarm.id for alarm in waiting.alarms] == [alarm.id for alarm in found.alarms]
    assert waiting.summary.code == "diagnosis.summary.not-judged-beside" and waiting.judged is not None
    assert facts_of(session, session.row, FactsMemory(session.record)).alarms == ()  # without the memory it is lost
    catch_up()
    assert facts_of(session, session.row, memory).alarms[0].id == found.alarms[0].id


def test_the_facts_tell_up_to_where_rows_are_judged_while_the_detector_is_behind():
    """Rows wait: the facts name the time and say so of a fault after it; batch by batch it grows, then it is gone."""
    session = Session(zhao(noise=NOISE))
    session.leave_detection()
    session.advance(1500)
    do(session, "inject", fault=FAULT)
    judged = []
    for _ in range(4):
        session.advance(100)
    while (progress := session.pending_detection()) is not None:
        facts = facts_now(session)
        judged.append(facts.judged)
        assert facts.summary.code == "diagnosis.summary.not-judged" or facts.judged > 15
        first = progress.beginning(150)
        session.add_detection(first, run_to_end(session.detector.catch_up(first)))
    assert judged == pytest.approx([0, 15, 16, 17, 18], abs=0.051)
    caught_up = facts_now(session)
    assert caught_up.judged is None and caught_up.summary.code == "diagnosis.summary.one-found"


def test_the_past_is_shown_as_it_was():
    """At rows of the past, and by the log alone: the alarms, verdicts and sentence that were sent at that time."""
    session, known = Session(zhao(noise=NOISE)), {}
    memory = FactsMemory(session.record)

    def advance(rows: int) -> None:
        known[session.row] = facts_of(session, session.row, memory)  # a command acts from this row on
        for _ in range(rows // 50):
            session.advance(50)
            known[session.row] = facts_of(session, session.row, memory)

    advance(1500)
    do(session, "inject", fault=FAULT)
    advance(600)
    do(session, "inject", fault=FAULT | {"channel": "theta1", "size": 0.05})
    advance(600)
    do(session, "clear", channel="theta3")
    advance(600)
    codes = set()
    for row, then in known.items():
        past = past_facts(session, row)
        assert [(a.id, a.channel, a.t, a.cleared) for a in past.alarms] == [
            (a.id, a.channel, a.t, a.cleared) for a in then.alarms
        ]
        assert past.alarm_verdicts == then.alarm_verdicts and past.undetected == then.undetected
        assert past.summary.code == then.summary.code and past.noise == then.noise
        codes.add(past.summary.code)
    assert len(codes) >= 4, "the session has several situations"


def test_rows_wait_for_a_diagnosis_that_cannot_follow():
    """Nothing is tested: time stops two seconds after the last tested row, and runs on when rows have been tested."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        test, waiting = stage._watch, []
        stage.room.services = replace(stage.room.services, request_detection=waiting.append)
        await stage.say(page, "play")
        await stage.go(20.0)
        stopped = stage.room.shown
        assert stopped < 1300 and page.of("facts")[-1]["facts"]["judged"] < 1
        stage.room.services = replace(stage.room.services, request_detection=test)
        test(stage.room)
        await stage.go(2.0)
        assert stage.room.shown >= stopped + 190 and page.of("facts")[-1]["facts"]["judged"] is None

    staged(scenario, horizon=100.0)


def test_rows_before_a_paused_opening_are_judged():
    """A session that is opened paused in the middle has rows that nobody has tested: the first viewer lets them be."""

    async def scenario(stage: Stage) -> None:
        stage.session.advance(120)
        assert stage.session.pending_detection() is not None
        await stage.connect()
        assert stage.session.pending_detection() is None

    staged(scenario, horizon=100.0)
