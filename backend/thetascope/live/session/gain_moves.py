"""Gains that are moved while time runs: which ones can be, and how many substeps they need."""

import numpy as np

from thetascope.engine.compiler.graph import variables
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.run_experiment import allowed, needed_substeps
from thetascope.engine.simulation.experiment import Experiment, Rows, State
from thetascope.engine.simulation.simulation import Simulation
from thetascope.messages import Message
from thetascope_schemas.service.session import SetGainNow


def check_moves(experiment: Experiment, command: SetGainNow) -> None:
    """Raise SpecError if the gain enters no equation that the observer integrates."""
    for estimator in experiment.estimators:
        if estimator.label == command.observer:
            program = estimator.program
            moving = {n.split(".")[1] for n in variables(program.graph, program.update) if n.startswith("g.")}
            gains = {g.name for g in estimator.kind.gains}
            if command.gain in gains and command.gain not in moving:
                raise SpecError("gain", command.gain, Message("session.gain.fixed", gain=command.gain))


def substeps_at(experiment: Experiment, substeps: int, state: State, y: np.ndarray | None) -> int:
    """Return how many substeps a step from this state needs, at least `substeps`.

    Args:
        y: the last measurement, shape (outputs,); None before the first.

    Raises:
        SpecError: no allowed number of substeps is enough.
    """
    if y is None:
        _, rows = Simulation(experiment, substeps).advance(state, 1)
    else:
        rows = Rows(np.array([state.k]), state.plant[None], y[None], tuple(o[None] for o in state.observers))
    needed = needed_substeps(experiment, rows) if len(rows.index) else 1
    return allowed(experiment, needed) if needed > substeps else substeps
