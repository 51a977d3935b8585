"""A command that fails half way leaves a session as it was, bit for bit, wherever it fails."""

import hashlib
import pickle
from copy import copy
from functools import cache

import numpy as np
import pytest

from tests.live.session.test_session import do, zhao
from thetascope.live.session import changes, rewind
from thetascope.live.session.session import Session

FAULT = {"channel": "theta3", "shape": "step", "onset": 0, "size": 0.02}
GAIN = {"observer": "adaptive", "gain": "lambda", "value": 20.0}
STAGES = {
    "validation": (changes.edits, "checked", "inject", {"fault": FAULT}),
    "adapting the experiment": (changes, "adapted", "set-noise", {"output": "y", "std": 0.002}),
    "entering the stage": (changes, "carry", "add-observer", {"observer": {"label": "ekf", "kind": "joint-ekf"}}),
    "the check of a gain": (changes, "check_moves", "set-gain", GAIN),
    "the stage of a gain": (changes, "adopt", "set-gain", GAIN),
    "the event": (changes.log_events, "command_event", "clear", {}),
    "simulating again": (rewind, "advance", "seek", {"t": 1.5}),
    "the spec after going back": (rewind, "adopt", "seek", {"t": 1.0}),
    "the second command of a batch": (
        changes,
        "check_moves",
        "batch",
        {"commands": [{"type": "inject", "fault": FAULT}, {"type": "set-gain", **GAIN}]},
    ),
}


class HalfWay(Exception):
    """The error that the tests cause."""


@cache
def _began(_: str) -> Session:
    """Return a session with commands, events and rows behind it: for each use one of its own."""
    session = Session(zhao(faults=[FAULT | {"channel": "theta1", "onset": 0.5, "end": 0.8}]))
    session.advance(100)
    do(session, "inject", fault=FAULT)
    for rows in (200, 200, 300):
        session.advance(rows)
    return session


def began(use: str) -> Session:
    """Return such a session as it was before anything was done with it; two uses share no memory."""
    return copy(_began(use))


def observables(session: Session) -> dict[str, object]:
    """Return everything that can be seen of a session, arrays as digests."""
    current, state = session.current, session.state
    arrays = [current.state.plant, *current.state.observers, session.rows(0, session.row)]
    return {
        "spec": session.spec.model_dump_json(),
        "row": session.row,
        "columns": session.columns,
        "epoch": session.epoch,
        "ended": session.ended,
        "log": [event.model_dump_json() for event in session.log],
        "unreported": len(state.unreported),
        "faults": state.faults,
        "stages": [stage.k for stage in state.stages],
        "snapshots": [snapshot.row for snapshot in (*state.snapshots.full, *state.snapshots.light)],
        "arrays": [hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest() for array in arrays],
        "memory": hashlib.sha256(pickle.dumps(current.state.memory)).hexdigest(),
        "assumptions": [report.model_dump_json() for report in session.assumptions()],
    }


@pytest.mark.parametrize("stage", STAGES)
def test_a_command_that_fails_half_way_leaves_every_observable_as_it_was(stage, monkeypatch):
    """The state is the earlier value itself, and the rows that follow are those of a session without the command."""
    module, name, kind, fields = STAGES[stage]
    session, untouched = began("commands that fail"), began("no command")
    before, state = observables(session), session.state

    def fail(*_: object, **__: object) -> None:
        raise HalfWay(stage)

    with monkeypatch.context() as patch:
        patch.setattr(module, name, fail)
        with pytest.raises(HalfWay):
            do(session, kind, **fields)
    assert session.state is state and observables(session) == before
    np.testing.assert_array_equal(session.advance(150), untouched.advance(150))
    do(session, kind, **fields)
    do(untouched, kind, **fields)
    np.testing.assert_array_equal(session.advance(150), untouched.advance(150))


def test_a_fork_shares_no_later_change_with_its_parent():
    """Commands and rows of one are not seen in the other, in either direction."""
    parent = began("forks")
    before = observables(parent)
    fork = parent.fork()
    do(fork, "clear")
    fork.advance(50)
    assert observables(parent) == before
    after = observables(fork)
    do(parent, "seek", t=0.2)
    parent.advance(10)
    parent.release()
    assert observables(fork) == after
