"""Observers with constant gains, sliding modes, decoupling and mixing, added to a session that has begun."""

import pytest

from tests.live.session.test_session import advance, assert_same, do, zhao
from thetascope.live.session.session import Session

KINDS = ("proportional-integral", "extended-state", "sliding-mode", "unknown-input", "drem")


@pytest.mark.parametrize("kind", KINDS)
def test_an_added_observer_is_that_of_the_run(kind):
    """Its columns, with bands and a fault that is injected later, are those of the run of the session's spec."""
    session, pieces = Session(zhao()), []
    advance(session, 20, pieces)
    do(session, "add-observer", observer={"label": "added", "kind": kind})
    advance(session, 60, pieces)
    do(session, "inject", fault={"channel": "theta1", "shape": "step", "onset": 0, "size": 0.01})
    advance(session, 100, pieces)
    assert_same(pieces, session)
