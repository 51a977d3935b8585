"""Gains that are moved while time runs: which ones can be."""

from thetascope.engine.compiler.graph import variables
from thetascope.engine.errors import SpecError
from thetascope.engine.simulation.experiment import Experiment
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
