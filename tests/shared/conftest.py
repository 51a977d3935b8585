"""A small plant and an experiment on it, as the plain data that a user would send."""

import copy
from typing import Any

import pytest

PLANT: dict[str, Any] = {
    "id": "lag",
    "title": "Lag",
    "states": [{"name": "x1", "unit": "m", "initial": 1}, {"name": "x2"}],
    "inputs": [{"name": "u", "default": 0.5}],
    "outputs": [{"name": "y", "expression": "x1 + x2"}],
    "parameters": [{"name": "a", "value": 2, "bounds": [0, 10]}],
    "signals": [{"name": "phi", "default": {"kind": "pulse", "period": 1, "width": 0.5}}],
    "definitions": [{"name": "w", "expression": "x1*x2", "domain": [0, "a"]}],
    "dynamics": {"x1": "-a*x1 + w", "x2": "u - x2"},
    "channels": [
        {"name": "theta1", "kind": "actuator", "enters": {"x1": "phi", "x2": 1}},
        {"name": "theta2", "kind": "sensor", "enters": {"y": "1"}},
    ],
}

EXPERIMENT: dict[str, Any] = {
    "id": "try",
    "title": "A try",
    "plant": PLANT,
    "inputs": {"u": {"kind": "steps", "times": [1, 2], "values": [0, 1, 0]}},
    "faults": [
        {"channel": "theta2", "shape": "step", "onset": 3, "size": 0.1},
        {"output": "y", "shape": "delay", "onset": 4, "end": 5, "delay": 0.2},
    ],
    "noise": {"y": {"std": 0.01}},
    "seed": 3,
    "horizon": 10,
    "step": 0.01,
    "observers": [{"label": "adaptive", "kind": "adaptive-kalman", "gains": {"lambda": 4, "R": [1, 2]}}],
}


@pytest.fixture
def plant() -> dict[str, Any]:
    return copy.deepcopy(PLANT)


@pytest.fixture
def experiment() -> dict[str, Any]:
    return copy.deepcopy(EXPERIMENT)
