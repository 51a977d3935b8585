"""A plant without fault channels: every kind of observer estimates its state, or is refused with the reason."""

import numpy as np
import pytest

from tests.simulate import simulate
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.engine.observers.registry import kinds
from thetascope_schemas import Experiment

PLANT = {
    "id": "two-stages",
    "states": [{"name": "h", "initial": 1.0}, {"name": "g", "initial": 1.0}],
    "inputs": [{"name": "q", "default": 1.0}],
    "outputs": [{"name": "y", "expression": "h"}],
}
CONTINUOUS = PLANT | {"time": {"kind": "continuous"}, "dynamics": {"h": "g - h", "g": "q - g"}}
DISCRETE = PLANT | {
    "time": {"kind": "discrete", "period": 1.0},
    "dynamics": {"h": "0.5*h + 0.5*g", "g": "0.8*g + 0.2*q"},
}
#: Those whose equations need faults, or another plant.
REFUSED = {"nonsmooth-adaptive", "linear-adaptive", "sandwich-nonsmooth", "sandwich-conventional"}


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_runs_or_says_why_not(kind: str):
    """The state is found from another initial estimate, nothing is infinite, and no check breaks."""
    running = 0
    for plant, horizon, step in ((CONTINUOUS, 20.0, 0.01), (DISCRETE, 100.0, 1.0)):
        observers = [{"label": "a", "kind": kind, "initial": {"h": 0.8, "g": 1.1}}]
        data = {"plant": plant, "horizon": horizon, "step": step, "observers": observers}
        try:
            run = simulate(library.resolve(Experiment.model_validate(data)))
        except SpecError as refusal:
            assert len(str(refusal)) > 40 and "Error" not in str(refusal)
            continue
        running += 1
        assert run.observers[0].diverged is None and run.observers[0].checks
        for state in ("h", "g"):
            assert np.abs(run.column(f"a.x.{state}") - run.column(f"x.{state}"))[-1] < 0.02
    assert (running == 0) == (kind in REFUSED)
