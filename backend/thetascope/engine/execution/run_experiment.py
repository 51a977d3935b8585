"""Run an experiment from t = 0 to its horizon and gather the columns, the divergences and the checks."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from thetascope.engine.errors import Cancelled
from thetascope.engine.execution.divergence import EXPLODED
from thetascope.engine.execution.recorded_rows import every_nth, with_rows
from thetascope.engine.execution.result_columns import gather
from thetascope.engine.execution.stages import Stage, spans
from thetascope.engine.model.result import Result
from thetascope.engine.programs.kernel_cost import costs, operations
from thetascope.engine.simulation.experiment import Experiment, Rows
from thetascope.engine.simulation.simulation import Simulation

_MEASURED = 4000  # steps
_LARGE = 3000  # operations

__all__ = ["EXPLODED", "run"]

Parts = list[tuple[Experiment, Rows]]


@dataclass(frozen=True)
class _Callbacks:
    """Callbacks of a run: ``progress`` is called with the share done; ``cancelled`` returns True to stop it."""

    progress: Callable[[float], None] | None
    cancelled: Callable[[], bool] | None


def run(
    stages: Experiment | Sequence[Stage],
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
    inspect: Callable[[Parts, Result], Result] | None = None,
    measure_cost: bool = True,
) -> Result:
    """Simulate. Raises Cancelled.

    ``inspect`` receives the rows at which the run is examined and may add to the result, whose columns are then reduced
    to the rows of the experiment's ``record``. So no check depends on the spacing of these. ``measure_cost``: whether
    the observer that shares the plant's kernel runs once more alone, to measure its cost.
    """
    stages = [Stage(0, stages)] if isinstance(stages, Experiment) else list(stages)
    seconds: dict[str, float] = {}
    clock = time.perf_counter()
    first = stages[0].experiment
    record = first.record or first.every
    all_parts = _spans(stages, _Callbacks(progress, cancelled), math.gcd(first.every, record))
    parts = every_nth(all_parts, first.every)
    seconds["simulate"] = time.perf_counter() - clock
    clock = time.perf_counter()
    result = gather(parts, seconds)
    if measure_cost:
        result = replace(result, costs=result.costs | alone(stages[0].experiment, parts))
    seconds["gather"] = time.perf_counter() - clock
    if inspect is not None:
        clock = time.perf_counter()
        result = inspect(parts, result)
        seconds["diagnose"] = time.perf_counter() - clock
    return with_rows(result, all_parts, first.every, record)


def spans_of(experiment: Experiment) -> Parts:
    """Return the rows of an experiment."""
    return _spans([Stage(0, experiment)], _Callbacks(None, None))


def alone(experiment: Experiment, parts: Sequence[tuple[Experiment, Rows]] = ()) -> dict[str, float]:
    """Return the cost of the observer that shares the plant's kernel, measured in a separate kernel.

    Observers are compared on equal terms this way. It takes a few thousand steps and the compilation of that kernel;
    very large observers and runs with implicit steps are not measured. ``parts``: the run, whose substeps it takes.
    """
    taken = [(len(rows.index), rows.accuracy) for _, rows in parts if rows.accuracy is not None]
    if any(accuracy.implicit for _, accuracy in taken):
        return {}
    rows = sum(count for count, _ in taken)
    mean = sum(count * accuracy.substeps for count, accuracy in taken) / rows if rows else 1
    simulation = Simulation(experiment, experiment.substeps or round(mean))
    if not simulation.joined or len(experiment.estimators) < 2:
        return {}
    first = experiment.estimators[simulation.lockstep[0]]
    if operations(first.program) > _LARGE:
        return {}
    simulation.joined = False
    state, _ = simulation.advance(simulation.initial(), min(100, experiment.steps))  # warms up the memory
    _, rows = simulation.advance(state, min(_MEASURED, experiment.steps))
    return {first.label: costs([rows.spent])[first.label]}


def _spans(stages: list[Stage], callbacks: _Callbacks, spacing: int | None = None) -> Parts:
    """Return the rows up to the horizon; ``spacing``: base steps between them."""
    parts: Parts = []
    total = stages[0].experiment.steps + 1  # one more: the rows of a span lie at the beginnings of its steps
    for state, experiment, rows in spans(stages, total, spacing):
        if callbacks.cancelled is not None and callbacks.cancelled():
            raise Cancelled("the run was cancelled")
        parts.append((experiment, rows))
        if callbacks.progress is not None:
            callbacks.progress(min(1.0, state.k / total))
    return parts
