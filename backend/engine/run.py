"""Run an experiment from t = 0 to its horizon and gather the columns, the divergences and the checks."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from backend.engine.errors import Cancelled, SpecError
from backend.engine.observers.base import Observed
from backend.engine.probe import probe
from backend.engine.result import Diverged, ObserverReport, Result
from backend.engine.simulation import Estimator, Experiment, Rows, Simulation, row_values
from backend.engine.stability import MOST_SUBSTEPS, fastest, sample_rows, substeps_needed
from backend.engine.system import CONTINUOUS

_FINER = 8  # how much finer a step must diverge too before a divergence is believed
EXPLODED = 1e12  # a state beyond this is taken as diverged: nothing physical is that large in the user's units


@dataclass(frozen=True)
class Record:
    """All recorded rows of a run, NaN after a divergence."""

    index: np.ndarray
    plant: np.ndarray  # rows × states
    y: np.ndarray  # rows × outputs
    observers: list[np.ndarray]


def run(
    experiment: Experiment,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Result:
    """Simulate. Raises Cancelled, or SpecError if no allowed substep makes an observer's equations stable."""
    seconds: dict[str, float] = {}
    clock = time.perf_counter()
    record, substeps = _stable_record(experiment, progress, cancelled)
    seconds["simulate"] = time.perf_counter() - clock
    clock = time.perf_counter()
    result = _gather(experiment, record, substeps, seconds)
    seconds["gather"] = time.perf_counter() - clock
    return result


def _stable_record(experiment: Experiment, progress, cancelled) -> tuple[Record, int]:
    """Simulate; where a step turns out beyond RK4's stability bound, start again with the substeps that do.

    A divergence may be the step's doing in a transient too short to be seen at the recorded rows, so it is believed
    only if a finer step diverges too.
    """
    substeps = 1
    parts, needed = _spans(experiment, substeps, progress, cancelled)
    while needed > substeps:
        substeps = _allowed(experiment, needed)
        parts, needed = _spans(experiment, substeps, progress, cancelled)
    record = _joined_rows(parts)
    escaped = _escapes(experiment, record)
    if escaped:
        finer = _joined_rows(_spans(experiment, substeps * _FINER, None, cancelled)[0])
        if _escapes(experiment, finer) < escaped:
            return finer, substeps * _FINER
    return record, substeps


def _spans(experiment: Experiment, substeps: int, progress, cancelled) -> tuple[list[Rows], int]:
    """Rows up to the horizon, or up to where more substeps turn out to be needed (and how many)."""
    parts: list[Rows] = []
    total = experiment.steps + 1  # one more: the rows of a span are those at the beginnings of its steps
    for state, rows in Simulation(experiment, substeps).spans(total):
        if cancelled is not None and cancelled():
            raise Cancelled("the run was cancelled")
        parts.append(rows)
        needed = _needed(experiment, rows)
        if needed > substeps:
            return parts, needed
        if progress is not None:
            progress(min(1.0, state.k / total))
    return parts, substeps


def _escapes(experiment: Experiment, record: Record) -> int:
    """How many observers leave the finite numbers before the plant does."""
    if experiment.plant.time != CONTINUOUS:
        return 0
    ended = _finite(record.plant)
    return sum(
        _finite(states) < ended
        for estimator, states in zip(experiment.estimators, record.observers, strict=True)
        if estimator.every is None
    )


def _needed(experiment: Experiment, rows: Rows) -> int:
    if experiment.plant.time != CONTINUOUS or not len(rows.index):
        return 1
    values = row_values(experiment, rows.index, rows.plant)
    opening = rows.index[0] == 0
    picked = sample_rows(_finite(rows.plant), len(experiment.plant.states), opening)
    rates = [fastest(experiment.plant, values, picked)]
    for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
        if estimator.every is None:
            seen = observed_values(experiment, estimator, values, rows.y, states)
            picked = sample_rows(_finite(states), len(estimator.program.states), opening)
            rates.append(fastest(estimator.program, seen, picked))
    return max(substeps_needed(experiment.step, rate) for rate in rates)


def _finite(states: np.ndarray) -> int:
    """How many rows at the beginning are finite and not exploded."""
    if not states.shape[1]:
        return len(states)
    bad = ~(np.abs(states) < EXPLODED).all(axis=1)
    return int(np.argmax(bad)) if bad.any() else len(states)


def _allowed(experiment: Experiment, needed: int) -> int:
    if needed > MOST_SUBSTEPS:
        step = experiment.step / needed
        raise SpecError("step", experiment.step, f"these gains need steps of {step:.2g} s to stay numerically stable, "
                        f"{needed} times shorter than asked", f"set step to {step:.2g} or lower the gains")  # fmt: skip
    return needed


def _joined_rows(parts: list[Rows]) -> Record:
    return Record(
        np.concatenate([p.index for p in parts]),
        np.concatenate([p.plant for p in parts]),
        np.concatenate([p.y for p in parts]),
        [np.concatenate(o) for o in zip(*(p.observers for p in parts), strict=True)] if parts[0].observers else [],
    )


def observed_values(
    experiment: Experiment, estimator: Estimator, values: dict, y: np.ndarray, states: np.ndarray
) -> dict:
    """What an observer may know, along the rows: its states and parameters, t, u.*, signal.*, y.*; no x, no θ."""
    seen = {n: v for n, v in values.items() if n == "t" or n.startswith(("u.", "signal."))}
    seen |= {name: y[:, i] for i, name in enumerate(experiment.plant.outputs)}
    seen |= {f"{when}{n}": v for when in ("mid.", "end.", "now.") for n, v in list(seen.items()) if n != "t"}
    seen |= dict(estimator.parameters)
    return seen | {s: states[:, j] for j, s in enumerate(estimator.program.states)}


# ---- from rows to columns ------------------------------------------------------------------------------------------


def _gather(experiment: Experiment, record: Record, substeps: int, seconds: dict[str, float]) -> Result:
    ended = _finite(record.plant)
    plant_end = None
    if ended < len(record.plant):
        plant_end = Diverged(float(record.index[ended] * experiment.step), "the plant's own state escapes to infinity")
        for array in (record.plant, record.y, *record.observers):
            array[ended:] = np.nan
    values = row_values(experiment, record.index, record.plant)
    columns: dict[str, np.ndarray] = {"t": values["t"]}
    names = list(experiment.signals)
    for prefix in ("u.", "signal."):
        columns |= {n: values[n] for n in names if n.startswith(prefix)}
    columns |= {s: record.plant[:, j] for j, s in enumerate(experiment.plant.states)}
    columns |= {n: values[n] for n in names if n.startswith("theta.")}
    columns |= {n: record.y[:, i] for i, n in enumerate(experiment.plant.outputs)}
    reports = []
    for estimator, states in zip(experiment.estimators, record.observers, strict=True):
        more, report = _observer(experiment, estimator, values, record.y, states, ended)
        columns |= {f"{estimator.label}.{n}": v for n, v in more.items()}
        reports.append(report)
    data = np.empty((len(columns), len(record.index)))
    for row, column in zip(data, columns.values(), strict=True):
        row[:] = column
    notes = experiment.notes
    if substeps > 1:
        notes += (
            f"Each step was taken in {substeps} substeps: an observer's eigenvalues are beyond RK4's stability bound.",
        )
    return Result(tuple(columns), data, tuple(reports), plant_end, experiment.step, substeps, notes, seconds)


def _observer(
    experiment: Experiment, estimator: Estimator, values: dict, y: np.ndarray, states: np.ndarray, ended: int
):
    diverged = None
    finite = _finite(states)
    if finite < min(ended, len(states)):
        diverged = Diverged(float(values["t"][finite]), _cause(estimator, states, finite))
        states[finite:] = np.nan
    seen = observed_values(experiment, estimator, values, y, states)
    program = estimator.program
    outputs = [n for n in program.outputs if not n.startswith("init.")]
    seen |= dict(zip(outputs, probe(program, outputs, seen), strict=True))
    run = Observed(None, program, estimator.channels, estimator.facts, seen,
                   experiment.every * experiment.step, estimator.context)  # fmt: skip
    columns = {n: seen[n] for prefix in ("x.", "theta.", "y.") for n in outputs if n.startswith(prefix)}
    more = estimator.kind.diagnostics(run)
    seen |= more
    checks = tuple(estimator.kind.checks(run))
    report = ObserverReport(estimator.label, estimator.kind.id, estimator.kind.title, checks, diverged, estimator.facts)
    return columns | more, report


def _cause(estimator: Estimator, states: np.ndarray, first_bad: int) -> str:
    """The likely cause: which of the observer's states ran away, and what that usually means."""
    names = estimator.program.states
    window = states[max(0, first_bad - 20) : first_bad + 1]
    with np.errstate(all="ignore"):
        growth = np.nan_to_num(np.abs(window), nan=np.inf, posinf=np.inf).max(axis=0)
    worst = names[int(np.argmax(growth))].split(".")[0] if len(window) else names[0]
    return {
        "Gamma": "Γ grew without bound: excitation was lost while λ kept forgetting; lower λ or excite the plant",
        "S": "the parameter covariance grew without bound: excitation was lost; lower λ or excite the plant",
        "P": "the Riccati equation lost definiteness; raise r or lower q, or take a shorter step",
        "Upsilon": "Υ grew without bound: A − KC is not stable along this run",
        "xh": "x̂ left every bound: the initial estimate is outside the region of convergence, or the gain is too low",
        "thetah": "θ̂ left every bound: lower λ or the initial Γ",
    }.get(worst, f"the state {names[int(np.argmax(growth))]} left every bound")
