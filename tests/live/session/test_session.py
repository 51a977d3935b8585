"""Live sessions: their rows equal those of the saved run, bit for bit, for any commands."""

import random
from dataclasses import replace

import numpy as np
import pytest
from pydantic import TypeAdapter

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.live.room.advice import diagnosis_of
from thetascope.live.session.session import Session
from thetascope_schemas import Experiment, ResolvedExperiment
from thetascope_schemas.experiment.commands import MAX_COMMANDS, SetNoise
from thetascope_schemas.service.session import ClientMessage

COMMAND = TypeAdapter(ClientMessage)


def zhao(**changes) -> ResolvedExperiment:
    spec = library.experiment("zhao-2012").model_dump() | {"faults": [], "figures": []} | changes
    return library.resolve(Experiment.model_validate(spec))


def do(session: Session, type: str, **fields):
    return session.handle(COMMAND.validate_python({"type": type, "id": 0, **fields}))


def saved(session: Session):
    """Return the session's spec as an ordinary run up to its present time."""
    spec = session.spec.model_copy(update={"horizon": session.t, "record": session.record})
    return prepare(library.resolve(Experiment.model_validate(spec.model_dump()))).run()


def live_rows(pieces: list[tuple[tuple[str, ...], np.ndarray]], name: str) -> np.ndarray:
    return np.concatenate([d[c.index(name)] if name in c else np.full(d.shape[1], np.nan) for c, d in pieces])


def assert_same(pieces, session: Session) -> Result:
    """Return the run of the session's spec; its rows are those of the session."""
    result = saved(session)
    names = {n for columns, _ in pieces for n in columns}
    assert names <= set(result.names)
    for name in sorted(names):
        np.testing.assert_array_equal(live_rows(pieces, name), result.column(name)[: session.row], err_msg=name)
    return result


def advance(session: Session, rows: int, pieces: list) -> None:
    while rows > 0:
        data = session.advance(rows)
        pieces.append((session.columns, data))
        rows -= data.shape[1]
        assert data.shape[1] > 0


def test_a_session_without_commands_is_the_run():
    """However it is advanced, the rows are those of the run of its spec."""
    session, pieces = Session(zhao()), []
    for rows in (1, 2, 40, 300, 57):
        advance(session, rows, pieces)
    assert_same(pieces, session)


ACTIONS = [
    lambda draw: (
        "inject",
        {
            "fault": {
                "channel": draw.choice(["theta1", "theta2", "theta3"]),
                "shape": "step",
                "onset": 0,
                "size": draw.uniform(-0.02, 0.02),
            }
        },
    ),
    lambda draw: (
        "inject",
        {
            "fault": {
                "channel": "theta1",
                "shape": "random-walk",
                "onset": 0.003,
                "end": 0.8,
                "intensity": 0.01,
                "sample_time": 0.05,
            }
        },
    ),
    lambda draw: (
        "inject",
        {"fault": {"channel": "theta2", "shape": "sine", "onset": 0, "size": 0.01, "frequency": 0.7}},
    ),
    lambda draw: ("inject", {"fault": {"output": "y", "shape": "freeze", "onset": 0, "end": draw.uniform(0.05, 0.4)}}),
    lambda draw: ("clear", {"channel": "theta1"}),
    lambda draw: ("clear", {}),
    lambda draw: ("set-gain", {"observer": "adaptive", "gain": "rho", "value": draw.uniform(2, 12)}),
    lambda draw: ("set-gain", {"observer": "adaptive", "gain": "lambda", "value": draw.uniform(0.5, 8)}),
    lambda draw: ("set-noise", {"output": "y", "std": draw.uniform(0, 0.003)}),
    lambda draw: (
        "set-signal",
        {"name": "u", "signal": {"kind": "sine", "amplitude": 0.02, "frequency": 0.3, "phase": 0, "offset": 0.06}},
    ),
    lambda draw: ("add-observer", {"observer": {"label": f"more{draw.randrange(10**6)}", "kind": "adaptive-kalman"}}),
    lambda draw: ("add-observer", {"observer": {"label": f"ekf{draw.randrange(10**6)}", "kind": "joint-ekf"}}),
    lambda draw: ("remove-observer", {"label": "adaptive"}),
]


@pytest.mark.parametrize("seed", range(6))
def test_a_random_sequence_of_commands_is_saved_bit_for_bit(seed):
    """Faults, gains, noise, signals and observers at random, also while rows are half computed:
    the saved run is equal."""
    draw = random.Random(seed)
    session, pieces = Session(zhao()), []
    for _ in range(9):
        advance(session, draw.randrange(1, 120), pieces)
        kind, fields = draw.choice(ACTIONS)(draw)
        begun, refused = session.simulate(draw.randrange(1, 120)) if draw.random() < 0.5 else None, False
        try:
            do(session, kind, **fields)
        except SpecError:
            assert kind in ("set-gain", "remove-observer")  # the observer was removed before
            refused = True
        data = session.commit(begun)
        assert (data.shape[1] > 0) == (refused and begun is not None)
        pieces.append((session.columns, data))
    advance(session, 60, pieces)
    assert_same(pieces, session)


def test_rows_computed_ahead_can_be_dropped():
    """A command at an earlier row gives the numbers that it gives without them."""
    one, two = Session(zhao()), Session(zhao())
    one.advance(500)
    one.drop_unseen_rows(123)
    two.advance(123)
    for session in (one, two):
        do(session, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    np.testing.assert_array_equal(one.advance(200), two.advance(200))


@pytest.mark.parametrize("observers", [(), ("joint-ekf",)])
@pytest.mark.parametrize("row", [401, 517, 540])
def test_a_sensor_that_freezes_after_dropped_rows_holds_its_last_value(observers, row):
    """Also with an observer at a sample period: the numbers are those without computing ahead."""
    one, two = Session(zhao()), Session(zhao())
    for session, ahead in ((one, 140), (two, row - 400)):
        session.advance(200)
        for kind in observers:
            do(session, "add-observer", observer={"label": kind, "kind": kind})
        session.advance(200)
        session.advance(ahead)
    one.drop_unseen_rows(row)
    for session in (one, two):
        do(session, "inject", fault={"output": "y", "shape": "freeze", "onset": 0, "end": 0.3})
    np.testing.assert_array_equal(one.advance(100), two.advance(100))


def test_a_session_takes_no_more_commands_than_an_experiment_may_have():
    """The first one too many is refused, and the session continues."""
    session = Session(zhao())
    session.advance(10)
    command = SetNoise(at=0.0, output="y", std=0.001)
    spec = session.spec.model_copy(update={"commands": (command,) * MAX_COMMANDS})
    session.state = replace(session.state, spec=spec)
    before = session.spec
    with pytest.raises(SpecError, match=str(MAX_COMMANDS)):
        do(session, "set-noise", output="y", std=0.002)
    assert session.spec == before and session.advance(5).shape[1] == 5


def test_rewinding_discards_later_commands():
    """Back to 2 s and on with another fault: equal to a session without the first fault."""
    one, two = Session(zhao()), Session(zhao())
    one.advance(350)
    do(one, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    one.advance(300)
    _, past_changed = do(one, "seek", t=2.0)
    assert past_changed and one.row == 200 and one.spec.faults == ()
    two.advance(200)
    for session in (one, two):
        do(session, "inject", fault={"channel": "theta1", "shape": "step", "onset": 0, "size": 0.01})
    np.testing.assert_array_equal(one.advance(400), two.advance(400))
    np.testing.assert_array_equal(one.rows(0, 600), two.rows(0, 600))


def test_a_fork_does_not_affect_its_parent():
    """A fork at 1.5 s repeats the past and leaves its parent unchanged."""
    parent = Session(zhao())
    parent.advance(300)
    fork = parent.fork(150)
    do(fork, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    fork.advance(200)
    assert parent.spec.faults == () and parent.row == 300
    np.testing.assert_array_equal(fork.rows(0, 150), parent.rows(0, 150))
    untouched = Session(zhao())
    untouched.advance(300)
    np.testing.assert_array_equal(parent.advance(50), untouched.advance(50))


def test_a_refused_command_changes_nothing():
    """An unknown channel, gain, observer or signal is refused with the known names, and the session continues."""
    session, pieces = Session(zhao()), []
    advance(session, 50, pieces)
    before = session.spec
    for kind, fields, names in (
        ("inject", {"fault": {"channel": "theta9", "shape": "step", "onset": 0, "size": 1}}, "theta1"),
        ("set-gain", {"observer": "nobody", "gain": "rho", "value": 1}, "adaptive"),
        ("set-gain", {"observer": "adaptive", "gain": "rh", "value": 1}, "rho"),
        ("set-gain", {"observer": "adaptive", "gain": "window", "value": 1}, "remove the observer"),
        ("set-gain", {"observer": "adaptive", "gain": "rho", "value": -1}, "greater than 0"),
        ("set-signal", {"name": "v", "signal": {"kind": "constant", "value": 1}}, "u"),
        ("set-noise", {"output": "z", "std": 1}, "y"),
        ("add-observer", {"observer": {"label": "adaptive", "kind": "high-gain"}}, "another label"),
        ("add-observer", {"observer": {"label": "b", "kind": "sandwich-nonsmooth"}}, "observer"),
        ("remove-observer", {"label": "nobody"}, "adaptive"),
    ):
        with pytest.raises(SpecError, match=names):
            do(session, kind, **fields)
        assert session.spec == before
    advance(session, 50, pieces)
    assert_same(pieces, session)


def test_alarms_name_the_faults_and_nothing_else():
    """With noise, an injected sensor and actuator fault are each named within 2 s, and nothing else."""
    session = Session(zhao(seed=5))
    session.advance(1500)
    assert [e for e in session.log if e.kind == "alarm"] == []
    do(session, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    session.advance(1500)
    do(session, "inject", fault={"channel": "theta1", "shape": "step", "onset": 0, "size": 0.02})
    session.advance(1500)
    named = [(e.subject, e.t) for e in session.log if e.kind == "alarm"]
    assert [subject for subject, _ in named] == ["theta3", "theta1"]
    assert 15.0 < named[0][1] < 16.0 and 30.0 < named[1][1] < 32.0
    assert [e for e in session.log if e.kind == "alarm-over"] == []


def test_a_saved_run_is_diagnosed_as_the_session_was():
    """With changed faults, noise and gains, rows in blocks of any length: the same findings, to the last digit."""
    draw, session = random.Random(3), Session(zhao(seed=2))
    for kind, fields in (
        ("inject", {"fault": {"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02}}),
        ("set-gain", {"observer": "adaptive", "gain": "rho", "value": 6.0}),
        ("set-noise", {"output": "y", "std": 0.002}),
        ("clear", {"channel": "theta3"}),
        ("inject", {"fault": {"channel": "theta1", "shape": "step", "onset": 0, "size": 0.01}}),
    ):
        for rows in draw.sample(range(40, 400), 3):
            session.advance(rows)
        session.drop_unseen_rows(session.row - draw.randrange(1, 30))
        do(session, kind, **fields)
    session.advance(800)
    found = diagnosis_of(session).diagnosis
    assert [a.channel for a in found.alarms] == ["theta3", "theta1"] and found.alarms[0].cleared is not None
    assert saved(session).diagnosis["detector"] == found.model_dump(mode="json")


def test_planned_faults_are_logged():
    """The faults of the library experiment are logged as they begin."""
    session = Session(zhao(faults=[{"channel": "theta3", "shape": "step", "onset": 1.0, "end": 2.0, "size": 0.02}]))
    session.advance(300)
    assert [(e.kind, e.subject, e.row) for e in session.new_events() if e.kind.startswith("fault")] == [
        ("fault-begins", "theta3", 100),
        ("fault-ends", "theta3", 200),
    ]


def test_a_link_reopens_the_session():
    """A session opened on the spec of another and advanced to the same row has the same rows."""
    one = Session(zhao())
    one.advance(120)
    do(one, "set-gain", observer="adaptive", gain="rho", value=7.0)
    do(one, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02})
    one.advance(80)
    do(one, "add-observer", observer={"label": "kalman", "kind": "adaptive-kalman"})
    one.advance(100)
    two = Session(library.resolve(Experiment.model_validate_json(one.spec.model_dump_json())))
    while two.row < one.row:
        two.advance(one.row - two.row)
    assert two.columns == one.columns
    np.testing.assert_array_equal(two.rows(0, 300), one.rows(0, 300))


def test_stiff_gains_take_substeps_that_the_saved_run_takes_too():
    """With λ raised until Γ is stiff the session takes substeps, and its saved run takes the same bit for bit."""
    session, pieces = Session(zhao()), []
    advance(session, 100, pieces)
    do(session, "set-gain", observer="adaptive", gain="lambda", value=20.0)
    advance(session, 300, pieces)
    assert assert_same(pieces, session).substeps > 1


def test_a_discrete_plant_runs_live():
    """The sandwich system: zones and the hysteresis output are among the columns."""
    session, pieces = Session(library.resolve(library.experiment("zhou-tan-2012"))), []
    advance(session, 200, pieces)
    assert any(n.startswith("nonsmooth.zone") for n in session.columns) and "nonsmooth.v" in session.columns
    assert_same(pieces, session)


@pytest.mark.parametrize("piece", [1, 7, 150])
def test_divergence_is_reported_where_the_run_reports_it(piece):
    """For any division of the session: an observer that diverges, and a plant that does."""
    explosive = {
        "id": "explosive",
        "states": [{"name": "x", "initial": 1}],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "x**2 + u"},
        "channels": [{"name": "gain", "kind": "actuator", "enters": {"x": "u"}}],
    }
    plant = Experiment.model_validate(
        {"plant": explosive, "horizon": 1.5, "evaluate": 0.01, "diagnosis": {"enabled": False}}
    )
    for spec, who in ((library.experiment("zhao-2012-as-printed"), "adaptive"), (plant, "")):
        run, session = (
            prepare(library.resolve(spec.model_copy(update={"horizon": 1.5}))).run(),
            Session(library.resolve(spec)),
        )
        while session.row < 150 and not session.ended:
            session.advance(piece)
        (logged,) = [e for e in session.log if e.kind == "diverged"]
        when = run.diverged if who == "" else run.observers[0].diverged
        assert (logged.subject, logged.t, logged.row) == (who, when.time, round(when.time / session.record))
        assert who or (session.ended and session.history.end == session.row == logged.row + 1)


def test_the_log_has_cleared_faults_and_first_sizes():
    """The log names planned faults that were cleared; an alarm's size is the first one reported, however rows are
    grouped."""
    logged = []
    for piece in (13, 900):
        session = Session(library.resolve(library.experiment("zhao-2012")))
        while session.t < 26:
            session.advance(min(piece, 2600 - session.row))
        logged.append([(e.row, e.subject, e.value["size"]) for e in session.log if e.kind == "alarm"])
    assert logged[0] == logged[1] and [subject for _, subject, _ in logged[0]] == ["theta3"]
    (event,), _ = do(session, "clear", channel="theta1")
    assert event.value == {"planned": 1} and event.message.text == "theta1 cleared, planned faults included"
    (event,), _ = do(session, "clear", channel="theta3")
    assert event.value is None and event.message.text == "theta3 cleared"
