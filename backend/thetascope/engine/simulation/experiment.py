"""The data of a simulation: the experiment as engine objects, its state, and the rows it records."""

from dataclasses import dataclass, field

import numpy as np

from thetascope.engine.compiler.system import Program
from thetascope.engine.inputs.sensors import Measurement, Memory
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.observers.support.declaration import Context, Observer
from thetascope.engine.simulation.kernel_cost import Spent
from thetascope.engine.simulation.loop import Loop, LoopRows
from thetascope.messages import Message


def leading_rows(states: np.ndarray, limits: np.ndarray | float) -> int:
    """Return the number of rows (rows, n) before the first state that is not finite or not below its limit (n,)."""
    bad = ~(np.abs(states) < limits).all(axis=1)
    return int(np.argmax(bad)) if bad.any() else len(states)


@dataclass(frozen=True)
class Estimator:
    """One observer of an experiment: its program, parameters and initial values."""

    label: str
    kind: Observer
    program: Program
    channels: tuple[str, ...]
    parameters: dict[str, float]  # g.*, m.*, x0.*, theta0.*
    facts: dict
    context: Context
    every: int | None = None  # base steps per sample period; None: it runs in the plant's time
    since: int = 0  # base step at which it was added


@dataclass(frozen=True)
class Experiment:
    """All inputs of a run as engine objects. ``signals`` holds u.*, signal.*, theta.* and r.* by name.

    With a ``loop``, the inputs that controllers set have no signal.
    """

    plant: Program
    parameters: dict[str, float]  # p.*
    x0: np.ndarray
    signals: dict[str, Signal]
    measurement: Measurement
    estimators: tuple[Estimator, ...]
    step: float
    steps: int
    every: int  # base steps between recorded rows
    context: Context  # of the plant with all its fault channels, for filters that estimate all of them
    substeps: int | None = None  # per base step; None: one, or as many as stiff gains need
    notes: tuple[Message, ...] = ()
    loop: Loop | None = None  # the controllers; None: an open loop

    @property
    def applied(self) -> tuple[str, ...]:
        """Return the inputs ``u.*`` that controllers set."""
        return () if self.loop is None else self.loop.applied

    @property
    def given(self) -> tuple[str, ...]:
        """Return the names of the columns of known quantities in their order: u.*, signal.*, r.*."""
        plant = tuple(n for p in ("u.", "signal.") for n in self.plant.inputs if n.startswith(p))
        return plant + tuple(n for n in self.signals if n.startswith("r."))


@dataclass(frozen=True)
class State:
    """The complete state of a simulation at a base step; copy it to rewind or to fork."""

    k: int
    plant: np.ndarray
    observers: tuple[np.ndarray, ...]
    memory: Memory
    loop: np.ndarray | None = None  # the controllers' and held states
    past: np.ndarray | None = None  # the means of the applied u over the last base steps, for sampled observers


@dataclass(frozen=True)
class Rows:
    """Recorded rows of a span: base-step indices, plant states (rows × n), measured y (rows × m), observer states.

    ``spent`` is measured processor time, so it differs each time; no number of a run depends on it.
    """

    index: np.ndarray
    plant: np.ndarray
    y: np.ndarray
    observers: tuple[np.ndarray, ...]
    spent: Spent = field(default_factory=dict)
    passed: np.ndarray | None = None  # rows × m: the measurement before each row, where it is recorded
    loop: LoopRows | None = None

    def part(self, first: int, last: int | None = None) -> "Rows":
        """Return the rows from ``first`` up to ``last`` (exclusive)."""
        index, plant, y = (part[first:last] for part in (self.index, self.plant, self.y))
        passed = None if self.passed is None else self.passed[first:last]
        loop = None if self.loop is None else self.loop.part(first, last)
        return Rows(index, plant, y, tuple(o[first:last] for o in self.observers), self.spent, passed, loop)
