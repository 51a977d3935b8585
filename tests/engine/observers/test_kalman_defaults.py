"""Defaults of the Kalman-type observers' gains follow the plant's time constants, scales and noise."""

import numpy as np
import pytest

from thetascope import library
from thetascope.engine.observability.time_constant import pace
from thetascope.engine.observers.registry import observer
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.scales import Scales, fixed
from thetascope_schemas import Plant


def plant(**dynamics: str) -> dict:
    """Return a continuous plant with these equations, its first state measured."""
    states = [{"name": s, "initial": 2.0} for s in dynamics]
    outputs = [{"name": "y", "expression": next(iter(dynamics))}]
    return Plant(id="made", states=states, outputs=outputs, dynamics=dynamics).model_dump(mode="json")


def test_pace_is_the_slowest_eigenvalue():
    """Of a fast and a slow lag it is that of the slow one, of an oscillator its frequency; integrators do not count."""
    assert pace(plant(a="-5*a", b="a - 0.1*b")) == pytest.approx(0.1, rel=1e-6)
    assert pace(plant(a="b", b="-9*a")) == pytest.approx(3.0, rel=1e-6)
    assert pace(plant(a="-4*a", b="a")) == pytest.approx(4.0, rel=1e-6)
    assert pace(plant(a="-a^3/12")) == pytest.approx(1.0, rel=1e-6)


def test_without_a_value_at_the_initial_state_the_pace_is_one():
    """An equation such as √ of a negative number there is not an error."""
    assert pace(plant(a="-sqrt(1 - a)")) == 1.0


def test_pace_of_a_discrete_plant_is_per_second():
    """A discrete lag e^(−0.5 T) has the pace 0.5 1/s."""
    data = plant(a=f"{np.exp(-0.5 * 0.2)}*a") | {"time": {"kind": "discrete", "period": 0.2}}
    assert pace(data) == pytest.approx(0.5, rel=1e-4)


def test_quadruple_tank_has_johanssons_time_constant():
    """The slowest time constant of Johansson's minimum-phase setting is his T2 = 90 s."""
    assert 1 / pace(library.plant("quadruple-tank").model_dump(mode="json")) == pytest.approx(90, abs=1)


@pytest.mark.parametrize("kind", ["adaptive-kalman", "adaptive-kalman-discrete", "joint-ekf", "joint-ukf"])
def test_defaults_scale_with_the_units(kind):
    """In metres instead of centimetres every default changes by the power of 100 of its unit."""

    def defaults(scale: float) -> dict:
        data = plant(h="-0.1*h") | {"channels": [{"name": "leak", "typical": 0.5 * scale}]}
        healthy = fixed(Scales((3 * scale,), (2 * scale,), (40 * scale,), 0.1, 100.0))
        context = Context(
            n=1, m=1, p=1, noise_std=(0.0,), step=0.1, period=1.0, model=data, channels=("leak",), healthy=healthy
        )
        return {g.name: g.default(context) for g in observer(kind).gains if callable(g.default)}

    centimetres, metres = defaults(1.0), defaults(0.01)
    for name, power in (("q", 2), ("r", 2), ("p0", 2), ("gamma0", 2), ("q_theta", 1), ("lambda", 0), ("window", 0)):
        if name in centimetres:
            assert np.ravel(metres[name]) == pytest.approx(np.ravel(centimetres[name]) * 0.01**power, rel=1e-9), name


def test_r_follows_the_declared_noise():
    """r is the variance of a sample for sampled observers, variance times hold time for continuous ones."""
    data = library.plant("dts200").model_dump(mode="json")
    context = Context(
        n=3, m=3, p=11, noise_std=(0.1, 0.2, 0.3), step=0.1, period=1.0, model=data, noise_hold=(1.0, 1.0, 2.0)
    )

    def r(kind: str) -> list[float]:
        return next(g for g in observer(kind).gains if g.name == "r").default(context)

    assert r("joint-ekf") == pytest.approx([0.01, 0.04, 0.09])
    assert r("adaptive-kalman") == pytest.approx([0.01, 0.04, 0.18])
