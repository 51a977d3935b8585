"""Turn a resolved experiment into programs and stages that are ready to run."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import gcd

from thetascope.assembly.build.diagnosis_settings import inspector
from thetascope.assembly.build.experiment_builder import engine, reseeded
from thetascope.assembly.build.incremental import adapted
from thetascope.assembly.build.timed_commands import changed
from thetascope.engine.errors import SpecError
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.execution.stages import Stage
from thetascope.engine.model.result import Result
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.commands import AddObserver


@dataclass(frozen=True)
class Cost:
    """The cost of a run, known before it starts."""

    steps: int
    rows: int  # of the simulation: those that are examined and those that are recorded
    columns: int  # lower bound: diagnostics are not counted
    states: int  # of plant and observers
    bytes: int  # approximate size of these rows


@dataclass(frozen=True)
class Prepared:
    """An experiment whose programs are built."""

    spec: ResolvedExperiment
    stages: tuple[Stage, ...]

    @property
    def engine(self) -> Engine:
        """Return the experiment at t = 0."""
        return self.stages[0].experiment

    @property
    def cost(self) -> Cost:
        """Return steps, rows, columns and bytes of the run, computed from the programs without running them."""
        e = self.engine
        rows = e.steps // gcd(e.every, e.record or e.every) + 1
        outputs = sum(len([o for o in s.program.outputs if not o.startswith("init.")]) for s in e.estimators)
        columns = 1 + len(e.signals) + len(e.plant.states) + len(e.plant.outputs) + outputs
        states = len(e.plant.states) + sum(len(s.program.states) for s in e.estimators)
        return Cost(e.steps, rows, columns, states, 8 * rows * (columns + states))

    def run(
        self, progress: Callable[[float], None] | None = None, cancelled: Callable[[], bool] | None = None
    ) -> Result:
        """Simulate. Raises Cancelled, or SpecError where no allowed step suits the gains."""
        return run(self.stages, progress, cancelled, inspector(self.spec, cancelled))


def prepare(spec: ResolvedExperiment) -> Prepared:
    """Build the programs of an experiment.

    Raises SpecError (or ExpressionError, which points into a text) that names the field, the value and the remedy.
    """
    return Prepared(spec, tuple(_stages(spec)))


def prepare_seed(known: Prepared, spec: ResolvedExperiment) -> Prepared:
    """Return the programs of an experiment that differs by its seed only from one whose programs are built."""
    if len(known.stages) > 1:
        return prepare(spec)
    return Prepared(spec, (Stage(0, reseeded(known.engine, spec)),))


def _stages(spec: ResolvedExperiment) -> Iterator[Stage]:
    """Yield the experiment at t = 0 and after each timed command; commands at the same time form one stage."""
    current = before = spec.model_copy(update={"commands": ()})
    since: dict[str, int] = {}
    k, engine_before = 0, None

    def stage() -> Stage:
        return Stage(
            k, engine(current, since) if engine_before is None else adapted(current, since, before, engine_before)
        )

    for i, command in enumerate(spec.commands):
        at = round(command.at / spec.step)
        if at > k or i == 0 and at > 0:
            begun = stage()
            yield begun
            before, engine_before = current, begun.experiment
        k = at
        try:
            current = changed(current, command)
        except SpecError as error:
            error.field = f"commands.{i}.{error.field}"
            raise
        if isinstance(command, AddObserver):
            since[command.observer.label] = k
    yield stage()
