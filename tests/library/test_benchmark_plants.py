"""The benchmark plants agree with SciPy's Radau at 1e-11 on their equations, written by hand in SI units."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.simulate import simulate
from thetascope import library
from thetascope_schemas import ResolvedExperiment

Numbers = dict[str, float]


@dataclass(frozen=True)
class Hand:
    """A plant by hand: slopes and outputs of (x, fault by channel), constant inputs, and a horizon in s."""

    inputs: Numbers
    horizon: float
    slopes: Callable[[np.ndarray, Numbers], list[float]]
    outputs: Callable[[np.ndarray, Numbers], list[np.ndarray]]


def reactor(x: np.ndarray, fault: Numbers) -> list[float]:
    """Balances per minute, as Henson & Seborg print them, by 60."""
    c, T = x
    rate = (1 - fault["catalyst"]) * 7.2e10 * np.exp(-8750 / T) * c
    jacket = (1 - fault["fouling"]) * 5e4 / (1000 * 0.239 * 100) * (302 - T) + 5e4 / 23900 * fault["coolant"]
    return [(1 - c - rate) / 60, (350 - T + 5e4 / 239 * rate + jacket) / 60]


def heaters(x: np.ndarray, fault: Numbers) -> list[float]:
    """Energy balances of two bodies of 4 g and 500 J/(kg K)."""
    sigma, room, (one, two) = 5.67e-8, 23 + 273.15, x
    across = 20 * 2e-4 * (two - one) + 0.9 * sigma * 2e-4 * (two**4 - one**4)

    def lost(T: float) -> float:
        return 10 * (1 + fault["draught"]) * 1e-3 * (T - room) + 0.9 * sigma * 1e-3 * (T**4 - room**4)

    first = 0.01 * 60 * (1 - fault["heater1"]) - lost(one) + across
    second = 0.0075 * 45 * (1 - fault["heater2"]) - lost(two) - across
    return [first / (0.004 * 500), second / (0.004 * 500)]


def servo(x: np.ndarray, fault: Numbers) -> list[float]:
    """Newton's law and continuity; the valve is open in the positive direction."""
    at, v, p = x
    flow = (1 - fault["valve"]) * 6.67e-4 * 0.1 * np.sqrt((21e6 - p) / 7e6)
    leak = (2e-12 + fault["leakage"]) * p
    force = p * 1e-3 - (2000 + fault["friction"]) * v - 1e5 * at
    return [v, force / 200, 4 * 7e8 / 5e-4 * (flow - 1e-3 * v - leak)]


def motor(x: np.ndarray, fault: Numbers) -> list[float]:
    """Voltages and torque in the frame of the rotor, with the electrical speed."""
    d, q, speed = x
    electrical, flux = 4 * speed, 0.175 * (1 - fault["magnets"])
    return [
        (3 - 2.875 * d + electrical * 0.0085 * q) / 0.0085,
        (40 * (1 - fault["inverter"]) - 2.875 * q - electrical * (0.0085 * d + flux)) / 0.0085,
        (1.5 * 4 * flux * q - 0.001 * speed - fault["load"]) / 0.0008,
    ]


HAND = {
    "cstr": Hand({"Tc": 302, "q": 100 / 60}, 120, reactor, lambda x, f: [x[0], x[1] + f["thermometer"]]),
    "two-heaters": Hand(
        {"Q1": 60, "Q2": 45}, 200, heaters, lambda x, f: [x[0] + f["thermometer1"], x[1] + f["thermometer2"]]
    ),
    "hydraulic-servo": Hand({"u": 0.1}, 0.1, servo, lambda x, f: [x[0] + f["position"], x[2]]),
    "pmsm": Hand({"vd": 3, "vq": 40}, 0.1, motor, lambda x, f: [x[0], x[1] + f["current"], x[2]]),
}


@pytest.mark.parametrize("faulty", [False, True])
@pytest.mark.parametrize("name", HAND)
def test_a_run_is_the_solution_of_the_equations(name: str, faulty: bool):
    """States and outputs, without faults and with all of them at half their typical size from the start."""
    hand, plant = HAND[name], library.plant(name)
    size = {channel.name: faulty * channel.typical / 2 for channel in plant.channels}
    spec = library.resolve(library.experiment(name)).model_dump(mode="json") | {
        "inputs": {u: {"kind": "constant", "value": value} for u, value in hand.inputs.items()},
        "faults": [{"channel": c, "shape": "step", "onset": 0, "size": s} for c, s in size.items() if faulty],
        "noise": {},
        "horizon": hand.horizon,
        "observers": [],
        "diagnosis": {"enabled": False},
    }
    result = simulate(ResolvedExperiment.model_validate(spec))
    start, t = [state.initial for state in plant.states], result.column("t")
    tiny = 1e-12 * np.array([state.scale for state in plant.states])
    exact = solve_ivp(lambda _, x: hand.slopes(x, size), (0, t[-1]), start, "Radau", t, rtol=1e-11, atol=tiny)
    for row, state in zip(exact.y, plant.states, strict=True):
        np.testing.assert_allclose(result.column(f"x.{state.name}"), row, rtol=0, atol=5e-6 * state.scale)
    for row, output in zip(hand.outputs(exact.y, size), plant.outputs, strict=True):
        atol = 5e-6 * np.abs(row).max()
        np.testing.assert_allclose(result.column(f"y.{output.name}"), row, rtol=0, atol=atol)
