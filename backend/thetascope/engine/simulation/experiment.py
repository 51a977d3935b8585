"""What a simulation advances: the experiment as engine objects, its state, and the rows that it records."""

from dataclasses import dataclass, field

import numpy as np

from thetascope.engine.compiler.system import Program
from thetascope.engine.inputs.sensors import Measurement, Memory
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.observers.support.declaration import Context, Observer
from thetascope.engine.simulation.kernel_cost import Spent
from thetascope.messages import Message


@dataclass(frozen=True)
class Estimator:
    """One observer of an experiment: its program and the numbers for it."""

    label: str
    kind: Observer
    program: Program
    channels: tuple[str, ...]
    parameters: dict[str, float]  # g.*, m.*, x0.*, theta0.*
    facts: dict
    context: Context
    every: int | None = None  # base steps in its sample period; None: runs in the plant's own time
    since: int = 0  # base step at which it began to watch


@dataclass(frozen=True)
class Experiment:
    """Everything a run is made of, as engine objects. ``signals`` holds u.*, signal.* and theta.* by name."""

    plant: Program
    parameters: dict[str, float]  # p.*
    x0: np.ndarray
    signals: dict[str, Signal]
    measurement: Measurement
    estimators: tuple[Estimator, ...]
    step: float
    steps: int
    every: int  # base steps between recorded rows
    context: Context  # of the plant with all its channels, for filters of the plant itself
    substeps: int | None = None  # in each base step; None: one, or what stiff gains need
    notes: tuple[Message, ...] = ()


@dataclass(frozen=True)
class State:
    """Where a simulation stands: copy it to rewind or fork."""

    k: int
    plant: np.ndarray
    observers: tuple[np.ndarray, ...]
    memory: Memory


@dataclass(frozen=True)
class Rows:
    """Recorded rows of a span: base-step indices, plant states (rows × n), measured y (rows × m), observer states.

    ``spent`` is measured, not computed: it differs each time, and no number of a run depends on it.
    """

    index: np.ndarray
    plant: np.ndarray
    y: np.ndarray
    observers: tuple[np.ndarray, ...]
    spent: Spent = field(default_factory=dict)
    passed: np.ndarray | None = None  # rows × m: what was measured just before; where it is remembered

    def part(self, first: int, last: int | None = None) -> "Rows":
        """Some of the rows."""
        index, plant, y = (part[first:last] for part in (self.index, self.plant, self.y))
        passed = None if self.passed is None else self.passed[first:last]
        return Rows(index, plant, y, tuple(o[first:last] for o in self.observers), self.spent, passed)
