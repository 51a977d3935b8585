"""Inputs, known signals and set points that are moved in a session: every shape, its limits, its line in the log."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tests.live.session.test_session import advance, assert_same, do, zhao
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session
from thetascope.messages import Message
from thetascope_schemas.experiment.base import MAX_POINTS
from thetascope_schemas.experiment.commands import SetSignal
from thetascope_schemas.experiment.signals import TableSignal

SHAPES = [
    {"kind": "constant", "value": 0.07},
    {"kind": "steps", "times": [0.9, 2.21], "values": [0.05, 0.09, 0.06]},
    {"kind": "pulse", "low": 0.06, "high": 0.1, "period": 0.33, "width": 0.111, "start": 0.05},
    {"kind": "square", "amplitude": 0.02, "period": 0.37, "start": 1.234, "offset": 0.08},
    {"kind": "sine", "amplitude": 0.02, "frequency": 0.7, "phase": 1.1, "offset": 0.08},
    {"kind": "ramp", "start": 1, "slope": 0.01, "initial": 0.07, "end": 3.33},
    {"kind": "chirp", "amplitude": 0.02, "f0": 0.3, "f1": 3, "duration": 2, "offset": 0.08, "start": 0.7},
    {"kind": "prbs", "low": 0.06, "high": 0.1, "hold": 0.071, "seed": 3},
    {"kind": "prbs", "low": 0.06, "high": 0.1, "hold": 0.071, "seed": 3, "order": 7},
    {"kind": "noise", "std": 0.005, "hold": 0.071, "seed": 3, "offset": 0.08},
    {"kind": "table", "times": [1, 1.5, 2.013], "values": [0.08, 0.05, 0.09], "interpolation": "linear"},
    {"kind": "expression", "text": "0.08 + 0.02*sin(3*t)"},
]


def moved(session: Session, names: list[str], pieces: list) -> None:
    """Give every shape to each of the signals in turn, with a few rows after each command."""
    for place, shape in enumerate(SHAPES):
        do(session, "set-signal", name=names[place % len(names)], signal=shape)
        advance(session, 23, pieces)


def test_every_shape_of_an_input_and_a_known_signal_is_saved_bit_for_bit():
    """The run of the session's spec has its rows; a fork from the middle and a step back repeat them."""
    session, pieces = Session(zhao()), []
    names = [*session.spec.plant.names("inputs"), *session.spec.plant.names("signals")]
    assert len(names) > 1
    advance(session, 17, pieces)
    moved(session, names, pieces)
    moved(session, names[1:] + names[:1], pieces)
    assert_same(pieces, session)
    fork, middle = session.fork(session.row // 2), session.row // 2
    np.testing.assert_array_equal(fork.rows(0, middle), session.rows(0, middle))
    commands = [c for c in session.spec.commands if c.at < fork.t]
    assert list(fork.spec.commands) == commands
    do(session, "seek", t=fork.t)
    moved(session, names, [])
    moved(fork, names, [])
    np.testing.assert_array_equal(fork.rows(0, fork.row), session.rows(0, session.row))


def test_every_shape_of_a_set_point_is_saved_bit_for_bit():
    """In a closed loop the reference moves; the input that the controller sets is refused, and nothing changes."""
    spec = library.experiment("loop-actuator")
    session, pieces = Session(library.resolve(spec.model_copy(update={"faults": (), "figures": ()}))), []
    (controlled,), references = session.spec.plant.controlled, session.spec.plant.names("references")
    advance(session, 17, pieces)
    before = session.state
    with pytest.raises(SpecError) as refusal:
        do(session, "set-signal", name=controlled, signal=SHAPES[0])
    assert refusal.value.field == "name" and str(references[0]) in str(refusal.value.remedy)
    assert session.spec is before.spec
    moved(session, list(references), pieces)
    assert_same(pieces, session)


def test_a_slider_that_is_dragged_leaves_one_command_for_each_row():
    """While time is paused the last value counts; values of other signals and earlier rows stay."""
    session = Session(zhao())
    for row in (20, 40):
        session.advance(20)
        for value in (0.05, 0.06, 0.0625 * row):
            do(session, "set-signal", name="u", signal={"kind": "constant", "value": value})
            do(session, "set-noise", output="y", std=value / 100)
    kept = [(c.at, c.signal.value) for c in session.spec.commands if isinstance(c, SetSignal)]
    assert [value for _, value in kept] == [1.25, 2.5] and kept[0][0] < kept[1][0]
    assert len(session.spec.commands) == 4


@pytest.mark.parametrize("shape", SHAPES, ids=[f"{s['kind']}-{i}" for i, s in enumerate(SHAPES)])
def test_the_log_says_the_shape_in_words(shape: dict):
    """In both languages, with the sizes of the shape, and without the points of tables."""
    session = Session(zhao())
    (event,), _ = do(session, "set-signal", name="u", signal=shape)
    message = Message.from_data(event.message.model_dump(exclude={"text"}))
    english, chinese = message.text("en"), message.text("zh")
    assert english.startswith("u: ") and "{" not in english + chinese and english != chinese
    assert event.value["kind"] == shape["kind"] and "values" not in event.value
    if "amplitude" in shape:
        assert "0.08 ± 0.02" in english and "0.08 ± 0.02" in chinese


def test_tables_without_end_neither_fill_the_log_nor_the_spec():
    """A client that sends the largest tables again and again is refused; what the session keeps stays bounded."""
    session = Session(zhao())
    session.advance(5)
    times = np.arange(9000.0)
    for size in range(30):
        table = {"kind": "table", "times": times.tolist(), "values": (0.08 + 1e-9 * size * times).tolist()}
        do(session, "set-signal", name="u", signal=table)
    assert len(session.spec.commands) == 1  # all in one row
    assert len(json.dumps([event.model_dump(mode="json") for event in session.log])) < 30_000
    command = SetSignal(at=0.0, name="u", signal=TableSignal(times=tuple(times), values=tuple(times)))
    full = session.spec.model_copy(update={"commands": (command,) * (MAX_POINTS // len(times))})
    session.state = replace(session.state, spec=full)
    with pytest.raises(SpecError, match=str(MAX_POINTS)):
        do(session, "set-signal", name="u", signal=table)
    assert session.spec is full
    with pytest.raises(ValueError, match="command.points.many"):
        type(full).model_validate(full.model_dump() | {"commands": [*full.commands, command]})
    assert session.advance(3).shape[1] == 3
