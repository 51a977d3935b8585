"""Turn recorded rows into columns: observer outputs, diagnostics, checks.

Columns are NaN after a divergence and while an observer is absent.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial, reduce

import numpy as np

from thetascope.engine.estimation.covariance import Spreads, latest, sigma_columns
from thetascope.engine.execution.divergence import end_of_plant, finite_observer_rows
from thetascope.engine.execution.stages import Life, final_estimator, lives, parameters_over
from thetascope.engine.model.result import (
    CANNOT_TELL,
    OBSERVER_TOLERANCE,
    TOLERANCE,
    Accuracy,
    Check,
    Diverged,
    ObserverReport,
    Result,
)
from thetascope.engine.observers.support.declaration import Observed, Truth
from thetascope.engine.programs.evaluate_rows import probe
from thetascope.engine.programs.kernel_cost import costs
from thetascope.engine.simulation.experiment import PROCESS_NOISE, Estimator, Experiment, Rows
from thetascope.engine.simulation.loop import LoopRows
from thetascope.engine.simulation.simulation import at_rows, loop_values, observed_values, row_numbers
from thetascope.messages import Message


def gather(parts: Sequence[tuple[Experiment, Rows]], seconds: dict[str, float]) -> Result:
    """Return the result of a run from its spans, in order."""
    first = parts[0][0]
    index = np.concatenate([rows.index for _, rows in parts])
    plant = np.concatenate([rows.plant for _, rows in parts])
    y = np.concatenate([rows.y for _, rows in parts])
    observer_lives = lives(parts)
    ended, cause = end_of_plant(first, index, plant, y)
    diverged = None
    if cause is not None:
        diverged = Diverged(float(index[ended] * first.step), cause)
        plant[ended:], y[ended:] = np.nan, np.nan
    values = plant_values(parts, plant)
    columns = plant_columns(first, values, plant, y)
    reports: dict[str, ObserverReport] = {}
    sure = confidence(parts, values)
    for life in observer_lives:
        more, report = observer_columns(life, values, y, ended)
        where = np.concatenate(life.positions)
        for name, column in more.items():
            target = columns.setdefault(f"{life.label}.{name}", np.full(len(index), np.nan))
            target[where] = column
        for name in [n for n in sure if n.startswith(f"{life.label}.sigma.")]:
            columns[name] = np.where(np.isfinite(columns[name.replace(".sigma.", ".theta.", 1)]), sure[name], np.nan)
        reports[life.label] = report
    data = np.empty((len(columns), len(index)))
    for row, column in zip(data, columns.values(), strict=True):
        row[:] = column
    known = [rows.accuracy for _, rows in parts if rows.accuracy is not None]
    accuracy = reduce(Accuracy.with_part, known) if known else None
    substeps = max([accuracy.substeps if accuracy else 1, *(e.substeps or 1 for e, _ in parts)])
    spent = costs(rows.spent for _, rows in parts)
    observers = tuple(reports.values())
    notes = (*first.notes, *_notes(substeps, accuracy))
    return Result(
        tuple(columns), data, observers, diverged, first.step, substeps, notes, seconds, spent, accuracy=accuracy
    )


def _notes(substeps: int, accuracy: Accuracy | None) -> Iterator[Message]:
    """Yield the notes on the steps of a run: substeps, implicit steps, an accuracy that misses the tolerance."""
    if substeps > 1:
        yield Message("run.substeps", n=substeps)
    if accuracy is None:
        return
    if accuracy.implicit:
        yield Message("run.implicit", n=accuracy.implicit)
    if accuracy.plant > TOLERANCE:
        yield Message("run.inaccurate.plant", error=accuracy.plant, tolerance=TOLERANCE)
    if accuracy.observers > OBSERVER_TOLERANCE:
        yield Message("run.inaccurate.observers", error=accuracy.observers, tolerance=OBSERVER_TOLERANCE)


def confidence(parts: Sequence[tuple[Experiment, Rows]], values: dict) -> dict[str, np.ndarray]:
    """Return the columns ``L.sigma.<channel>`` over all rows; NaN where the observer does not run."""
    columns: dict[str, np.ndarray] = {}
    spreads: Spreads = {}
    begin = 0
    for experiment, rows in parts:
        places = slice(begin, begin + len(rows.index))
        begin = places.stop
        mine = {n: v[places] if np.ndim(v) else v for n, v in values.items()}
        some, tables = sigma_columns(experiment, rows, mine, spreads)
        spreads = latest(tables)
        for name, column in some.items():
            columns.setdefault(name, np.full(len(values["t"]), np.nan))[places] = column
    return columns


def plant_values(parts: Sequence[tuple[Experiment, Rows]], plant: np.ndarray) -> dict[str, np.ndarray | float]:
    """Return t, signals, parameters and plant states along all rows."""
    first = parts[0][0]
    counts = [len(rows.index) for _, rows in parts]
    ends = np.cumsum(counts)
    t = np.concatenate([rows.index for _, rows in parts]) * first.step
    values: dict[str, np.ndarray | float] = {}
    for name, signal in first.signals.items():
        if name.startswith(PROCESS_NOISE):  # no column
            continue
        theirs = [e.signals[name] for e, _ in parts]
        if all(s is signal for s in theirs):
            values[name] = at_rows(signal, t, first.step)
        else:
            begins = [
                k for k, s in enumerate(theirs) if not k or s is not theirs[k - 1]
            ]  # parts from which a different value holds
            pieces = np.split(t, [ends[k - 1] for k in begins[1:]])
            values[name] = np.concatenate(
                [at_rows(theirs[k], p, first.step) for k, p in zip(begins, pieces, strict=True)]
            )
    if first.loop is not None:
        values |= loop_values(first.loop, LoopRows.concatenated([r.loop for _, r in parts if r.loop is not None]))
    each = [row_numbers(e) for e, _ in parts]
    values |= {n: _over([v[n] for v in each], counts) for n in each[0]} | {"t": t}
    return values | {s: plant[:, j] for j, s in enumerate(first.plant.states)}


def _over(numbers: list[float], counts: list[int]) -> np.ndarray | float:
    """Return one quantity over all spans: a number if it never changes, else an array."""
    return numbers[0] if len(set(numbers)) == 1 else np.repeat(numbers, counts)


def plant_columns(e: Experiment, values: dict, plant: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
    """Return the plant's columns in their order: t, u, signal, r, x, c, theta, y; of a record t, u, signal and y."""
    columns = {"t": values["t"]} | {n: values[n] for n in e.given}
    if e.recorded:
        present = [values.get(f"present.{n}", 1.0) for n in e.plant.outputs]
        readings = zip(e.plant.outputs, y.T, present, strict=True)
        return columns | {n: np.where(np.asarray(there) > 0, column, np.nan) for n, column, there in readings}
    columns |= {s: plant[:, j] for j, s in enumerate(e.plant.states)}
    columns |= {n: values[n] for n in (e.loop.controller_states if e.loop is not None else ())}
    columns |= {n: values[n] for n in e.signals if n.startswith("theta.")}
    return columns | {n: y[:, i] for i, n in enumerate(e.plant.outputs)}


def observer_columns(
    life: Life, values: dict, y: np.ndarray, ended: int, check: bool = True, first_row: int = 0, wanted: int = 0
) -> tuple[dict[str, np.ndarray], ObserverReport]:
    """Return x̂, θ̂, ŷ and diagnostics of one observer over the rows on which it ran, and its report.

    ``first_row``: index of the first given row, counted from t = 0; ``wanted``: number of rows that only fill windows.
    """
    estimator, where = final_estimator(life), life.where
    states, diverged = lived(life, values, ended)
    columns, seen = estimates(life, values, y, states)
    e, program = life.experiments[-1], estimator.program
    run = Observed(
        None,
        program,
        estimator.channels,
        estimator.facts,
        seen,
        e.every * e.step,
        estimator.context,
        first_row + where.start,
        -(-estimator.since // e.every),
        max(0, wanted - where.start),
        None if e.recorded else truth_of(estimator, values, where),
        partial(probe, program),
    )
    more = estimator.kind.diagnostics(run)
    seen |= more
    checks = _checks(estimator, run) if check else ()
    report = ObserverReport(estimator.label, estimator.kind.id, estimator.kind.title, checks, diverged, estimator.facts)
    return columns | more, report


def lived(life: Life, values: dict, ended: int) -> tuple[np.ndarray, Diverged | None]:
    """Return the states of an observer (rows, states), NaN once it or the plant has diverged, and its divergence.

    ``ended``: number of leading rows in which the plant has finite values.
    """
    estimator, where = final_estimator(life), life.where
    states = np.concatenate(life.states)
    inside = max(0, ended - where.start)
    diverged, finite = None, finite_observer_rows(estimator, states)
    if finite < min(inside, len(states)):
        diverged = Diverged(float(values["t"][where.start + finite]), _cause(estimator.program.states, states, finite))
        states[finite:] = np.nan
    elif inside < len(states):
        states[inside:] = np.nan
    return states, diverged


def truth_of(estimator: Estimator, values: Mapping[str, np.ndarray | float], where: slice) -> Truth | None:
    """Return the true states and faults along the rows of an observer; None for a truth that lacks its states."""
    if not truth_names(estimator) <= set(values):
        return None
    count = len(np.asarray(values["t"])[where])

    def table(names: Sequence[str]) -> np.ndarray:
        columns = [np.broadcast_to(v[where] if (v := np.asarray(values[name])).ndim else v, count) for name in names]
        return np.stack(columns, axis=1) if columns else np.empty((count, 0))

    return Truth(table(_true_states(estimator)), table([f"theta.{channel}" for channel in estimator.channels]))


def truth_names(estimator: Estimator) -> set[str]:
    """Return the columns that hold the true states and faults which an observer estimates."""
    return {*_true_states(estimator), *(f"theta.{channel}" for channel in estimator.channels)}


def _true_states(estimator: Estimator) -> list[str]:
    return [f"x.{state['name']}" for state in estimator.context.model["states"]]


def estimates(life: Life, values: dict, y: np.ndarray, states: np.ndarray) -> tuple[dict[str, np.ndarray], dict]:
    """Return x̂, θ̂ and ŷ over the rows of an observer from its states (rows, states), and all values along them."""
    program, where = final_estimator(life).program, life.where
    mine = {n: v[where] if np.ndim(v) else v for n, v in values.items()}
    seen = observed_values(life.experiments[-1], parameters_over(life), mine, y[where])
    seen |= {s: states[:, j] for j, s in enumerate(program.states)}
    outputs = [n for n in program.outputs if not n.startswith("init.")]
    seen |= dict(zip(outputs, probe(program, outputs, seen), strict=True))
    return {n: seen[n] for prefix in ("x.", "theta.", "y.") for n in outputs if n.startswith(prefix)}, seen


def _checks(estimator, run: Observed) -> tuple[Check, ...]:
    """Return the checks of the theorem's conditions; a matrix whose eigenvalues cannot be computed stops no run."""
    try:
        return tuple(estimator.kind.checks(run))
    except np.linalg.LinAlgError:
        return (Check(Message("check.conditions"), CANNOT_TELL, Message("check.conditions.out-of-range")),)


def _cause(names: tuple[str, ...], states: np.ndarray, first_bad: int) -> Message:
    """Return the likely cause of a divergence, by the kind of the state that grew most before row ``first_bad``."""
    window = states[max(0, first_bad - 20) : first_bad + 1]
    with np.errstate(all="ignore"):
        if not np.isfinite(window[-1]).all() and (np.abs(window[:-1]) <= _CALM * np.abs(window[0])).all():
            return Message("diverged.too-fast")
        growth = np.nan_to_num(np.abs(window), nan=np.inf, posinf=np.inf).max(axis=0)
    worst = names[int(np.argmax(growth))]
    code = _CAUSES.get(worst.split(".")[0])
    return Message(code) if code else Message("diverged.state", state=worst)


_CALM = 10.0  # growth over some rows of a state that does not diverge
_CAUSES = {
    "Gamma": "diverged.gamma",
    "S": "diverged.parameter-covariance",
    "P": "diverged.riccati",
    "Upsilon": "diverged.upsilon",
    "xh": "diverged.x-hat",
    "thetah": "diverged.theta-hat",
}
