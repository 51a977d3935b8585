"""Gains that are moved while time goes on: which of them can be, and how fine the steps must then be."""

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.run_experiment import allowed, needed_substeps
from thetascope.engine.simulation.experiment import Experiment, Rows, State
from thetascope.engine.simulation.simulation import Simulation
from thetascope_schemas.service.session import SetGainNow


def check_moves(experiment: Experiment, command: SetGainNow) -> None:
    """Raises SpecError for a gain that no equation of the observer moves by."""
    for estimator in experiment.estimators:
        if estimator.label == command.observer:
            program = estimator.program
            moving = {n.split(".")[1] for n in variables(program.graph, program.update) if n.startswith("g.")}
            known = {g.name for g in estimator.kind.gains}
            if command.gain in known and command.gain not in moving:
                raise SpecError(
                    "gain",
                    command.gain,
                    "this gain acts at the start, or on what is shown, only",
                    "remove the observer and add it with the gain you want",
                )


def substeps_at(experiment: Experiment, substeps: int, state: State, y: np.ndarray | None) -> int:
    """How many substeps a step from this state needs; ``y``: what was measured last, if anything was.

    Raises SpecError where no allowed number of them would do.
    """
    if y is None:
        _, rows = Simulation(experiment, substeps).advance(state, 1)
    else:
        rows = Rows(np.array([state.k]), state.plant[None], y[None], tuple(o[None] for o in state.observers))
    needed = needed_substeps(experiment, rows) if len(rows.index) else 1
    return allowed(experiment, needed) if needed > substeps else substeps
