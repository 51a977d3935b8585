"""Two tanks with a level sensor each, as a plant for tests of the record filter."""

import numpy as np

from thetascope.engine.filtering.bundles import Noise, Rows
from thetascope.engine.filtering.record_filter import RecordFilter
from thetascope.engine.programs.program_store import plant_program

PLANT = {
    "id": "two-tanks",
    "time": {"kind": "continuous"},
    "states": [{"name": "a", "initial": 4.0}, {"name": "b", "initial": 2.0}],
    "inputs": [{"name": "u"}],
    "signals": [],
    "outputs": [{"name": "y1", "expression": "a"}, {"name": "y2", "expression": "b*b/4"}],
    "parameters": [{"name": "k", "value": 0.3}, {"name": "c", "value": 0.2}],
    "definitions": [{"name": "q", "expression": "k*sqrt(max(a, 0.01))"}],
    "dynamics": {"a": "u - q", "b": "q - c*b"},
    "channels": [
        {"name": "pump", "kind": "actuator", "enters": {"a": "-u"}},
        {"name": "bias", "kind": "sensor", "enters": {"y2": "1"}},
    ],
}
TYPICAL = np.array([0.1, 0.5])
FAULTS = ("theta.pump", "theta.bias")


def rates(x: np.ndarray, u: float, theta: np.ndarray, k: float = 0.3, c: float = 0.2) -> np.ndarray:
    """Return ẋ, written anew."""
    q = k * np.sqrt(max(x[0], 0.01))
    return np.array([u * (1 - theta[0]) - q, q - c * x[1]])


def outputs(x: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Return y, written anew."""
    return np.array([x[0], x[1] ** 2 / 4 + theta[1]])


def record_filter(directions: tuple[str, ...] = FAULTS, scale: np.ndarray = TYPICAL) -> RecordFilter:
    """Return the filter of the plant."""
    return RecordFilter(
        plant_program(PLANT).program, directions, scale, np.array([0.3, 0.2]), np.full(2, -np.inf), np.full(2, np.inf)
    )


def rows(count: int, seed: int = 0, steps: float = 4.0) -> Rows:
    """Return rows at unequal intervals with random readings near the trajectory, some of them missing."""
    rng = np.random.default_rng(seed)
    width = rng.uniform(0.2, 1.8, count)
    t = np.concatenate([[0.0], np.cumsum(width)[:-1]])
    y = np.array([4.0, 1.2]) + 0.1 * rng.standard_normal((count, 2))
    y[rng.random((count, 2)) < 0.1] = np.nan
    u = 0.6 + 0.1 * rng.standard_normal((count, 1))
    at = np.full(count, -1.0)
    at[count // 2] = 0.0
    return Rows(t, width, np.full(count, steps), u, u, y, at, np.array([[[0.01, 0.002], [0.002, 0.02]]]))


def noise(coloured: bool) -> Noise:
    """Return noise, with a coloured part or without."""
    return Noise(
        np.array([1e-3, 2e-3]), np.array([0.01, 0.02]), np.array([0.5, 0.8]), np.array([0.02, 0.01]) * coloured
    )
