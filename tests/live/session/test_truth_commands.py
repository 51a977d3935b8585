"""Live commands that change the true plant: a session and the run saved from it have the same bits."""

import pytest
from pydantic import ValidationError

from tests.live.session.test_session import advance, assert_same, do, live_rows, zhao
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session
from thetascope_schemas import field_errors

NOISE = {"y": {"std": 0.001, "sample_time": 0.01}}
TRUTHS = {
    "deviation": {"deviation": 0.02},
    "process noise": {"process_noise": {"x1": 0.002}},
    "coloured noise": {"outputs": {"y": {"correlation": 0.2}}},
    "samples": {"outputs": {"y": {"period": 0.05, "missing": 0.3, "jitter": 0.02}}},
    "equations": {"dynamics": {"x1": "0.01*x2"}, "outputs": {"y": {"adds": "0.02*x1"}}},
}


@pytest.mark.parametrize("name", TRUTHS)
def test_a_session_whose_truth_changes_is_saved_bit_for_bit(name: str):
    """The truth changes, changes back and changes again; the columns differ from those of the model."""
    session, pieces = Session(zhao(noise=NOISE)), []
    advance(session, 60, pieces)
    before = session.spec
    for truth in (TRUTHS[name], {}, TRUTHS[name]):
        do(session, "set-truth", truth=truth)
        advance(session, 70, pieces)
    assert_same(pieces, session)
    model, other = Session(before), []
    advance(model, 60 + 3 * 70, other)
    assert (live_rows(pieces, "y.y")[:60] == live_rows(other, "y.y")[:60]).all()
    assert (live_rows(pieces, "y.y")[60:] != live_rows(other, "y.y")[60:]).any()


def test_a_session_with_a_truth_goes_back_and_on_with_the_same_rows():
    """Rows that are simulated again after seeking, and those of a session on the same spec, equal the saved run."""
    session, pieces = Session(zhao(noise=NOISE, truth={"deviation": 0.01})), []
    advance(session, 60, pieces)
    do(session, "set-truth", truth={"deviation": 0.05, **TRUTHS["process noise"], **TRUTHS["samples"]})
    advance(session, 60, pieces)
    do(session, "seek", t=80 * session.record)
    columns, data = pieces.pop()
    pieces.append((columns, data[:, :20]))
    do(session, "set-truth", truth={"deviation": 0.02})
    advance(session, 60, pieces)
    assert_same(pieces, session)
    again = []
    advance(Session(session.spec), 140, again)
    assert_same(again, session)


def test_a_slider_that_is_dragged_within_a_row_leaves_one_command():
    """The last value counts; the log tells the share."""
    session = Session(zhao())
    session.advance(30)
    for share in (0.01, 0.03, 0.02):
        do(session, "set-truth", truth={"deviation": share})
    assert [c.truth.deviation for c in session.spec.commands] == [0.02]
    assert session.log[-1].message.args == {"percent": 2.0}


@pytest.mark.parametrize(
    ("truth", "field"),
    [
        ({"parameters": {"nope": 1.0}}, "truth.parameters.nope"),
        ({"outputs": {"y": {"period": 0.0123}}}, "truth.outputs.y.period"),
        ({"dynamics": {"x1": "nope"}}, "truth.dynamics.x1"),
        ({"states": [{"name": "z"}], "dynamics": {"z": "-z"}}, "truth.states"),
    ],
)
def test_a_truth_that_does_not_fit_is_refused(truth: dict, field: str):
    """The error names the field, and nothing has changed."""
    session = Session(zhao(noise=NOISE))
    session.advance(30)
    before = session.spec
    with pytest.raises((SpecError, ValidationError)) as refusal:
        do(session, "set-truth", truth=truth)
    error = refusal.value
    fields = [error.field] if isinstance(error, SpecError) else [e.field for e in field_errors(error.errors())]
    assert fields == [field]
    assert session.spec is before
