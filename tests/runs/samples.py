"""Experiments on a small plant: one that takes milliseconds and one that takes seconds."""

from thetascope_schemas.experiment.experiment import Experiment

PLANT = {
    "id": "first-order",
    "states": [{"name": "x", "initial": 1}],
    "inputs": [{"name": "u"}],
    "outputs": [{"name": "y", "expression": "x"}],
    "parameters": [{"name": "a", "value": 0.5}],
    "dynamics": {"x": "-a*x + u"},
    "channels": [{"name": "gain", "kind": "actuator", "enters": {"x": "u"}}],
}


def spec_data(**changes: object) -> dict:
    """A second of the plant under a sine, with an actuator fault and an observer, as JSON data."""
    return {
        "plant": PLANT,
        "horizon": 1,
        "inputs": {"u": {"kind": "sine", "amplitude": 1, "frequency": 2}},
        "faults": [{"channel": "gain", "shape": "step", "onset": 0.5, "size": 0.2}],
        "noise": {"y": {"std": 0.001}},
        "observers": [{"label": "kalman", "kind": "adaptive-kalman"}],
        **changes,
    }


def spec(**changes: object) -> Experiment:
    return Experiment.model_validate(spec_data(**changes))


def long_data(**changes: object) -> dict:
    """Some seconds of computing: 15 million steps of four substeps."""
    return spec_data(horizon=15_000, evaluate=10, substeps=4, **changes)


def long_spec(**changes: object) -> Experiment:
    return Experiment.model_validate(long_data(**changes))
