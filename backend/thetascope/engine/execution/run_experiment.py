"""Run an experiment from t = 0 to its horizon and gather the columns, the divergences and the checks."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from thetascope.engine.compiler.system import CONTINUOUS
from thetascope.engine.errors import Cancelled, SpecError
from thetascope.engine.execution.divergence import EXPLODED, finite_observer_rows, finite_plant_rows
from thetascope.engine.execution.result_columns import gather
from thetascope.engine.execution.stages import Stage, spans
from thetascope.engine.model.result import Result
from thetascope.engine.simulation.experiment import Experiment, Rows
from thetascope.engine.simulation.kernel_cost import costs, operations
from thetascope.engine.simulation.simulation import Simulation, observed_values, row_values
from thetascope.engine.simulation.step_stability import MOST_SUBSTEPS, fastest, sample_rows, substeps_needed
from thetascope.messages import Message

_FINER = 8  # a divergence is accepted only if a step this many times finer diverges, too
_MEASURED = 4000  # steps
_LARGE = 3000  # operations

__all__ = ["EXPLODED", "needed_substeps", "run"]

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
) -> Result:
    """Simulate. Raises Cancelled, or SpecError if no allowed substep makes an observer's equations stable.

    ``inspect`` receives the recorded rows and may add to the result.
    """
    stages = [Stage(0, stages)] if isinstance(stages, Experiment) else list(stages)
    seconds: dict[str, float] = {}
    clock = time.perf_counter()
    parts, substeps = _stable(stages, _Callbacks(progress, cancelled))
    seconds["simulate"] = time.perf_counter() - clock
    clock = time.perf_counter()
    result = gather(parts, substeps, seconds)
    result = replace(result, costs=result.costs | alone(stages[0].experiment, substeps))
    seconds["gather"] = time.perf_counter() - clock
    if inspect is not None:
        clock = time.perf_counter()
        result = inspect(parts, result)
        seconds["diagnose"] = time.perf_counter() - clock
    return result


def spans_of(experiment: Experiment, substeps: int) -> Parts:
    """Return the rows of an experiment, computed with a number of substeps that is known to suffice."""
    return _spans([Stage(0, experiment)], substeps, _Callbacks(None, None), check_step=False)[0]


def alone(experiment: Experiment, substeps: int) -> dict[str, float]:
    """Return the cost of the observer that shares the plant's kernel, measured in a separate kernel.

    Observers are compared on equal terms this way. It takes a few thousand steps and the compilation of that kernel;
    very large observers are not measured.
    """
    simulation = Simulation(experiment, substeps)
    if not simulation.joined or len(experiment.estimators) < 2:
        return {}
    first = experiment.estimators[simulation.lockstep[0]]
    if operations(first.program) > _LARGE:
        return {}
    simulation.joined = False
    state, _ = simulation.advance(simulation.initial(), min(100, experiment.steps))  # warms up the memory
    _, rows = simulation.advance(state, min(_MEASURED, experiment.steps))
    return {first.label: costs([rows.spent])[first.label]}


def _stable(stages: list[Stage], callbacks: _Callbacks) -> tuple[Parts, int]:
    """Simulate; where a step exceeds RK4's stability bound, start again with sufficient substeps.

    A step that is too large can also cause a divergence in a transient too short to be seen at the recorded rows. A
    divergence is therefore accepted only if a finer step diverges, too. Substeps that the spec gives are used
    unchanged.
    """
    given = stages[0].experiment.substeps
    if given is not None:
        return _spans(stages, given, callbacks, check_step=False)[0], max(s.experiment.substeps or 1 for s in stages)
    substeps = 1
    parts, needed = _spans(stages, substeps, callbacks)
    while needed > substeps:
        substeps = allowed(stages[0].experiment, needed)
        parts, needed = _spans(stages, substeps, callbacks)
    escaped = _escapes(parts)
    if escaped:
        finer = _spans(stages, substeps * _FINER, _Callbacks(None, callbacks.cancelled))[0]
        if _escapes(finer) < escaped:
            return finer, substeps * _FINER
    return parts, substeps


def _spans(stages: list[Stage], substeps: int, callbacks: _Callbacks, check_step: bool = True) -> tuple[Parts, int]:
    """Return the rows up to the horizon, or up to where more substeps are needed, and the number of substeps needed."""
    parts: Parts = []
    total = stages[0].experiment.steps + 1  # one more: the rows of a span lie at the beginnings of its steps
    for state, experiment, rows in spans(stages, total, substeps):
        if callbacks.cancelled is not None and callbacks.cancelled():
            raise Cancelled("the run was cancelled")
        parts.append((experiment, rows))
        needed = needed_substeps(experiment, rows) if check_step else 1
        if needed > substeps:
            return parts, needed
        if callbacks.progress is not None:
            callbacks.progress(min(1.0, state.k / total))
    return parts, substeps


def needed_substeps(experiment: Experiment, rows: Rows) -> int:
    """Return the number of substeps per base step that the recorded rows require."""
    if experiment.plant.time != CONTINUOUS or not len(rows.index):
        return 1
    opening = rows.index[0] == 0
    values = row_values(experiment, rows.index, rows.plant, rows.loop)
    ended = finite_plant_rows(experiment, rows.plant)
    picked = sample_rows(ended, len(experiment.plant.states), opening)
    rates = [fastest(experiment.plant, values, picked)]
    if experiment.loop is not None and rows.loop is not None:
        loop = experiment.loop
        rates.append(fastest(loop.program, loop.values(rows.loop, values), picked))
    for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
        if estimator.every is None:
            observed = observed_values(experiment, estimator.parameters, values, rows.y)
            observed |= {s: states[:, j] for j, s in enumerate(estimator.program.states)}
            count = min(ended, finite_observer_rows(estimator, states))
            picked = sample_rows(count, len(estimator.program.states), opening)
            rates.append(fastest(estimator.program, observed, picked))
    return max(substeps_needed(experiment.step, rate) for rate in rates)


def allowed(experiment: Experiment, needed: int) -> int:
    """Return ``needed`` if that many substeps are allowed. Raises SpecError with a step that is small enough."""
    if needed > MOST_SUBSTEPS:
        step = experiment.step / needed
        raise SpecError("step", experiment.step, Message("run.step.unstable", step=step, times=needed))
    return needed


def _escapes(parts: Parts) -> int:
    """Return the number of observers that leave the finite numbers before the plant does."""
    escaped, ended = set(), False
    for experiment, rows in parts:
        if experiment.plant.time != CONTINUOUS or ended:
            break
        end = finite_plant_rows(experiment, rows.plant)
        ended = end < len(rows.plant)
        for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
            if estimator.every is None and finite_observer_rows(estimator, states) < end:
                escaped.add((estimator.label, estimator.since))
    return len(escaped)
