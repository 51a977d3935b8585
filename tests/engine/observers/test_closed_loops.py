"""Every observer on a plant with a controller: it sees the applied u, and the controller is not part of its model."""

import numpy as np
import pytest

from tests.simulate import simulate
from thetascope import library
from thetascope.assembly.analyses.gains import present_gains
from thetascope.engine.observers.registry import kinds
from thetascope_schemas import Plant, ResolvedExperiment
from thetascope_schemas.experiment.signals import TableSignal

STEPS, PERIOD = 600, 10  # base steps of a run, and of the controller's period


def _of_kind(kind: str) -> tuple[ResolvedExperiment, int]:
    """Return the first library experiment with an observer of a kind, and its place among the observers.

    A plant without an input gets one, which moves its first state.
    """
    for spec in map(library.resolve, library.experiments().values()):
        for place, observer in enumerate(spec.observers):
            if observer.kind == kind and not spec.plant.controllers:
                return (spec if spec.plant.inputs else _pushed(spec)), place
    raise AssertionError(f"the library has no observer of the kind {kind}")


def _pushed(spec: ResolvedExperiment) -> ResolvedExperiment:
    data = spec.plant.model_dump()
    first = data["states"][0]["name"]
    data["inputs"] = [{"name": "push", "bounds": [-1, 1]}]
    data["dynamics"] |= {first: f"{data['dynamics'][first]} + push"}
    return spec.model_copy(update={"plant": Plant.model_validate(data)})


def _closed(spec: ResolvedExperiment, place: int) -> ResolvedExperiment:
    """Return the experiment with a controller of the first input, and only one observer."""
    plant, u = spec.plant, spec.plant.inputs[0]
    low, high = u.bounds
    swing = 0.1 * (high - low) if low is not None and high is not None else max(0.1, 0.1 * abs(u.default))
    law = f"{u.default!r} + {0.4 * swing!r}*(e - 2)*(1 + 0.1*tanh({plant.outputs[0].name}))"
    controller = {
        "name": "chopper",
        "period": PERIOD * spec.step,
        "states": [{"name": "e", "initial": 1}],
        "dynamics": {"e": "where(3.5 < e, 0, e + 1)"},
        "outputs": [{"input": u.name, "expression": law, "saturation": [u.default - swing, u.default + swing]}],
    }
    data = plant.model_dump() | {"controllers": [controller]}
    inputs = {n: s for n, s in spec.inputs.items() if n != u.name}
    update = {
        "plant": Plant.model_validate(data),
        "inputs": inputs,
        "observers": (spec.observers[place],),
        "horizon": STEPS * spec.step,
        "evaluate": spec.step,
        "record": spec.step,
        "substeps": 4,  # both runs take the same steps
        "faults": spec.faults[:1],
        "figures": (),
    }
    return ResolvedExperiment.model_validate(spec.model_copy(update=update).model_dump())


@pytest.mark.parametrize("kind", kinds())
def test_the_estimates_are_those_with_the_recorded_input(kind: str):
    """In a closed loop, every observer has the estimates that it has in an open loop with the same input."""
    spec, place = _of_kind(kind)
    closed = _closed(spec, place)
    gains = present_gains(closed)[0][spec.observers[place].label]
    one = simulate(closed)
    u = spec.plant.inputs[0].name
    t, values = one.column("t")[::PERIOD], one.column(f"u.{u}")[::PERIOD]
    assert len(np.unique(values)) > 4, "the controller moves its input"
    recorded = TableSignal(times=t.tolist(), values=values.tolist(), interpolation="hold")
    update = {"plant": spec.plant, "inputs": {**closed.inputs, u: recorded}}
    # defaults follow from the healthy run, which has another input here
    update["observers"] = (spec.observers[place].model_copy(update={"gains": gains}),)
    two = simulate(closed.model_copy(update=update))
    for column in (n for n in two.names if n.startswith(("x.", spec.observers[place].label))):
        a, b = one.column(column), two.column(column)
        size = np.nanmax(np.abs(b), initial=1e-300)
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * size, err_msg=column)
