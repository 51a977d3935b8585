"""Events with the steps that a run chooses: located within the base step, whatever it is, and not without end."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.engine.model.test_events import BALL, bounced, simulate
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.simulation.controlled import Controlled, Repeated, simulation_of
from thetascope_schemas import Experiment

LAG = 1e-5
RELAY: dict[str, Any] = {  # a room whose heater follows its relay within microseconds
    "id": "relay",
    "states": [{"name": "T", "initial": 18.0}, {"name": "q", "initial": 1.0}, {"name": "on", "initial": 1.0}],
    "outputs": [{"name": "y", "expression": "T"}],
    "dynamics": {"T": "0.02*(10 - T) + 0.5*q", "q": f"(on - q)/{LAG}", "on": "0"},
    "events": [{"when": "T > 22", "set": {"on": 0}}, {"when": "T < 20", "set": {"on": 1}}],
}


@cache
def heated(times: tuple[float, ...]) -> np.ndarray:
    """Return the temperature of the room at times, by Radau, restarted at every event."""
    rows = np.array(times)
    t, T, q, on, result = 0.0, 18.0, 1.0, 1.0, np.full(len(rows), 18.0)

    def rate(t: float, x: np.ndarray) -> list[float]:
        return [0.02 * (10 - x[0]) + 0.5 * x[1], (on - x[1]) / LAG]

    def switches(t: float, x: np.ndarray) -> float:
        return x[0] - 22 if on else 20 - x[0]

    switches.terminal, switches.direction = True, 1
    while t < rows[-1]:
        part = solve_ivp(
            rate, (t, rows[-1]), [T, q], "Radau", dense_output=True, events=switches, rtol=1e-10, atol=1e-12
        )
        inside = (rows > t) & (rows <= part.t[-1])
        result[inside] = part.sol(rows[inside])[0]
        t, (T, q), on = part.t[-1], part.y[:, -1], 1 - on
    return result


@pytest.mark.parametrize("step", [1.0, 0.05])
def test_a_relay_with_a_stiff_heater_switches_at_the_right_times(step: float):
    """At rest between events, its heater shows no error of a step that is far too long for it, until the relay acts."""
    result = simulate({"plant": RELAY, "horizon": 60.0, "step": step, "evaluate": 1.0})
    np.testing.assert_allclose(result.column("x.T"), heated(tuple(result.column("t"))), rtol=1e-8)
    assert result.accuracy is not None and result.accuracy.plant < 1e-6


@pytest.mark.parametrize("step", [0.1, 1e-2, 1e-3])
def test_a_ball_bounces_at_the_right_times_whatever_the_step(step: float):
    """Its height agrees with the exact parabolas over six bounces to 1e-12 m."""
    result = simulate({"plant": BALL, "horizon": 2.5, "step": step, "evaluate": 0.1})
    exact = np.array([bounced(t) for t in result.column("t")])
    np.testing.assert_allclose(result.column("x.h"), exact, atol=1e-12)


def test_an_event_that_acts_in_every_step_is_not_located_each_time():
    """A counter that nothing stops divides only a few of a thousand base steps, and counts every one."""
    counter = {
        "id": "counter",
        "states": [{"name": "x", "initial": 1.0}, {"name": "n"}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "-x", "n": "0"},
        "events": [{"when": "x > 0", "set": {"n": "n + 1"}}],
    }
    spec = {"id": "case", "plant": counter, "horizon": 10.0, "step": 1e-2, "evaluate": 0.1}
    simulation = simulation_of(prepare(library.resolve(Experiment.model_validate(spec))).engine)
    assert isinstance(simulation, Controlled)
    *_, (state, _) = simulation.spans(1000)
    assert state.plant[1] >= 1000
    assert sum(bool(inner) for _, (_, _, inner) in simulation.courses) < 30


def test_splitting_a_run_with_events_changes_no_number():
    """A base step is divided around an event alike however many rows each call advances."""
    spec = {"id": "case", "plant": RELAY, "horizon": 30.0, "step": 0.05, "evaluate": 0.05}
    e = prepare(library.resolve(Experiment.model_validate(spec))).engine
    whole = np.concatenate([r.plant for _, r in simulation_of(e).spans(e.steps)])
    state, parts = simulation_of(e).initial(), []
    while state.k < e.steps:
        state, part = simulation_of(e).advance(state, min(7, e.steps - state.k))
        parts.append(part.plant)
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_runs_that_are_repeated_for_thresholds_locate_no_event():
    """They are long, and many: a thermostat of the documentation would otherwise take minutes to calibrate."""
    spec = {"id": "case", "plant": RELAY, "horizon": 30.0, "step": 0.05, "record": 0.05}
    repeated = Repeated()
    rows = list(repeated.spans(prepare(library.resolve(Experiment.model_validate(spec))).engine))
    assert sum(len(part.index) for part in rows) == 601
    assert rows[0].plant[:, 0].max() < 22.05, "its events act all the same"
    assert not any(inner and len(inner) < 10 for _, (_, _, inner) in repeated.courses)
