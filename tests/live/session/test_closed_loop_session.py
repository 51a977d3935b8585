"""Sessions on plants with controllers: live = batch, going back, forks, and set points changed live."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.engine.loops import experiment, level
from tests.live.session.test_session import advance, assert_same, do
from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session

SENSOR = {
    "stuck": {"value": 1.1},
    "freeze": {},
    "delay": {"delay": 0.37},
    "quantisation": {"resolution": 0.03},
    "dropout": {"probability": 0.4, "sample_time": 0.27},
    "outliers": {"probability": 0.1, "size": 0.1, "sample_time": 0.1},
}
SAMPLED = {"measurement": {"mode": "sampled", "period": 0.2}}
OBSERVERS = [
    {"label": "ekf", "kind": "joint-ekf"},
    {"label": "adaptive", "kind": "adaptive-kalman", "options": {"channels": "leak"}},
]


def session(period: float | None = 0.3, **changes) -> Session:
    """Return a session on the level under control with two observers and noise."""
    noise = {"y": {"std": 0.01, "sample_time": 0.1}}
    return Session(experiment(level(period), noise=noise, observers=OBSERVERS, seed=5, **changes))


@pytest.mark.parametrize("changes", [{}, SAMPLED], ids=["continuous", "sampled"])
@pytest.mark.parametrize("period", [None, 0.3])
@pytest.mark.parametrize("shape", SENSOR)
def test_a_saved_session_has_the_live_numbers(shape: str, period: float | None, changes: dict):
    """Sensor faults in the loop, a new set point, another gain and an added observer: bit for bit the saved run."""
    live, pieces = session(period, **changes), []
    advance(live, 33, pieces)
    do(live, "inject", fault={"output": "y", "shape": shape, "onset": 0, **SENSOR[shape]})
    advance(live, 7, pieces)
    do(live, "set-signal", name="r", signal={"kind": "constant", "value": 1.2})
    advance(live, 41, pieces)
    do(live, "inject", fault={"channel": "bias", "shape": "step", "onset": 0, "size": 0.1})
    do(live, "set-noise", output="y", std=0.02)
    advance(live, 20, pieces)
    do(live, "add-observer", observer={"label": "late", "kind": "adaptive-kalman-discrete"})
    do(live, "clear", output="y")
    advance(live, 60, pieces)
    assert_same(pieces, live)


@pytest.mark.parametrize("back", [lambda s: do(s, "seek", t=3.7), lambda s: s.drop_unseen_rows(37)])
@pytest.mark.parametrize("shape", SENSOR)
def test_the_controller_goes_back_with_the_session(shape: str, back: Callable[[Session], object]):
    """After going back, or dropping rows that nobody has seen, the same rows come again; also in a fork."""
    live = session()
    live.advance(20)
    do(live, "inject", fault={"output": "y", "shape": shape, "onset": 0, **SENSOR[shape]})
    rows = live.advance(60)
    other = live.fork(37)
    back(live)
    assert live.row == 37
    np.testing.assert_array_equal(live.advance(43), rows[:, 17:])
    np.testing.assert_array_equal(other.advance(43), rows[:, 17:])


def test_an_input_that_a_controller_sets_is_refused():
    """The error names the input and the references that can be set instead."""
    live = session()
    with pytest.raises(SpecError) as refusal:
        do(live, "set-signal", name="q", signal={"kind": "constant", "value": 1})
    assert refusal.value.field == "name" and "r" in str(refusal.value.remedy)
