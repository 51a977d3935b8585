"""Small plants as plain data, and a function from a plant and a spec to an engine experiment."""

from typing import Any

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope_schemas import Experiment


def oscillator(**changes: Any) -> dict:
    """Return a damped oscillator with a force fault, a stiffness fault and a sensor bias; smooth everywhere."""
    return {
        "id": "oscillator",
        "title": "A damped oscillator",
        "time": {"kind": "continuous"},
        "states": [{"name": "x1", "initial": 1.0}, {"name": "x2", "initial": 0.0}],
        "inputs": [{"name": "u", "default": 0.0}],
        "outputs": [{"name": "y", "expression": "x1"}],
        "parameters": [{"name": "k", "value": 4.0}, {"name": "d", "value": 0.3}],
        "signals": [],
        "definitions": [],
        "dynamics": {"x1": "x2", "x2": "-k*x1 - d*x2 - 0.2*x1^3 + u"},
        "channels": [
            {"name": "force", "kind": "actuator", "enters": {"x2": "1"}},
            {"name": "bias", "kind": "sensor", "enters": {"y": "1"}},
        ],
    } | changes


def spec(**changes: Any) -> dict:
    """Return ten seconds of the oscillator with an adaptive observer."""
    return {
        "plant": oscillator(),
        "inputs": {"u": {"kind": "sine", "amplitude": 1.0, "frequency": 0.7}},
        "faults": [{"channel": "force", "shape": "step", "onset": 3.0, "size": 0.5}],
        "noise": {"y": {"std": 0.01, "sample_time": 0.01}},
        "horizon": 10.0,
        "step": 0.005,
        "evaluate": 0.05,
        "seed": 3,
        "observers": [adaptive()],
    } | changes


def adaptive(label: str = "adaptive", channels: str = "force", **gains: float) -> dict:
    return {
        "label": label,
        "kind": "zhao-adaptive",
        "options": {"channels": channels},
        "gains": {"rho": 3.0, "lambda": 1.0, "gamma0": 1.0, "window": 2.0} | gains,
        "initial": {"x1": 0.5, "x2": 0.0},
    }


def engine(**changes: Any) -> Engine:
    return prepare(library.resolve(Experiment.model_validate(spec(**changes)))).engine
