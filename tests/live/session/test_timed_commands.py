"""Effects of commands on a session: their events, refusals, and second faults of a sensor."""

import pytest

from tests.live.session.test_session import advance, assert_same, do, zhao
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session

SENSOR = {
    "stuck": {"value": 0.1},
    "freeze": {},
    "delay": {"delay": 0.037},
    "quantisation": {"resolution": 0.003},
    "dropout": {"probability": 0.4, "sample_time": 0.027},
}


@pytest.mark.parametrize("sampled", [False, True])
@pytest.mark.parametrize("second", ["freeze", "dropout"])
@pytest.mark.parametrize("first", SENSOR)
def test_a_second_fault_of_a_sensor_is_saved_bit_for_bit(first, second, sampled):
    """It holds the values that the first one passes, although the first began earlier."""
    session, pieces = Session(zhao(**({"measurement": {"mode": "sampled", "period": 0.05}} if sampled else {}))), []
    for shape in (first, second):
        advance(session, 50, pieces)
        do(session, "inject", fault={"output": "y", "shape": shape, "onset": 0, **SENSOR[shape]})
    advance(session, 60, pieces)
    assert_same(pieces, session)


def test_a_reopened_session_logs_the_commands_of_its_spec():
    """Gains, noise and observers are in the log of a session on the same spec, at the same rows."""
    one = Session(zhao())
    for kind, fields in (
        ("set-gain", {"observer": "adaptive", "gain": "rho", "value": 6.0}),
        ("set-noise", {"output": "y", "std": 0.002}),
        ("add-observer", {"observer": {"label": "ekf", "kind": "joint-ekf"}}),
        ("remove-observer", {"label": "ekf"}),
    ):
        one.advance(20)
        do(one, kind, **fields)
    one.advance(20)
    two = Session(one.spec)
    while two.row < one.row:
        two.advance(one.row - two.row)
    assert [(e.kind, e.row, e.value) for e in two.log] == [(e.kind, e.row, e.value) for e in one.log] and len(
        one.log
    ) == 4


def test_observers_that_have_no_row_yet_are_not_checked():
    """The others are checked: an observer added while paused does not remove the checks of others."""
    session = Session(zhao())
    session.advance(300)
    do(session, "add-observer", observer={"label": "ekf", "kind": "joint-ekf"})
    assert [report.observer for report in session.assumptions()] == ["adaptive"]
    session.advance(300)
    assert [report.observer for report in session.assumptions()] == ["adaptive", "ekf"]


@pytest.mark.parametrize(
    ("kind", "fields", "field"),
    [
        ("set-noise", {"output": "y", "std": 0.1, "sample_time": 1e-9}, "sample_time"),
        ("set-signal", {"name": "u", "signal": {"kind": "prbs", "hold": 1e-9}}, "hold"),
        ("set-signal", {"name": "u", "signal": {"kind": "pulse", "period": 1e-9, "width": 1e-10}}, "period"),
        ("clear", {"channel": "nope"}, "channel"),
        ("clear", {"output": "x1"}, "output"),
    ],
)
def test_unknown_names_and_too_short_intervals_are_refused_immediately(kind, fields, field):
    """Even while paused: the error names the field, and nothing has changed."""
    session = Session(zhao())
    session.advance(30)
    before = session.spec
    with pytest.raises(SpecError) as refusal:
        do(session, kind, **fields)
    assert refusal.value.field == field and refusal.value.remedy and session.spec is before
