"""A record replayed in a live session: the run's numbers, alarms at their times, observers added, nothing injected."""

import numpy as np
import pytest

from tests.records.recorded_runs import ID, changed, common, exported, simulated
from thetascope import library
from thetascope.assembly import RecordBytes, carry_out, prepare, with_rows_and_diagnosis
from thetascope.engine.errors import SpecError
from thetascope.live.facts.session_facts import FactsMemory, facts_of
from thetascope.live.session.session import Session
from thetascope_schemas import Experiment, ResolvedExperiment
from thetascope_schemas.service.session import AddObserverNow, Inject, Seek, SetNoiseNow, SetSignalNow, SetTruthNow

ROWS = 400
FAULT = {"channel": "pump", "shape": "step", "onset": 0, "size": 0.1}


@pytest.fixture(scope="module")
def spec() -> ResolvedExperiment:
    """Return an experiment on the record of a tank whose pump fails at 100 s, with a gap and its diagnosis."""
    plant = library.plant("level-loop").without_controllers
    noise = {o.name: {"std": 0.05, "sample_time": 0.5} for o in plant.outputs}
    data = exported(simulated(plant, 0.5, ROWS, [], noise=noise))
    gap = changed(data, lambda rows: [[*r[:2], "", ""] if 40 <= i < 60 else r for i, r in enumerate(rows)])
    fields = common(plant, 0.5, ROWS, ["joint-ekf", "adaptive-kalman"])
    fields |= {"truth": {"record": {"id": ID, "name": "rig.csv"}}, "substeps": None, "noise": noise}
    resolved = library.resolve(Experiment.model_validate(fields))
    return with_rows_and_diagnosis(resolved.with_readings(RecordBytes("rig.csv", gap)))


def played(session: Session, rows: int = 37) -> np.ndarray:
    """Return all rows that are left, advanced a few at a time."""
    parts = []
    while not session.ended:
        parts.append(session.advance(rows))
    return np.concatenate(parts, axis=1)


def test_a_replay_gives_the_numbers_of_the_run(spec):
    """Every column of a replay is the run's, and the replay ends with the record."""
    run, session = carry_out(prepare(spec)), Session(spec)
    data = played(session)
    assert session.columns == run.names and data.shape == run.data.shape
    assert np.array_equal(data, run.data, equal_nan=True)


def test_alarms_come_when_the_record_raised_them(spec):
    """An alarm is logged at its row, once, also after going back; before it the summary knows of no fault."""
    session = Session(spec)
    played(session)
    (alarm,) = [event for event in session.log if event.kind == "alarm"]
    assert alarm.subject == "pump" and 100 <= alarm.t < 130
    memory = FactsMemory(session.record)
    assert [a.channel for a in facts_of(session, session.row, memory).alarms] == ["pump"]
    session.handle(Seek(id=1, t=50.0))
    earlier = facts_of(session, session.row, memory)
    assert earlier.alarms == () and earlier.summary.code == "record.summary.none"
    played(session)
    assert [event.row for event in session.log if event.kind == "alarm"] == [alarm.row]


def test_an_observer_that_is_added_continues_in_a_run(spec):
    """A run of the session's spec gives its numbers, with the observer that was added in the middle."""
    session = Session(spec)
    session.advance(150)
    session.handle(AddObserverNow(id=1, observer={"label": "ukf", "kind": "joint-ukf"}))
    played(session)
    run = carry_out(prepare(session.spec))
    assert run.names == session.columns
    column = list(session.columns).index("ukf.theta.pump")
    expected = run.column("ukf.theta.pump").astype(np.float32)
    assert np.isnan(expected[149]) and np.isfinite(expected[151:]).all()
    assert np.array_equal(session.rows(0, ROWS)[column], expected, equal_nan=True)


@pytest.mark.parametrize(
    "command",
    [
        Inject.model_validate({"id": 1, "fault": FAULT}),
        SetNoiseNow(id=1, output="y", std=1.0, sample_time=0.5),
        SetSignalNow.model_validate({"id": 1, "name": "q", "signal": {"kind": "constant", "value": 1.0}}),
        SetTruthNow.model_validate({"id": 1, "truth": {"deviation": 0.1}}),
    ],
    ids=lambda command: command.type,
)
def test_a_record_cannot_be_changed(spec, command):
    """Faults, noise, inputs and another truth are refused with a remedy, and the session goes on."""
    session = Session(spec)
    session.advance(10)
    with pytest.raises(SpecError) as refused:
        session.handle(command)
    assert refused.value.problem.code == "session.recorded"
    assert session.row == 10 and session.advance(5).shape[1] == 5
