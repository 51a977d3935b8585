"""Build the closed loop of a plant with controllers."""

from collections.abc import Mapping

import numpy as np

from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.time_grid import multiple
from thetascope.engine.model.true_plant import true_states
from thetascope.engine.programs.program_store import closed_loop_program
from thetascope.engine.simulation.loop import Loop
from thetascope_schemas import ResolvedExperiment


def loop_of(
    spec: ResolvedExperiment, data: Mapping, step: float, measurement: Measurement, nominal: bool = False
) -> Loop | None:
    """Return the controllers of an experiment; None in an open loop. Raises SpecError for those that do not fit.

    Args:
        data: the plant as JSON, or the true plant (`true_data`).
        step: the base step in s.
        measurement: the measurement of the outputs.
        nominal: whether the controllers start as the plant declares, whatever the experiment says.
    """
    plant = spec.plant
    if not plant.controllers:
        return None
    samplings = zip(plant.names("outputs"), measurement.sampled_by, strict=True)
    sampled = tuple(name for name, sampling in samplings if sampling is not None)
    every = {}
    for i, controller in enumerate(plant.controllers):
        if controller.period is not None:
            every[f"due.{controller.name}"] = multiple(controller.period, step, f"plant.controllers[{i}].period")
    quantisers = len(measurement.resolutions()[0])
    program = closed_loop_program(data, sampled, quantisers)
    given = {} if nominal else spec.initial
    start = {f"c.{s.name}": given.get(s.name, s.initial) for c in plant.controllers for s in c.states}
    start |= {f"u.{u.name}": u.default for u in plant.inputs}  # before the first instant
    states = np.array([start.get(s, np.nan) for s in program.states[true_states(data) :]], dtype=float)
    return Loop(program, states, tuple(f"u.{n}" for n in plant.controlled), every, quantisers)
