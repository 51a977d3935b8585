"""Plants and observers as linear systems about a point, for control design: NumPy arrays, or systems of python-control.

plant = linearise("quadruple-tank", at={"h1": 12.4})
plant.A, plant.B                                      # NumPy arrays; plant.inputs names the columns
to_control("quadruple-tank")                          # a control.StateSpace with the same names
observer = linearise_observer("zhao-2012", "adaptive", at=30)
observer.gain                                         # how the innovation moves x̂ and θ̂
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from typing import Any

import numpy as np

from thetascope.assembly import prepare
from thetascope.engine.compiler.system import DISCRETE
from thetascope.engine.errors import SpecError
from thetascope.engine.estimation.covariance_equations import shape_of
from thetascope.engine.execution.stages import spans
from thetascope.engine.programs.linearised import Jacobians, jacobians_at
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.experiment import Rows
from thetascope.engine.simulation.simulation import observed_values, row_values
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.resolve_spec import plant_of, resolved
from thetascope.runs.specs.run_requests import experiment_of
from thetascope_schemas import Experiment, Plant, ResolvedExperiment

_HELD = ("now.", "mid.", "end.")
"""Prefixes of an input at the beginning, middle and end of a sample period."""


@dataclass(frozen=True)
class LinearSystem:
    """Linear equations of deviations from a point.

    dx/dt = A x + B u and y = C x + D u; in discrete time A x + B u is the next x.

    Args:
        name: of the plant or the observer.
        A, B, C, D: n × n, n × inputs, outputs × n, outputs × inputs.
        states, inputs, outputs: names, those of the plant; inputs that are faults begin with ``theta.``.
        period: sample period in s; None: continuous time.
        at: the point, by name of the state or input.
        rate: dx/dt at the point, in discrete time the next x less x (n,). Zero at an equilibrium.
        level: y at the point (outputs,).
    """

    name: str
    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    period: float | None
    at: Mapping[str, float]
    rate: np.ndarray
    level: np.ndarray

    @property
    def gain(self) -> np.ndarray:
        """Return the columns of B for the measured outputs: of an observer, the gain of its innovation."""
        return self.B[:, [i for i, name in enumerate(self.inputs) if name.startswith("y.")]]

    def to_control(self) -> Any:
        """Return a ``control.StateSpace`` with the names of states, inputs and outputs.

        Raises ImportError where python-control is not installed (``pip install thetascope[control]``).
        """
        import control  # pyright: ignore[reportMissingImports]

        # Points in names select signals of subsystems in python-control.
        names = [[name.replace(".", "_") for name in group] for group in (self.states, self.inputs, self.outputs)]
        return control.ss(
            *(self.A, self.B, self.C, self.D),
            0 if self.period is None else self.period,
            states=names[0],
            inputs=names[1],
            outputs=names[2],
            name=self.name,
        )


def linearise(
    plant: str | Mapping[str, object] | Plant,
    at: Mapping[str, float] | None = None,
    t: float = 0.0,
    faults: Sequence[str] | None = None,
) -> LinearSystem:
    """Return a plant as linear equations about a point: its states, its inputs and known signals, and faults.

    Args:
        plant: id of a library plant, a plant as data, or a `Plant`.
        at: values of states, inputs, signals, parameters and faults (``theta.<channel>``) that differ from those in the
            plant: initial states, defaults of the inputs, no faults.
        t: time in s, for equations that depend on it.
        faults: channels that are inputs, too; None: all.

    Raises:
        InvalidSpec: the plant is refused.
        ValueError: `at` or `faults` has a name that the plant does not have.
    """
    full = plant_of(plant) if isinstance(plant, str | Plant) else validated(Plant, dict(plant))
    try:
        program = plant_program(full.model_dump(mode="json")).program
    except SpecError as error:
        raise from_engine(error, in_plant=True) from None
    channels = full.names("channels") if faults is None else tuple(faults)
    given = {
        **{f"x.{s.name}": s.initial for s in full.states},
        **{f"u.{u.name}": u.default for u in full.inputs},
        **{f"signal.{s.name}": 0.0 for s in full.signals},
        **{f"p.{p.name}": p.value for p in full.parameters},
        **{f"theta.{c.name}": 0.0 for c in full.channels},
    }
    full_names = {name.split(".", 1)[1]: name for name in reversed(given) if not name.startswith("theta.")}
    for name, value in (at or {}).items():
        given[_known(full_names.get(name, name), given, name)] = float(value)
    entering = [n for n in program.inputs if not n.startswith("theta.")]
    entering += [_known(f"theta.{channel}", given, channel) for channel in channels]
    found = jacobians_at(program, program.states, entering, given | {"t": t})
    point = {_bare(name): given[name] for name in (*program.states, *entering)}
    period = full.time.period if full.time.kind == DISCRETE else None
    return _system(full.id, found, program.states, entering, tuple(program.outputs), period, point)


def linearise_observer(
    experiment: str | Mapping[str, object] | Experiment,
    observer: str,
    at: float | None = None,
    changes: Mapping[str, object] | None = None,
) -> LinearSystem:
    """Return an observer as linear equations about its estimates at a time of an experiment.

    The states and the outputs are x̂ and θ̂, and those through which noise reaches θ̂; the inputs are u, known signals
    and y. Gains that the observer adapts (P, Γ,
    Υ) have the values of that time; a sampled observer is the step from the sample before to
    its last one. `gain` of the answer multiplies the innovation.

    Args:
        experiment: as for `thetascope.run`.
        observer: its label.
        at: time in s; None: the end of the experiment.
        changes: path → new value, as for `thetascope.run`.

    Raises:
        Unknown, InvalidSpec: as `thetascope.run`.
        ValueError: there is no such observer at that time, or its estimates are not finite.
    """
    engine, rows, place = _observing(resolved(experiment_of(experiment, changes)), observer, at)
    estimator = engine.estimators[place]
    program, shape = estimator.program, shape_of(estimator.program)
    values = _seen(engine, rows, place)
    estimates = shape.estimates
    if not np.isfinite(np.array([values[name] for name in estimates], dtype=float)).all():
        raise ValueError(f"the estimates of {observer} are not finite at {rows.index[-1] * engine.step:g} s")
    entering = [n for n in program.inputs if _unheld(n).startswith(("u.", "signal.", "y."))]
    bare = tuple(dict.fromkeys(_unheld(name) for name in entering))
    found = jacobians_at(program, estimates, entering, values)
    merge = np.array([[float(_unheld(name) == one) for one in bare] for name in entering]).reshape(-1, len(bare))
    n = len(estimates)
    level = np.array([values[name] for name in estimates])
    own = Jacobians(found.A, found.B @ merge, np.eye(n), np.zeros((n, len(bare))), found.update, level)
    names = [_estimate(name) for name in estimates]
    point = dict(zip(names, level.tolist(), strict=True))
    period = None if estimator.every is None else estimator.every * engine.step
    return _system(observer, own, estimates, bare, names, period, point, names)


def _estimate(name: str) -> str:
    """Return the name of an estimate for users; a state on the way to θ̂ keeps its own."""
    bare = _bare(name.replace("thetah.", "theta."))
    return bare if name.startswith("via.") else f"{bare}_hat"


def _observing(spec: ResolvedExperiment, observer: str, at: float | None) -> tuple[Engine, Rows, int]:
    """Return the experiment, rows up to a time, and the place of an observer in them."""
    try:
        stages = prepare(spec).stages
    except SpecError as error:
        raise from_engine(error, in_plant=True) from None
    first = stages[0].experiment
    k = first.steps if at is None else round(at / first.step)
    if not 0 <= k <= first.steps:
        raise ValueError(f"{at} s is outside the experiment, which ends at {first.steps * first.step:g} s")
    half = gcd(*(e.every // 2 for e in first.estimators if e.label == observer and e.every is not None))
    last = deque(spans(stages, k + 1, gcd(first.every, k, half) or first.every), maxlen=2)
    engine = last[-1][1]
    labels = [e.label for e in engine.estimators]
    if observer not in labels:
        raise ValueError(f"there is no observer {observer!r} at {k * first.step:g} s, only {', '.join(labels)}")
    return engine, Rows.joined([rows for _, one, rows in last if one is engine]), labels.index(observer)


def _seen(engine: Engine, rows: Rows, place: int) -> dict[str, np.ndarray | float]:
    """Return the values in the equations of an observer at the last row.

    Those of a sampled observer lead from one sample to the next: the last one is that of the row, or the one before.
    """
    estimator, index = engine.estimators[place], rows.index
    every = estimator.every or 0
    sample = index[-1] - index[-1] % every if every else index[-1]
    wanted = np.searchsorted(index, [sample - every, sample - every + every // 2, sample])
    if sample - every < index[0]:  # no sample before
        wanted = np.repeat(len(index) - 1, 3)
    chosen = rows.where(wanted)
    states = dict(zip(estimator.program.states, chosen.observers[place].T, strict=True))
    seen = row_values(engine, chosen.index, chosen.plant, chosen.loop)
    values = observed_values(engine, estimator.parameters, seen, chosen.y) | states

    def when(name: str) -> int:
        return 1 if name.startswith("mid.") else 2 if name.startswith(_HELD) else 0

    return {name: value if np.ndim(value) == 0 else value[when(name)] for name, value in values.items()}


def to_control(
    plant: str | Mapping[str, object] | Plant | LinearSystem, at: Mapping[str, float] | None = None, **options: Any
) -> Any:
    """Return a plant, or a system of `linearise` or `linearise_observer`, as a ``control.StateSpace``.

    Arguments as for `linearise`. Raises ImportError where python-control is not installed.
    """
    return (plant if isinstance(plant, LinearSystem) else linearise(plant, at, **options)).to_control()


def _system(
    name: str,
    found: Jacobians,
    states: Sequence[str],
    inputs: Sequence[str],
    outputs: Sequence[str],
    period: float | None,
    point: Mapping[str, float],
    names: Sequence[str] | None = None,
) -> LinearSystem:
    """Return the system with the names of the plant; those of faults and of outputs as inputs keep their prefix."""
    labels = tuple(names or map(_bare, states))
    rate = found.update if period is None else found.update - np.array([point[label] for label in labels])
    entering, leaving = (tuple(map(_bare, inputs)), tuple(n.removeprefix("y.") for n in outputs))
    return LinearSystem(
        name, found.A, found.B, found.C, found.D, labels, entering, leaving, period, point, rate, found.outputs
    )


def _bare(name: str) -> str:
    """Return a name without the prefix of its group, but for faults and measured outputs."""
    return name if name.startswith(("theta.", "y.")) else name.split(".", 1)[1]


def _unheld(name: str) -> str:
    """Return the name of an input without its instant in the sample period."""
    return name.split(".", 1)[1] if name.startswith(_HELD) else name


def _known(name: str, given: Mapping[str, float], shown: str) -> str:
    if name not in given:
        raise ValueError(f"the plant has no {shown!r}; it has {', '.join(n.split('.', 1)[1] for n in given)}")
    return name
