"""The healthy run gives every plant its scales and its rate, without offsets and without any unit."""

import pytest

from thetascope import library
from thetascope.assembly.build.healthy import healthy_run_of
from thetascope.engine.observers.support.scales import Scales
from thetascope_schemas import Experiment

SINE = {"u": {"kind": "sine", "amplitude": 1.0, "frequency": 0.3}}


def scales(dynamics: dict, output: str = "x", horizon: float = 20.0, step: float = 0.01, **changes) -> Scales:
    """The scales of a plant with one output, one input and a fault of size 0.5 in its first state."""
    first = next(iter(dynamics))
    states = [{"name": n, **changes.pop(n, {})} for n in dynamics]
    plant = {
        "id": "made",
        "states": states,
        "inputs": [{"name": "u", "default": changes.pop("default", 0.0)}],
        "outputs": [{"name": "y", "expression": output} | changes.pop("y", {})],
        "dynamics": dynamics,
        "channels": [{"name": "a", "kind": "actuator", "enters": {first: 1}, "typical": 0.5}],
    }
    given = {"plant": plant, "horizon": horizon, "step": step, "inputs": changes.pop("inputs", SINE)} | changes
    spec = library.resolve(Experiment.model_validate(given))
    return healthy_run_of(spec, spec.plant.model_dump(mode="json")).scales


def test_a_lag_has_its_range_and_its_rate():
    """x' = 2 (u − x) under a square wave of ±1 covers 2 and has the rate 2 1/s."""
    square = {"u": {"kind": "pulse", "low": -1, "high": 1, "period": 10, "width": 5}}
    found = scales({"x": "2*(u - x)"}, inputs=square)
    assert found.states == pytest.approx((2.0,), rel=1e-3) and found.outputs == found.states
    assert found.rate == pytest.approx(2.0, rel=1e-12)


def test_offsets_do_not_count():
    """A room in K has the scales of the same room in °C."""
    celsius = scales({"T": "0.3*(5*u + 20 - T)"}, "T", T={"initial": 20.0})
    kelvin = scales({"T": "0.3*(5*u + 293.15 - T)"}, "T", T={"initial": 293.15})
    assert kelvin.states == pytest.approx(celsius.states, rel=1e-9) and kelvin.rate == pytest.approx(celsius.rate)
    assert kelvin.extents[0] > 293


@pytest.mark.parametrize("law", ["u - x^3", "u - x*abs(x)"])
def test_a_zero_slope_at_the_start_is_no_rate(law):
    """The rate comes from the slopes along the run, not from that at x = 0."""
    assert 0.05 < scales({"x": law}).rate < 5


def test_without_motion_a_typical_fault_gives_the_scale():
    """A plant at rest moves by what a typical fault does within one time constant: 0.5 (1 − 1/e) for x' = u − x + θ."""
    assert scales({"x": "u - x"}, inputs={}).states == pytest.approx((0.5 * (1 - 2.718281828**-1),), rel=2e-2)


def test_a_declared_scale_holds():
    """A scale that the plant declares is taken as it is."""
    found = scales({"x": "u - x"}, x={"scale": 7.0}, y={"scale": 3.0})
    assert (found.states, found.outputs) == ((7.0,), (3.0,))


def test_an_unstable_plant_has_the_scale_of_its_beginning():
    """x' = x + u grows to e^50 in 50 s; its scale stays that of the first time constant."""
    found = scales({"x": "x + u"}, horizon=50.0, x={"initial": 1.0})
    assert found.states[0] < 10 and found.extents[0] < 10


def test_an_integrator_has_the_rate_of_its_motion():
    """Without eigenvalues the rate is that of the motion; without motion it follows from the horizon."""
    assert scales({"x": "u"}).rate == pytest.approx(2 * 3.14159265 * 0.3, rel=0.2)
    assert scales({"x": "0*u"}, inputs={}).rate == pytest.approx(10 / 20.0)


def test_a_stiff_plant_is_simulated_with_substeps():
    """A lag of 2 ms at a step of 10 ms keeps its range."""
    assert scales({"x": "500*(u - x)"}).states == pytest.approx((2.0,), rel=1e-2)
