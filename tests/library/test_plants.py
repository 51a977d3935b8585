"""The library's plants have the equations of their sources."""

import numpy as np
import pytest
import sympy

from tests.engine.observers.kalman_cases import reference
from thetascope import library
from thetascope.engine.model.plant_model import Model
from thetascope.engine.observers.support.linearisation import linearise
from thetascope.engine.programs.program_store import plant_program


def model(name: str) -> Model:
    return Model(library.plant(name).model_dump(mode="json"))


def test_zhao_contois_is_equation_44():
    """Written with w = x2/x1, the plant equals eq. (44) exactly, for all parameters."""
    ours, printed = model("zhao-contois"), model("zhao-contois-as-printed")
    difference = (ours.f.xreplace(ours.expansion) - printed.f).applyfunc(sympy.simplify)
    assert difference == sympy.zeros(2, 1)
    assert ours.Phi(("theta1", "theta2", "theta3")) == printed.Phi(("theta1", "theta2", "theta3"))


def test_contois_physical_maps_to_equation_44():
    """x1 = biomass, x2 = a1 x̄1 x̄2/(a2 x̄1 + x̄2) carries (43) into (44) exactly,
    and the initial states correspond."""
    physical, canonical = model("contois-physical"), model("zhao-contois-as-printed")
    a1, a2 = physical.parameters[:2]
    one, two = physical.x
    image = sympy.Matrix([one, a1 * one * two / (a2 * one + two)])
    rate = image.jacobian(sympy.Matrix([one, two])) * physical.f.xreplace(physical.expansion)
    expected = canonical.f.xreplace(dict(zip(canonical.x, image, strict=True)))
    assert (rate - expected).applyfunc(sympy.simplify) == sympy.zeros(2, 1)
    start = {one: 0.09, two: 0.01125, a1: 1.0, a2: 1.0}
    assert [float(e.subs(start)) for e in image] == pytest.approx([0.09, 0.01])


CHANNELS = {
    "dc-motor": ("gain_loss", "load_torque", "friction_increase", "current_bias", "speed_bias"),
    "dts200": (
        *("pump1", "pump2", "flow1", "flow2", "level1", "level2", "level3"),
        *("leak1", "leak2", "leak3", "clog13", "clog32", "clog20"),
    ),
    "quadruple-tank": ("pump1", "pump2", "leak1", "leak2", "leak3", "leak4", "level1", "level2"),
}


@pytest.mark.parametrize("name", CHANNELS)
def test_equals_the_written_model(name):
    """Rates and outputs, with every fault channel, agree with a model written by hand at random points."""
    plant, random = library.plant(name), np.random.default_rng(1)
    program, hand = plant_program(plant.model_dump(mode="json")).program, reference(name, CHANNELS[name])
    assert {c.name for c in plant.channels} == set(CHANNELS[name])
    for _ in range(20):
        x, u = random.uniform(1, 20, len(plant.states)), random.uniform(1, 10, len(plant.inputs))
        s = random.uniform(0, 0.1, len(plant.signals))
        theta = random.uniform(0, 0.5, len(CHANNELS[name]))
        values = {f"p.{p.name}": p.value for p in plant.parameters} | {"t": 0.0}
        for prefix, names, numbers in (("x", plant.states, x), ("u", plant.inputs, u), ("signal", plant.signals, s)):
            values |= {f"{prefix}.{item.name}": value for item, value in zip(names, numbers, strict=True)}
        values |= {f"theta.{c}": value for c, value in zip(CHANNELS[name], theta, strict=True)}
        rates = program.evaluate([f"d.x.{item.name}" for item in plant.states], values)
        outputs = program.evaluate([f"y.{item.name}" for item in plant.outputs], values)
        assert rates == pytest.approx(hand.rate(0.0, x, u, s, theta), rel=1e-12)
        assert outputs == pytest.approx(hand.output(0.0, x, u, s, theta), rel=1e-12)


@pytest.mark.parametrize("levels", [(30.0, 30.0, 30.0), (0.0, 0.0, 0.0), (20.0, 30.0, 30.0)])
def test_three_tanks_at_equal_or_no_levels(levels):
    """At equal levels and in empty tanks the flows are zero and the observer's Jacobian is finite."""
    plant = model("dts200")
    point = dict(zip(plant.states, levels, strict=True)) | {"leak1": 0.1, "clog13": 0.2, "Q1": 0.0, "Q2": 0.0}
    A = linearise(plant, ("leak1", "clog13"), point).A
    assert np.isfinite(A).all() and np.abs(A).max() < 5
    program = plant_program(plant.data).program
    still = {f"p.{p['name']}": p["value"] for p in plant.data["parameters"]} | {"u.Q1": 0.0, "u.Q2": 0.0, "t": 0.0}
    still |= {f"theta.{c.name}": 0.0 for c in plant.channels}
    still |= {f"x.{s}": v for s, v in zip(plant.states, levels, strict=True)}
    assert program.evaluate(["d.x.h3"], still)[0] == pytest.approx(0.0 if levels[0] == levels[2] else -0.209, abs=1e-3)
