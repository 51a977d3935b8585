"""The data of a simulation: the experiment as engine objects, its state, and the rows it records."""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

import numpy as np

from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.inputs.coloured_noise import process_noise as process_noise_signal
from thetascope.engine.inputs.sensors import Measurement, Memory
from thetascope.engine.inputs.signals import Signal
from thetascope.engine.model.result import Accuracy
from thetascope.engine.observers.support.declaration import Context, Observer
from thetascope.engine.programs.kernel_cost import Spent
from thetascope.engine.simulation.loop import Loop, LoopRows
from thetascope.engine.simulation.step_control import Control
from thetascope.messages import Message

PROCESS_NOISE = "w."  # prefix of the inputs by which process noise enters the states of a true plant
PRESENCE = ("present.", "fresh.")  # prefixes of the signals that say whether a record has a reading
TRUE_ONLY = (PROCESS_NOISE, *PRESENCE)


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
    instants: np.ndarray | None = None  # times in s of its samples, where they are no multiples of the period


@dataclass(frozen=True)
class Model:
    """The plant that observers and the detector know, where it differs from the one that is simulated.

    ``parameters``: p.* of the model; ``process_noise``: w.* of the true plant with its standard deviation per √s;
    ``loop``: the controllers around the model.
    """

    plant: Program
    parameters: dict[str, float]
    process_noise: dict[str, float]
    loop: Loop | None


@dataclass(frozen=True)
class Experiment:
    """All inputs of a run as engine objects. ``signals`` holds u.*, signal.*, theta.*, r.* and w.* by name.

    With a ``loop``, the inputs that controllers set have no signal. ``plant``, ``parameters`` and ``loop`` are those of
    the true plant, whose states begin with the model's states in their order.
    """

    plant: Program
    parameters: dict[str, float]  # p.*
    x0: np.ndarray
    signals: dict[str, Signal]
    measurement: Measurement
    estimators: tuple[Estimator, ...]
    step: float
    steps: int
    every: int  # base steps between the rows at which the run is examined
    context: Context  # of the plant with all its fault channels, for filters that estimate all of them
    substeps: int | None = None  # per base step; None: one, or as many as stiff gains need
    notes: tuple[Message, ...] = ()
    loop: Loop | None = None  # the controllers; None: an open loop
    model: Model | None = None  # None: the true plant
    record: int | None = None  # base steps between the rows of the result; None: those that are examined

    @property
    def applied(self) -> tuple[str, ...]:
        """Return the inputs ``u.*`` that controllers set."""
        return () if self.loop is None else self.loop.applied

    @property
    def recorded(self) -> bool:
        """Return whether a record takes the place of the plant, so that nobody knows the true state and faults."""
        return self.measurement.readings is not None

    @property
    def given(self) -> tuple[str, ...]:
        """Return the names of the columns of known quantities in their order: u.*, signal.*, r.*."""
        plant = tuple(n for p in ("u.", "signal.") for n in self.plant.inputs if n.startswith(p))
        return plant + tuple(n for n in self.signals if n.startswith("r."))

    @property
    def modelled(self) -> "Experiment":
        """Return the experiment as observers and the detector know it: the model in place of the truth."""
        if self.model is None:
            return self if self.measurement.modelled is self.measurement else self._with_known_sensors()
        known = {name: signal for name, signal in self.signals.items() if not name.startswith(TRUE_ONLY)}
        return replace(
            self._with_known_sensors(),
            plant=self.model.plant,
            parameters=self.model.parameters,
            x0=self.x0[: len(self.model.plant.states)],
            signals=known,
            loop=self.model.loop,
            model=None,
        )

    def _with_known_sensors(self) -> "Experiment":
        return replace(self, measurement=self.measurement.modelled)

    def with_seed(self, seed: int) -> "Experiment":
        """Return the same experiment with another seed of noise; random fault shapes and parameters keep theirs."""
        signals = self.signals
        if self.model is not None:
            signals = signals | disturbances(self.model.process_noise, self.step, self.plant.time == DISCRETE, seed)
        return replace(self, signals=signals, measurement=replace(self.measurement, seed=seed))


def disturbances(process_noise: Mapping[str, float], step: float, discrete: bool, seed: int) -> dict[str, Signal]:
    """Return the signals w.* of process noise; ``process_noise``: standard deviations per √s by these names.

    A discrete plant adds its input once per step, so its noise is that of the whole step.
    """
    scale = step if discrete else 1.0
    keys = {name: (seed, 11, zlib.crc32(name.encode())) for name in process_noise}
    return {name: process_noise_signal(std * scale, step, keys[name]) for name, std in process_noise.items()}


@dataclass(frozen=True)
class State:
    """The complete state of a simulation at a base step; copy it to rewind or to fork."""

    k: int
    plant: np.ndarray
    observers: tuple[np.ndarray, ...]
    memory: Memory
    loop: np.ndarray | None = None  # the controllers' and held states
    past: np.ndarray | None = None  # the means of the applied u over the last base steps, for sampled observers
    control: Control | None = None  # of the step, where it follows the accuracy


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
    accuracy: Accuracy | None = None  # None: not measured

    def part(self, first: int, last: int | None = None) -> "Rows":
        """Return the rows from ``first`` up to ``last`` (exclusive)."""
        return self.where(slice(first, last))

    def where(self, wanted: np.ndarray | slice) -> "Rows":
        """Return the wanted rows: a mask or a slice."""
        index, plant, y = (part[wanted] for part in (self.index, self.plant, self.y))
        passed = None if self.passed is None else self.passed[wanted]
        loop = None if self.loop is None else self.loop.where(wanted)
        observers = tuple(o[wanted] for o in self.observers)
        return Rows(index, plant, y, observers, self.spent, passed, loop, self.accuracy)

    @classmethod
    def joined(cls, parts: "Sequence[Rows]") -> "Rows":
        """Return the rows of consecutive spans of one experiment."""
        spent: Spent = {}
        for part in parts:
            for name, (seconds, simulated) in part.spent.items():
                before = spent.get(name, (0.0, 0.0))
                spent[name] = before[0] + seconds, before[1] + simulated
        passed = [p.passed for p in parts if p.passed is not None]
        loops = [p.loop for p in parts if p.loop is not None]
        known = [p.accuracy for p in parts if p.accuracy is not None]
        accuracy = reduce(Accuracy.with_part, known) if known else None
        return cls(
            index=np.concatenate([p.index for p in parts]),
            plant=np.concatenate([p.plant for p in parts]),
            y=np.concatenate([p.y for p in parts]),
            observers=tuple(np.concatenate(o) for o in zip(*(p.observers for p in parts), strict=True)),
            spent=spent,
            passed=np.concatenate(passed) if len(passed) == len(parts) else None,
            loop=LoopRows.concatenated(loops) if loops else None,
            accuracy=accuracy,
        )
