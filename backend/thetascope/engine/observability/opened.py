"""The plant of a closed loop alone, with the inputs that the controllers applied as known signals."""

from dataclasses import replace

import numpy as np

from thetascope.engine.inputs.signals import Signal, steps
from thetascope.engine.simulation.controlled import simulation_of
from thetascope.engine.simulation.experiment import Experiment


def opened(experiment: Experiment) -> Experiment:
    """Return the experiment without its controllers; their inputs are those of a run, held over each base step.

    An experiment without controllers is returned as it is.
    """
    loop = experiment.loop
    if loop is None:
        return experiment
    fine = replace(experiment, estimators=(), every=1)
    parts = [r.loop for _, r in simulation_of(fine).spans(fine.steps + 1) if r.loop is not None]
    means = np.concatenate([part.ahead for part in parts])
    applied = {name: _held(means[:, j], experiment.step) for j, name in enumerate(loop.applied)}
    return replace(experiment, signals={**experiment.signals, **applied}, loop=None)


def _held(values: np.ndarray, step: float) -> Signal:
    """Return the signal that takes the next value at every base step."""
    changes = np.flatnonzero(np.diff(values)) + 1
    return steps(list(changes * step), [values[0], *values[changes]])
