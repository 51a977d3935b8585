"""Going back drops the commands given from that time on, and none given before it, whenever they act."""

import numpy as np
import pytest

from tests.live.session.test_session import advance, assert_same, do, live_rows, saved, zhao
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session

ACTS = {
    "a fault with an end ahead": (
        "inject",
        {"fault": {"channel": "theta3", "shape": "step", "onset": 0, "end": 3, "size": 0.02}},
    ),
    "a fault that is planned": ("inject", {"fault": {"channel": "theta3", "shape": "step", "onset": 2, "size": 0.02}}),
    "planned faults cleared": ("clear", {}),
}


@pytest.mark.parametrize("act", ACTS)
@pytest.mark.parametrize("fork", [False, True])
def test_earlier_commands_are_kept(act, fork):
    """Given at 1 s, after going back from 2.5 s to 1.5 s or forking there, the faults are those left at 1 s."""
    session, pieces = Session(library.resolve(library.experiment("zhao-2012"))), []
    advance(session, 100, pieces)
    kind, fields = ACTS[act]
    do(session, kind, **fields)
    left = session.spec.faults
    advance(session, 150, pieces)
    do(session, "inject", fault={"channel": "theta1", "shape": "step", "onset": 0, "size": 0.01})
    assert session.spec.faults != left
    if fork:
        session = session.fork(150)
    else:
        do(session, "seek", t=1.5)
    assert session.row == 150 and session.spec.faults == left


def test_a_fault_that_was_cleared_after_that_time_continues():
    """It has its original end again, and the saved run has the live numbers."""
    session, pieces = Session(zhao()), []
    advance(session, 50, pieces)
    do(session, "inject", fault={"channel": "theta3", "shape": "step", "onset": 0, "end": 5, "size": 0.02})
    advance(session, 100, pieces)
    do(session, "clear", channel="theta3")
    assert session.spec.faults[0].end == 1.5
    do(session, "seek", t=1.0)
    assert session.spec.faults[0].end == 5.5
    advance(session, 60, pieces)
    run = saved(session)
    for name in session.columns:
        mine = session.history.rows((name,), 100, 160)[0]
        np.testing.assert_array_equal(mine, run.column(name)[100:160].astype("f4"), err_msg=name)


def test_seeking_ahead_is_refused():
    """It is refused with the session's present time, and nothing is dropped."""
    session = Session(library.resolve(library.experiment("zhao-2012")))
    session.advance(100)
    before = session.spec
    with pytest.raises(SpecError, match="the session is at 1 s"):
        do(session, "seek", t=500.0)
    assert session.spec is before and session.row == 100


def test_a_diverged_observer_is_restarted_under_its_name():
    """Removed and added at one row, alone or beside another one: its columns continue, as in the saved run."""
    session, pieces = Session(library.resolve(library.experiment("zhao-2012-as-printed"))), []
    own = session.spec.observers[0]
    advance(session, 100, pieces)
    assert [e.subject for e in session.log if e.kind == "diverged"] == ["adaptive"]
    for label in ("kalman", "another"):
        do(session, "remove-observer", label="adaptive")
        do(session, "add-observer", observer=own.model_dump())
        advance(session, 8, pieces)
        assert np.isfinite(live_rows(pieces, "adaptive.x.x1")[-8:]).all()
        do(session, "add-observer", observer={"label": label, "kind": "adaptive-kalman"})
    assert sum(e.kind == "diverged" for e in session.log) == 1
    assert_same(pieces, session)


def test_events_are_not_reported_again_when_rows_are_dropped():
    """A divergence and an alarm are reported once, although the rows after them are dropped and computed again."""
    for experiment, rows, back in (("zhao-2012-as-printed", 100, 74), ("zhao-2012", 2300, 2250)):
        session = Session(library.resolve(library.experiment(experiment)))
        session.advance(rows)
        assert {"diverged", "alarm"} & {e.kind for e in session.new_events()}
        session.drop_unseen_rows(back)
        session.advance(rows - back)
        assert session.new_events() == ()
