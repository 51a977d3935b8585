"""Experiments on a level under PI control, as plain data."""

from typing import Any

from thetascope_schemas import Experiment, ResolvedExperiment


def level(period: float | None = None, **changes: Any) -> dict:
    """Return a tank whose level a PI controller holds; ``period`` of the controller in s, None: continuous."""
    return {
        "id": "level-loop",
        "states": [{"name": "h", "initial": 1, "domain": [0, 3]}],
        "inputs": [{"name": "q", "default": 0.5, "bounds": [0, 2]}],
        "outputs": [{"name": "y", "expression": "h"}],
        "parameters": [{"name": "Kp", "value": 2}, {"name": "Ki", "value": 0.5}, {"name": "c", "value": 0.5}],
        "dynamics": {"h": "q - c*sqrt(max(h, 0))"},
        "channels": [
            {"name": "leak", "kind": "process", "enters": {"h": "-sqrt(max(h, 0))"}, "typical": 0.1},
            {"name": "bias", "kind": "sensor", "enters": {"y": 1}, "typical": 0.05},
        ],
        "references": [{"name": "r", "default": 1, "bounds": [0.5, 1.5]}],
        "controllers": [
            {
                "name": "pi",
                "period": period,
                "states": [{"name": "e"}],
                "definitions": [{"name": "v", "expression": "Kp*(r - y) + Ki*e + 0.5"}],
                "dynamics": {"e": "r - y" if period is None else f"e + {period}*(r - y)"},
                "outputs": [{"input": "q", "expression": "v", "saturation": [0, 2]}],
            }
        ],
    } | changes


def experiment(plant: dict | None = None, **changes: Any) -> ResolvedExperiment:
    """Return an experiment of 60 s on the level, by default with set points 1, 1.3 and 1."""
    data = {
        "plant": plant or level(),
        "inputs": {"r": {"kind": "steps", "times": [20, 40], "values": [1, 1.3, 1]}},
        "horizon": 60,
        "step": 0.01,
        "evaluate": 0.1,
        "diagnosis": {"enabled": False},
    } | changes
    spec = Experiment.model_validate(data)
    return spec.with_plant(spec.plant)  # pyright: ignore[reportArgumentType]
