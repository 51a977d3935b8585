"""The reference's CARTS as a plant's text, and runs of one observer on it."""

from tests.simulate import simulate
from thetascope import library
from thetascope.assembly.build.healthy import healthy_run_of
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment, ResolvedExperiment

CARTS = {
    "id": "carts",
    "states": [
        {"name": "x1", "initial": 0.5},
        {"name": "x2", "initial": 0.0},
        {"name": "x3", "initial": 0.2},
        {"name": "x4", "initial": -0.3},
        {"name": "x5", "initial": 0.1},
    ],
    "inputs": [{"name": "u1"}, {"name": "u2"}],
    "parameters": [{"name": "d", "value": 0.4}],
    "definitions": [{"name": "k", "expression": "2 + cos(t)"}, {"name": "spring", "expression": "k*(x1 - x4)"}],
    "outputs": [{"name": "y1", "expression": "x1"}, {"name": "y2", "expression": "x4"}],
    "dynamics": {
        "x1": "x2",
        "x2": "-spring - d*x2 - 0.1*x2^2 + x3",
        "x3": "-2*x3 + (1 + 0.2*cos(x2))*u1",
        "x4": "x5",
        "x5": "spring - x5 - sin(x4) + (1 + 0.2*sin(t))*u2",
    },
}
STATES = ("x1", "x2", "x3", "x4", "x5")
START = (0.0, 0.3, -0.5, 0.1, 0.4)  # x̂(0)


def carts_spec(kind: str, gains: dict, horizon: float = 8.0, **spec) -> ResolvedExperiment:
    """One observer, labelled ``o``, on CARTS with the reference's inputs."""
    observer = {"label": "o", "kind": kind, "gains": gains, "initial": dict(zip(STATES, START, strict=True))}
    inputs = {
        "u1": {"kind": "expression", "text": "sin(1.3*t)"},
        "u2": {"kind": "expression", "text": "0.5*cos(0.7*t)"},
    }
    given = {"plant": CARTS, "inputs": inputs, "horizon": horizon, "evaluate": 0.01, "observers": [observer]} | spec
    return library.resolve(Experiment.model_validate(given))


def carts(kind: str, gains: dict, horizon: float = 8.0, **spec) -> Result:
    """The run of `carts_spec`."""
    return simulate(carts_spec(kind, gains, horizon, **spec))


def carts_pace(kind: str, horizon: float) -> float:
    """The rate of CARTS in its healthy run, in 1/s."""
    spec = carts_spec(kind, {}, horizon)
    return healthy_run_of(spec, spec.plant.model_dump(mode="json")).scales.rate
