"""The plants on which benchmarks/coverage.py counts intervals: one lasting step in a channel named `fault` each.

Linear and nonlinear plants, closed loops written as states, and plants in pascals, kelvin and metres in orbit. In half
of them the fault begins between two rows.
"""

from typing import Any

from thetascope_schemas import Experiment

INPUT = {"u": {"kind": "sine", "amplitude": 1, "frequency": 0.3}}
ACTUATOR, SENSOR = {"kind": "actuator", "enters": {"x": "1"}}, {"kind": "sensor", "enters": {"y": "1"}}
LEVELS: dict[str, Any] = {
    "states": {"a": (1, 0, 4), "b": (1, 0, 4)},
    "outputs": {"y": "a", "w": "b"},
    "dynamics": {"a": "u - sqrt(max(a, 0.01))", "b": "sqrt(max(a, 0.01)) - sqrt(max(b, 0.01))"},
    "noise": 0.02,
    "inputs": {"u": {"kind": "sine", "amplitude": 0.3, "frequency": 0.05, "offset": 1}},
    "horizon": 120,
    "step": 0.1,
}
LEAK = {"kind": "process", "enters": {"a": "-sqrt(max(a, 0.01))"}}
BIAS = {"kind": "sensor", "enters": {"w": "1"}}


def _simple(dynamics: dict[str, str], channel: dict, onset: float, y: str = "x", **more: Any) -> dict[str, Any]:
    """Return a case of states near zero with one output, noise of 0.01 in rows of 10 ms and a fault of 0.2."""
    states = dict.fromkeys(dynamics, (0, -5, 5))
    case = {"states": states, "outputs": {"y": y}, "dynamics": dynamics, "noise": 0.01, "inputs": INPUT, "horizon": 30}
    return case | {"step": 0.01, "channel": channel, "onset": onset, "size": 0.2} | more


CASES: dict[str, dict[str, Any]] = {
    "linear": _simple({"x": "u - x"}, ACTUATOR, 15.0),
    "drag": _simple({"x": "u - x*abs(x)"}, ACTUATOR, 15.0),
    "cubic": _simple({"x": "u - x^3"}, ACTUATOR, 15.004),
    "root": _simple({"x": "u - x*abs(x)^0.5"}, ACTUATOR, 15.0),
    "sensor of a linear plant": _simple({"x": "u - x"}, SENSOR, 15.004),
    "sensor of a cubic plant": _simple({"x": "u - x^3"}, SENSOR, 15.0),
    "pendulum": _simple({"x": "u - 2*sin(z) - 0.5*x", "z": "x"}, ACTUATOR, 15.004, "z"),
    "van der Pol": _simple({"x": "(1 - z^2)*x - z + u", "z": "x"}, ACTUATOR, 15.0, "z"),
    "proportional loop": _simple({"x": "-x + 4*(u - x)"}, ACTUATOR, 15.004),
    "integral loop": _simple({"x": "-x + z", "z": "2*(u - x) - 0.2*z"}, ACTUATOR, 15.0),
    "weak fault, drag": _simple({"x": "u - x*abs(x)"}, ACTUATOR, 15.0, size=0.04),
    "friction that grows": _simple(
        {"x": "10*u - 2*x - 3*tanh(5*x)"}, {"kind": "process", "enters": {"x": "-x"}}, 15.002, size=0.1, noise=0.05
    ),
    "leak of two tanks": {**LEVELS, "channel": LEAK, "other": BIAS, "onset": 60.0, "size": 0.1},
    "sensor of two tanks": {**LEVELS, "channel": BIAS, "other": LEAK, "onset": 60.04, "size": 0.03},
    "level loop": {
        "states": {"x": (1, 0, 4), "z": (1, -10, 10)},
        "outputs": {"y": "x"},
        "dynamics": {"x": "2*(u - x) + z - sqrt(max(x, 0.01))", "z": "0.3*(u - x)"},
        "noise": 0.01,
        "inputs": {"u": {"kind": "pulse", "low": 0.8, "high": 1.2, "period": 30, "width": 15}},
        "horizon": 120,
        "step": 0.1,
        "channel": ACTUATOR,
        "onset": 60.03,
        "size": -0.1,
    },
    "stirred tank reactor": {
        "states": {"c": (0.9, 0, 1), "x": (320, 250, 450)},
        "outputs": {"y": "x"},
        "dynamics": {
            "c": "1 - c - 7.2e10*exp(-8750/x)*c",
            "x": "350 - x + 209.2*7.2e10*exp(-8750/x)*c + 2.092*(u - x)",
        },
        "noise": 0.1,
        "inputs": {"u": {"kind": "sine", "amplitude": 3, "frequency": 0.2, "offset": 295}},
        "horizon": 30,
        "step": 0.01,
        "channel": {"kind": "actuator", "enters": {"x": "2.092"}},
        "onset": 15.004,
        "size": -2.0,
    },
    "hydraulic cylinder": {
        "states": {"p": (2e6, 0, 1e7), "v": (0, -2, 2)},
        "outputs": {"y": "p", "w": "v"},
        "dynamics": {"p": "1e12*(u - 2e-3*v - 5e-12*p)", "v": "(2e-3*p - 300*v - 1000)/50"},
        "noise": {"y": 2e4, "w": 0.01},
        "inputs": {"u": {"kind": "sine", "amplitude": 2e-4, "frequency": 0.5, "offset": 1e-3}},
        "horizon": 10,
        "step": 0.002,
        "channel": {"kind": "actuator", "enters": {"p": "1e12"}},
        "onset": 5.0013,
        "size": 2e-5,
    },
    "orbit": {
        "states": {"r": (7e6, 6.5e6, 9e6), "v": (0, -1e3, 1e3)},
        "outputs": {"y": "r"},
        "dynamics": {"r": "v", "v": "5.2823e10^2/r^3 - 3.986e14/r^2 + u"},
        "noise": 10,
        "inputs": {"u": {"kind": "sine", "amplitude": 0.1, "frequency": 0.0005}},
        "horizon": 6000,
        "step": 2,
        "channel": {"kind": "actuator", "enters": {"v": "1"}},
        "onset": 3000.0,
        "size": 0.05,
    },
}


def experiment(name: str) -> Experiment:
    """Return the experiment of one case."""
    case = CASES[name]
    outputs, noise = case["outputs"], case["noise"]
    channels = {"fault": case["channel"]} | ({"other": case["other"]} if "other" in case else {})
    plant = {
        "id": "coverage",
        "states": [{"name": n, "initial": x, "domain": [low, high]} for n, (x, low, high) in case["states"].items()],
        "inputs": [{"name": "u"}],
        "outputs": [{"name": n, "expression": e} for n, e in outputs.items()],
        "dynamics": case["dynamics"],
        "channels": [{"name": n, "typical": abs(case["size"]), **c} for n, c in channels.items()],
    }
    stds = noise if isinstance(noise, dict) else dict.fromkeys(outputs, noise)
    spec = {
        "id": "coverage",
        "plant": plant,
        "inputs": case["inputs"],
        "horizon": case["horizon"],
        "step": case["step"],
        "noise": {n: {"std": std, "sample_time": case["step"]} for n, std in stds.items()},
        "faults": [{"channel": "fault", "shape": "step", "onset": case["onset"], "size": case["size"]}],
        "observers": [],
    }
    return Experiment.model_validate(spec)
