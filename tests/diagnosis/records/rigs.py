"""Recordings of rigs, simulated by plain NumPy: a leaking tank, two heaters, and three tanks under PI control."""

from collections.abc import Callable, Mapping

import numpy as np

from thetascope import library
from thetascope.diagnosis.recording import Recording
from thetascope_schemas import Plant

Course = Callable[[int], float]

TANK = Plant.model_validate(
    {
        "id": "tank",
        "title": "Tank",
        "time": {"kind": "continuous"},
        "states": [{"name": "h", "unit": "cm", "initial": 20, "domain": [0, 60]}],
        "inputs": [{"name": "q", "unit": "cm³/s", "default": 50, "bounds": [0, 150]}],
        "outputs": [{"name": "y", "unit": "cm", "expression": "h"}],
        "parameters": [{"name": "A", "value": 154, "unit": "cm²"}, {"name": "s", "value": 0.25, "unit": "cm²"}],
        "definitions": [{"name": "out", "expression": "s*sqrt(1962*max(h, 0))", "domain": [0, None]}],
        "dynamics": {"h": "(q - out)/A"},
        "channels": [
            {"name": "pump", "kind": "actuator", "enters": {"h": "-q/A"}, "typical": 0.1, "bounds": [0, 1]},
            {"name": "leak", "kind": "process", "enters": {"h": "-sqrt(1962*max(h, 0))/A"}, "typical": 0.05},
            {"name": "offset", "kind": "sensor", "enters": {"y": "1"}, "typical": 1},
        ],
    }
)


def recorded(t: np.ndarray, u: np.ndarray, y: np.ndarray, resolution: float = 0.0) -> Recording:
    """Return a recording of complete rows."""
    u, y = np.atleast_2d(u.T).T, np.atleast_2d(y.T).T
    held = np.zeros(u.shape, dtype=bool)
    return Recording(t, u, y, held, np.full(y.shape[1], resolution), np.arange(len(t)) + 2)


def tank(fault: Mapping[str, Course] | None = None, rows: int = 500, noise: float = 0.05, seed: int = 0) -> Recording:
    """Return the tank with faults as functions of the row, one row a second."""
    fault, rng, h, lines = fault or {}, np.random.default_rng(seed), 20.0, []
    for k in range(rows):
        now = {name: course(k) for name, course in fault.items()}
        q = 50.0 if (k // 60) % 2 == 0 else 65.0
        lines.append((k, q, h + now.get("offset", 0.0) + noise * rng.standard_normal()))
        for _ in range(10):
            hole = 0.25 + now.get("leak", 0.0)
            h += 0.1 * (q * (1 - now.get("pump", 0.0)) - hole * np.sqrt(1962 * max(h, 0.0))) / 154
    t, u, y = np.array(lines).T
    return recorded(t, u, y)


def three_tanks(fault: Mapping[str, Course], rows: int = 1400, seed: int = 0) -> tuple[Plant, Recording]:
    """Return the library's three tanks under PI control with coloured sensor noise and process noise."""
    rng, area = np.random.default_rng(seed), 154.0
    h, integral, e, lines = np.array([41.0, 32.0, 36.6]), np.array([21.4, 53.8]), np.zeros(3), []
    s1, s3, s2 = 0.23, 0.225, 0.3

    def torricelli(depth: float) -> float:
        return float(np.sign(depth) * np.sqrt(1962 * abs(depth)))

    for k in range(rows):
        now = {name: course(k) for name, course in fault.items()}
        e = 0.4 * e + 0.05 * np.sqrt(1 - 0.16) * rng.standard_normal(3)
        y = h + e + np.array([now.get(f"level{i}", 0.0) for i in (1, 2, 3)])
        error = np.array([41 + 3 * np.sign(np.sin(2 * np.pi * k / 400)), 32.0]) - y[:2]
        integral = np.clip(integral + 0.05 * error, 0, 120)
        q = np.clip(integral + 2 * error, 0, 150)
        lines.append([k, *q, *y])
        for _ in range(10):
            a, b, c = s1 * torricelli(h[0] - h[2]), s3 * torricelli(h[2] - h[1]), s2 * torricelli(h[1])
            leak = [now.get(f"leak{i + 1}", 0.0) * torricelli(h[i]) for i in range(3)]
            into = q[0] * (1 - now.get("pump1", 0.0)) + now.get("flow1", 0.0)
            rate = np.array([into - a - leak[0], q[1] + b - c - leak[1], a - b - leak[2]])
            h = h + 0.1 * rate / area + 0.005 * np.sqrt(0.1) * rng.standard_normal(3)
    data = np.array(lines)
    return library.plant("dts200"), recorded(data[:, 0], data[:, 1:3], data[:, 3:])


def heaters(kelvin: bool = False, loss: Course | None = None, rows: int = 700) -> tuple[Plant, Recording]:
    """Return two heaters with sensors that lag, in °C or K; ``loss``: of heater 1's power."""
    rng, x, lines = np.random.default_rng(1), np.full(4, 23.0), []
    for k in range(rows):
        u = np.array([80.0 if (k // 150) % 2 == 0 else 30.0, 60.0 if (k // 110) % 2 else 20.0])
        y = x[2:] + 0.1 * rng.standard_normal(2)
        lines.append([k, *u, *y])
        power = u * np.array([0.01 * (1 - (loss(k) if loss else 0.0)), 0.0075])
        for _ in range(10):
            warm = 0.01 * (23.0 - x[:2]) + 0.004 * (x[1::-1] - x[:2]) + power
            x = x + 0.1 * np.concatenate([warm / 2, (x[:2] - x[2:]) / 20])
    data = np.array(lines)
    zero = 273.15 if kelvin else 0.0
    unit = "K" if kelvin else "°C"
    states = ("H1", "H2", "S1", "S2")
    plant = {
        "id": "heaters",
        "title": "Two heaters",
        "time": {"kind": "continuous"},
        "states": [{"name": n, "unit": unit, "initial": 23 + zero, "domain": [zero, 150 + zero]} for n in states],
        "inputs": [{"name": n, "unit": "%", "default": 0, "bounds": [0, 100]} for n in ("Q1", "Q2")],
        "outputs": [{"name": f"y{i}", "unit": unit, "expression": f"S{i}"} for i in (1, 2)],
        "parameters": [
            {"name": "UA", "value": 0.01, "unit": "W/K"},
            {"name": "C", "value": 2, "unit": "J/K"},
            {"name": "Ta", "value": 23 + zero, "unit": unit},
        ],
        "dynamics": {
            "H1": "(UA*(Ta - H1) + 0.004*(H2 - H1) + 0.01*Q1)/C",
            "H2": "(UA*(Ta - H2) + 0.004*(H1 - H2) + 0.0075*Q2)/C",
            "S1": "(H1 - S1)/20",
            "S2": "(H2 - S2)/20",
        },
        "channels": [
            {"name": "heater1", "kind": "actuator", "enters": {"H1": "-0.01*Q1/C"}, "typical": 0.3, "bounds": [0, 1]},
            {"name": "heater2", "kind": "actuator", "enters": {"H2": "-0.0075*Q2/C"}, "typical": 0.3, "bounds": [0, 1]},
            {"name": "off1", "kind": "sensor", "enters": {"y1": "1"}, "unit": "K", "typical": 5},
        ],
    }
    y = data[:, 3:] + zero
    return Plant.model_validate(plant), recorded(data[:, 0], data[:, 1:3], y)


def since(row: int, size: float, end: int = 10**9) -> Course:
    """Return a step."""
    return lambda k: size * (row <= k < end)
