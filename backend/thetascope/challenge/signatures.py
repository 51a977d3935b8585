"""Noise-free outputs of a challenge under many possible faults: what each would have done to the readings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thetascope import library
from thetascope.assembly import prepare
from thetascope.challenge.experiments import experiment_of, fault_of, setup_plant
from thetascope.engine.inputs import fault_signals
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.simulation.batch import run_batch
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.simulation import row_values
from thetascope_schemas.experiment.measurement import ContinuousMeasurement
from thetascope_schemas.service.learning.challenge import HiddenFault


@dataclass(frozen=True)
class Signatures:
    """The noise-free readings of a set-up with one of its inputs.

    `t` (rows,) are the times in s, `deviations` (outputs,) the standard deviations of the noise.
    """

    base: Engine
    t: np.ndarray
    deviations: np.ndarray
    outputs: tuple[str, ...]

    def outputs_with(self, faults: Sequence[HiddenFault | None]) -> np.ndarray:
        """Return the readings (faults, rows, outputs) in deviations of the noise."""
        engines = [self._engine(fault) for fault in faults]
        states = run_batch(engines).plant
        return np.stack([self._readings(e, x) for e, x in zip(engines, states, strict=True)])

    def _engine(self, fault: HiddenFault | None) -> Engine:
        if fault is None:
            return self.base
        signal = fault_signals.theta(fault.channel, [fault_of(fault).model_dump(mode="json")], 0)
        return replace(self.base, signals=self.base.signals | {f"theta.{fault.channel}": signal})

    def _readings(self, engine: Engine, states: np.ndarray) -> np.ndarray:
        index = np.arange(len(self.t)) * engine.every
        return probe(engine.plant, self.outputs, row_values(engine, index, states)).T / self.deviations


@lru_cache(maxsize=32)
def signatures_of(id: str, program: int) -> Signatures:
    """Return the readings of a set-up with one of its inputs."""
    setup = library.mysteries()[id]
    spec = experiment_of(setup, program, None, 0)
    quiet = spec.model_copy(update={"measurement": ContinuousMeasurement(), "noise": {}})
    base = prepare(quiet).engine
    every = round(setup.record / setup.step)
    rows = round(setup.horizon / setup.record) + 1
    names = setup_plant(setup.id).names("outputs")
    deviations = np.array([setup.noise[name].std for name in names])
    return Signatures(
        replace(base, every=every, record=every),
        np.arange(rows) * setup.record,
        deviations,
        tuple(f"y.{name}" for name in names),
    )
