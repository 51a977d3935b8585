"""Plants with memory: relays with hysteresis and resets, against solutions with located events."""

import copy
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from tests import simulate as simulator
from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.plant_check import check_plant
from thetascope.engine.compiler.system import Program
from thetascope.engine.errors import SpecError
from thetascope.engine.language.render.mathml import plant_equations
from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds
from thetascope.engine.simulation.simulation import Simulation
from thetascope.in_process import run
from thetascope_schemas import Experiment, Plant, field_errors

THERMOSTAT: dict[str, Any] = {
    "id": "thermostat",
    "states": [{"name": "T", "unit": "°C", "initial": 15.0}, {"name": "on", "initial": 1.0}],
    "inputs": [{"name": "T_a", "unit": "°C", "default": 10.0}],
    "outputs": [{"name": "y", "unit": "°C", "expression": "T"}],
    "parameters": [{"name": "τ", "value": 100.0}, {"name": "P", "value": 0.3}],
    "definitions": [{"name": "high", "expression": "21 + 0*T"}],
    "dynamics": {"T": "(T_a - T)/τ + P*on", "on": "0"},
    "events": [{"when": "T > high", "set": {"on": 0}}, {"when": "T < 19", "set": {"on": 1}}],
    "channels": [{"name": "loss", "kind": "process", "enters": {"T": "-1"}, "typical": 0.02}],
}
BALL: dict[str, Any] = {
    "id": "ball",
    "states": [{"name": "h", "initial": 1.0}, {"name": "v"}],
    "outputs": [{"name": "y", "expression": "h"}],
    "parameters": [{"name": "e", "value": 0.8}],
    "dynamics": {"h": "v", "v": "-9.81"},
    "events": [{"when": "h < 0 and v < 0", "set": {"h": 0, "v": "-e*v"}}],
}
NEURON: dict[str, Any] = {  # a leaky integrator that fires at a threshold, and whose threshold rises with every spike
    "id": "neuron",
    "states": [{"name": "v"}, {"name": "a"}, {"name": "n"}],
    "inputs": [{"name": "i", "default": 0.0}],
    "outputs": [{"name": "y", "expression": "v"}],
    "dynamics": {"v": "i - v", "a": "-a/4", "n": "0"},
    "events": [{"when": "v >= 1 + a", "set": {"v": "-0.2*a", "a": "a + 0.3", "n": "n + 1"}}],
}


def simulate(spec: dict[str, Any]) -> Result:
    return simulator.simulate(library.resolve(Experiment.model_validate(spec)))


def switching_times(end: float) -> list[float]:
    """Return the times at which the thermostat switches, from the solution between them."""
    t, T, on, times = 0.0, 15.0, 1, []
    while t < end:
        far, limit = 10 + 30 * on, 21 if on else 19
        t, T, on = t + 100 * np.log((T - far) / (limit - far)), limit, 1 - on
        times.append(t)
    return times[:-1]


def bounced(t: float) -> float:
    """Return the height of the ball at t."""
    first = np.sqrt(2 / 9.81)
    if t < first:
        return 1 - 9.81 * t**2 / 2
    begin, v = first, 0.8 * 9.81 * first
    while t > begin + 2 * v / 9.81:
        begin, v = begin + 2 * v / 9.81, 0.8 * v
    return v * (t - begin) - 9.81 * (t - begin) ** 2 / 2


def test_a_thermostat_switches_when_the_temperature_crosses():
    """All switches occur in the step that contains the exact time, and the temperature agrees to the square of the
    step over the time constant."""
    spec = {"plant": THERMOSTAT, "horizon": 500.0, "step": 0.1, "evaluate": 0.1, "substeps": 1}
    result = simulate(spec)
    t, on = result.column("t"), result.column("x.on")
    times = t[1:][np.diff(on) != 0]
    exact = switching_times(500.0)
    assert len(times) == len(exact) > 20
    assert ((times - exact) > -1e-6).all() and ((times - exact) < 0.1 + 1e-6).all()
    inside = (t > exact[-3]) & (t < exact[-2])
    far = 10 + 30 * on[inside]
    began = 21.0 if on[inside][0] == 0 else 19.0
    T = far + (began - far) * np.exp(-(t[inside] - exact[-3]) / 100)
    np.testing.assert_allclose(result.column("x.T")[inside], T, atol=1e-4)


def test_the_error_of_a_bouncing_ball_falls_with_the_square_of_the_step():
    """Six bounces against the exact parabolas: a step of a tenth leaves a hundredth of the error."""
    errors = []
    for step in (1e-2, 1e-3):
        result = simulate({"plant": BALL, "horizon": 2.5, "step": step, "evaluate": 0.01, "substeps": 1})
        exact = np.array([bounced(t) for t in result.column("t")])
        errors.append(np.abs(result.column("x.h") - exact).max())
    assert errors[0] < 2e-3
    assert errors[1] < errors[0] / 50


def test_events_act_with_the_steps_that_the_run_chooses():
    """Without given substeps the ball bounces, too, at least as exactly, and every counted bounce is one."""
    counting = copy.deepcopy(BALL)
    counting["states"].append({"name": "n"})
    counting["dynamics"]["n"] = "0"
    counting["events"][0]["set"]["n"] = "n + 1"
    result = simulate({"plant": counting, "horizon": 2.5, "step": 1e-2, "evaluate": 0.01})
    exact = np.array([bounced(t) for t in result.column("t")])
    assert np.abs(result.column("x.h") - exact).max() < 2e-3
    assert result.column("x.n")[-1] == 4


def test_an_integrator_that_fires_agrees_with_located_events():
    """Spikes, an adapting threshold and a counter under a sine agree with solve_ivp, restarted at each event."""
    sine = {"kind": "sine", "amplitude": 1.0, "frequency": 0.3, "offset": 2.0}
    spec = {"plant": NEURON, "horizon": 12.0, "step": 1e-3, "evaluate": 0.01, "substeps": 1, "inputs": {"i": sine}}
    result = simulate(spec)

    def rate(t: float, x: np.ndarray) -> list[float]:
        return [2 + np.sin(2 * np.pi * 0.3 * t) - x[0], -x[1] / 4]

    def fires(t: float, x: np.ndarray) -> float:
        return x[0] - 1 - x[1]

    fires.terminal, fires.direction = True, 1
    t, x, spikes, rows = 0.0, np.zeros(2), 0, result.column("t")
    values = np.empty((len(rows), 3))
    while t < 12.0:
        part = solve_ivp(rate, (t, 12.0), x, dense_output=True, events=fires, rtol=1e-10, atol=1e-12)
        inside = (rows >= t) & (rows <= part.t[-1])
        values[inside] = np.vstack([part.sol(rows[inside]), np.full(inside.sum(), spikes)]).T
        t, x, spikes = part.t[-1], np.array([-0.2 * part.y[1, -1], part.y[1, -1] + 0.3]), spikes + 1
    assert spikes > 5
    np.testing.assert_array_equal(result.column("x.n"), values[:, 2])
    np.testing.assert_allclose(result.column("x.v"), values[:, 0], atol=1e-5)


def test_a_span_may_be_divided_anywhere():
    """Advanced a few steps at a time, plant and observer have the bits of one span; the stored program is the same."""
    spec = {"plant": THERMOSTAT, "horizon": 60.0, "step": 0.1, "evaluate": 0.1, "substeps": 1}
    spec |= {
        "observers": [{"label": "a", "kind": "adaptive-kalman"}],
        "noise": {"y": {"std": 0.05, "sample_time": 0.1}},
    }
    engine = prepare(library.resolve(Experiment.model_validate(spec))).engine
    assert Program.from_json(engine.plant.to_json()) == engine.plant
    whole, _ = Simulation(engine).advance(Simulation(engine).initial(), 600)
    state = Simulation(engine).initial()
    for count in (1, 13, 86, 200, 300):
        state, _ = Simulation(engine).advance(state, count)
    np.testing.assert_array_equal(state.plant, whole.plant)
    np.testing.assert_array_equal(state.observers[0], whole.observers[0])


def test_every_kind_of_observer_runs_on_a_plant_with_events_or_says_why_not():
    """The Kalman kinds run and switch as the plant does while it is healthy; the detector names the loss."""
    report = check_plant(Plant.model_validate(THERMOSTAT))
    possible = {entry["kind"] for entry in report["observers"] if entry["possible"]}
    assert {entry["kind"] for entry in report["observers"]} == set(kinds())
    assert possible == {"adaptive-kalman", "adaptive-kalman-discrete", "joint-ekf", "joint-ukf"}
    assert all(entry["why"] for entry in report["observers"] if not entry["possible"])
    assert report["observability"]["rank"] == report["observability"]["size"] == 2
    spec = {"plant": THERMOSTAT, "horizon": 600.0, "step": 0.1, "evaluate": 0.5, "seed": 1}
    spec |= {
        "noise": {"y": {"std": 0.05, "sample_time": 0.1}},
        "observers": [{"label": k, "kind": k} for k in possible],
    }
    spec |= {"faults": [{"channel": "loss", "shape": "step", "onset": 250, "size": 0.03}]}
    result = run(spec)
    healthy = result.column("t") < 250
    for kind in possible:
        wrong = np.abs(result.column(f"{kind}.x.on") - result.column("x.on")) > 0.5
        assert wrong[healthy].mean() < 0.02
        assert np.isfinite(result.column(f"{kind}.theta.loss")).all()
    finding = result.diagnosis["detector"]["sentence"]["args"]
    assert finding["channel"] == "loss"
    assert finding["size"] == pytest.approx(0.03, abs=0.004)


def changed(**event: Any) -> dict[str, Any]:
    plant = copy.deepcopy(THERMOSTAT)
    plant["events"][0] |= event
    return plant


@pytest.mark.parametrize(
    ("plant", "field", "says"),
    [
        (changed(when="T"), "events.0.when", "condition is needed"),
        (changed(when="T > q"), "events.0.when", "unknown name 'q'"),
        (changed(set={"on": "T >"}), "events.0.set.on", "missing"),
    ],
)
def test_events_that_cannot_be_read_are_refused_at_their_place(plant: dict[str, Any], field: str, says: str):
    """The condition and the values are checked like all expressions."""
    with pytest.raises(SpecError) as caught:
        Model(Plant.model_validate(plant).model_dump(mode="json"))
    assert caught.value.field == field
    assert says in str(caught.value)


@pytest.mark.parametrize(
    "plant", [changed(set={"off": 0}), changed(set={}), THERMOSTAT | {"time": {"kind": "discrete", "period": 1.0}}]
)
def test_events_of_unknown_states_and_in_discrete_time_are_refused(plant: dict[str, Any]):
    """An event sets states of a continuous plant."""
    with pytest.raises(ValidationError) as caught:
        Plant.model_validate(plant)
    assert field_errors(caught.value.errors(), plant)[0].field.startswith("events[0]")


def test_the_equations_show_events_and_algebraic_variables():
    """An event is shown as a new value with its condition, an implicit equation as left = right."""
    plant = Plant.model_validate(BALL | {"algebraic": [{"name": "z", "equation": "z^3 = h"}]})
    lines = plant_equations(plant.model_dump(mode="json"))["definitions"]
    assert [line["name"] for line in lines] == ["z", "h", "v"]
    assert "<mo>=</mo>" in lines[0]["math"]
    assert all("<mo>+</mo></msup>" in line["math"] and "if " in line["math"] for line in lines[1:])
