"""From the engine's recorded rows to the columns that are shown, with a tail of older rows for windows.

The columns come from the functions that a run uses, applied to the tail and the new rows together,
so they are the run's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, TypeGuard

import numpy as np

from thetascope.engine.estimation.covariance import Spreads, has_spread, latest, sigma_columns
from thetascope.engine.execution.divergence import end_of_plant, finite_plant_rows
from thetascope.engine.execution.result_columns import (
    observer_columns,
    plant_columns,
    plant_values,
    truth_names,
)
from thetascope.engine.execution.stages import Life, lives
from thetascope.engine.model.result import Diverged
from thetascope.engine.observers.support.declaration import Observed, Truth
from thetascope.engine.simulation.experiment import Estimator, Rows
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.loop import LoopRows
from thetascope.messages import Message
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.run import AssumptionCheck
from thetascope_schemas.service.session import Assumptions, Event

_SHORTEST_TAIL = 200  # rows
Parts = tuple[tuple[Engine, Rows], ...]


@dataclass(frozen=True)
class ColumnBatch:
    """The newest rows.

    Args:
        data: their columns, columns × rows.
        tables: S of each observer at each row, and after the last.
        values: t, signals and parameters by name, along the rows.
    """

    data: np.ndarray
    tables: Spreads
    values: dict

    def head(self, count: int) -> "ColumnBatch":
        """Return the first rows only."""
        return ColumnBatch(
            self.data[:, :count],
            {k: v[: count + 1] for k, v in self.tables.items()},
            {n: v[:count] if np.ndim(v) else v for n, v in self.values.items()},
        )


@dataclass(frozen=True)
class LiveColumns:
    """The columns of a session at a row, and the rows before it that windows need.

    Args:
        columns: their names.
        first: number of the first row in `parts`.
        parts: the engine's rows, each part with the experiment that recorded it.
        lost: when and why observers have diverged, by label.
        plant_lost: when and why the plant's state has diverged.
        spreads: S of each observer after the newest row.
    """

    columns: tuple[str, ...]
    first: int
    parts: Parts = ()
    lost: dict[str, Diverged] = field(default_factory=dict)
    plant_lost: Diverged | None = None
    spreads: Spreads = field(default_factory=dict)

    @classmethod
    def opening(cls, experiment: Engine, row: int) -> "LiveColumns":
        """Return the columns of an experiment, with no rows yet."""
        return cls(columns_of(experiment), row)

    @classmethod
    def resumable(cls, experiment: Engine, row: int, until: int, spreads: Spreads) -> "LiveColumns | None":
        """Return columns that begin at `row` and are right from `until` on; None if windows need rows before `row`."""
        if row > _tail_start(experiment, until):
            return None
        return replace(cls.opening(experiment, row), spreads=spreads)

    def carried(self, experiment: Engine, row: int) -> "LiveColumns":
        """Return the columns where another experiment continues from a row."""
        present = {e.label for e in experiment.estimators if e.since // experiment.every < row}
        lost = {label: diverged for label, diverged in self.lost.items() if label in present}
        return replace(self, columns=columns_of(experiment), lost=lost)

    @property
    def last_measured(self) -> np.ndarray | None:
        """y in the newest row, shape (outputs,); None if there is no row."""
        return self.parts[-1][1].y[-1] if self.parts and len(self.parts[-1][1].y) else None

    def extended(self, experiment: Engine, rows: Rows) -> tuple["LiveColumns", ColumnBatch]:
        """Return the columns after new rows, and the new rows' values."""
        rows = self._without_lost(experiment, rows)
        parts = _with(self.parts, experiment, rows)
        plant = np.concatenate([r.plant for _, r in parts])
        y = np.concatenate([r.y for _, r in parts])
        index = np.concatenate([r.index for _, r in parts])
        ended, cause = (0, None) if self.plant_lost else end_of_plant(experiment, index, plant, y)
        plant[ended:], y[ended:] = np.nan, np.nan
        values = plant_values(parts, plant)
        count = len(rows.index)
        columns = {n: c[-count:] for n, c in plant_columns(experiment, values, plant, y).items()}
        lost = dict(self.lost)
        for life in _present(parts, experiment.estimators):
            more, report = observer_columns(
                life, values, y, ended, check=False, first_row=self.first, wanted=len(plant) - count
            )
            columns |= {f"{life.label}.{n}": c[-count:] for n, c in more.items()}
            if report.diverged is not None and life.label not in lost:
                lost[life.label] = report.diverged
        newest = {n: v[-count:] if _is_column(v) else v for n, v in values.items()}
        sigmas, tables = sigma_columns(experiment, rows, newest, self.spreads)
        columns |= {
            n: np.where(np.isfinite(columns[n.replace(".sigma.", ".theta.", 1)]), c, np.nan) for n, c in sigmas.items()
        }
        data = np.stack([columns[n] for n in self.columns]) if count else np.empty((len(self.columns), 0))
        plant_lost = self.plant_lost
        if cause is not None:
            plant_lost = Diverged(float(np.asarray(values["t"])[ended]), cause)
        after = replace(self, parts=parts, lost=lost, plant_lost=plant_lost, spreads=latest(tables))
        return after._trimmed(experiment), ColumnBatch(data, tables, newest)

    def continued(self, experiment: Engine, rows: Rows, spreads: Spreads) -> "LiveColumns":
        """Return the columns after rows whose values are known and in which nothing diverges; spreads: S after them."""
        rows = self._without_lost(experiment, rows)
        return replace(self, parts=_with(self.parts, experiment, rows), spreads=spreads)._trimmed(experiment)

    def _without_lost(self, experiment: Engine, rows: Rows) -> Rows:
        """Return the rows with NaN for diverged observers, whatever their numbers do later."""
        states = tuple(
            np.full_like(s, np.nan) if e.label in self.lost else s
            for e, s in zip(experiment.estimators, rows.observers, strict=True)
        )
        return replace(rows, observers=states)

    def _trimmed(self, experiment: Engine) -> "LiveColumns":
        """Return the columns without the rows that no window needs any more."""
        end = self.first + sum(len(r.index) for _, r in self.parts)
        start = _tail_start(experiment, end)
        parts, first = list(self.parts), self.first
        while parts and first + len(parts[0][1].index) <= start:
            first += len(parts.pop(0)[1].index)
        if parts and first < start:
            parts[0] = (parts[0][0], parts[0][1].part(start - first))
            first = start
        return replace(self, parts=tuple(parts), first=first)

    # ---- reports -----------------------------------------------------------------------------------------------------

    def lost_since(self, before: "LiveColumns", record: float) -> list[Event]:
        """Return an event for everything that has diverged since `before`, at the first row that is not finite."""
        new = {label: diverged for label, diverged in self.lost.items() if label not in before.lost}
        if self.plant_lost and not before.plant_lost:
            new[""] = self.plant_lost
        return [
            Event(
                row=round(diverged.time / record),
                t=diverged.time,
                kind="diverged",
                subject=label,
                message=Text.of(
                    Message("event.diverged", observer=label, cause=diverged.cause)
                    if label
                    else Message("event.plant-diverged")
                ),
            )
            for label, diverged in new.items()
        ]

    def assumptions(self, experiment: Engine) -> list[Assumptions]:
        """Return the checks of each observer over the rows of the tail; observers without a row yet are left out."""
        if not self.parts:
            return []
        end = self.first + sum(len(r.index) for _, r in self.parts)
        started = tuple(e for e in experiment.estimators if e.since // experiment.every < end)
        plant = np.concatenate([r.plant for _, r in self.parts])
        y = np.concatenate([r.y for _, r in self.parts])
        values, ended = plant_values(self.parts, plant), finite_plant_rows(experiment, plant)
        reports = []
        for life in _present(self.parts, started):
            if life.label in self.lost:
                continue
            _, report = observer_columns(life, values, y, ended, first_row=self.first)
            checks = tuple(
                AssumptionCheck(
                    name=Text.of(c.name),
                    verdict=c.verdict,
                    text=Text.of(c.text),
                    value=_plain(c.value),
                    threshold=_plain(c.threshold),
                    source=c.source,
                    gains=None if c.gains is None else {name: tuple(values) for name, values in c.gains.items()},
                )
                for c in report.checks
            )
            reports.append(Assumptions(observer=life.label, checks=checks))
        return reports


def _is_column(value: np.ndarray | float) -> TypeGuard[np.ndarray]:
    """Return whether a value is given along the rows."""
    return np.ndim(value) > 0


def _plain(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)


def _tail_start(experiment: Engine, row: int) -> int:
    """Return the first row that must be kept for the rows from `row` on to be right: two whole windows before.

    A few rows are kept in any case, for the checks of assumptions.
    """
    start = row - _SHORTEST_TAIL
    for e in experiment.estimators:
        window = e.parameters.get("g.window")
        if window is not None:
            length = max(1, round(window / (experiment.every * experiment.step)))
            start = min(start, (row // length - 2) * length)
    return max(0, start)


def columns_of(experiment: Engine) -> tuple[str, ...]:
    """Return the names of an experiment's columns, in the order of every export."""
    names = ["t", *experiment.given]
    if not experiment.recorded:
        names += _unknown_columns(experiment)
    names += experiment.plant.outputs
    for e in experiment.estimators:
        names += [f"{e.label}.{n}" for n in _own_columns(e, set(names))]
    return tuple(names)


def _unknown_columns(experiment: Engine) -> list[str]:
    """Return the names of the columns of a simulated plant that a record lacks: states, controllers, true faults."""
    names = [*experiment.plant.states]
    names += experiment.loop.controller_states if experiment.loop is not None else ()
    return names + [n for n in experiment.signals if n.startswith("theta.")]


def _own_columns(e: Estimator, present: set[str]) -> tuple[str, ...]:
    sigmas = tuple(f"sigma.{c}" for c in e.channels) if has_spread(e) else ()
    return _names(_NameKey(e, truth_names(e) <= present)) + sigmas


class _NameKey:
    """An estimator as a dictionary key: two are equal if their columns have the same names."""

    def __init__(self, e: Estimator, judged: bool) -> None:
        self.estimator, self.judged = e, judged
        self.key = (e.program.digest, e.kind.id, e.channels, tuple(std > 0 for std in e.context.noise_std), judged)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _NameKey) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


@lru_cache(maxsize=256)
def _names(key: _NameKey) -> tuple[str, ...]:
    """Return the names of x̂, θ̂, ŷ and the diagnostics, found by computing the diagnostics of a few rows of zeros."""
    e = key.estimator
    rows = 4
    outputs = [n for n in e.program.outputs if not n.startswith("init.")]
    values: dict[str, Any] = {n: np.zeros(rows) for n in (*e.program.states, *e.program.inputs, *outputs)}
    values |= {"t": np.arange(rows) * 1.0} | dict(e.parameters)
    measured = [n for n in e.program.inputs if n.startswith("y.")]
    values |= {f"intensity.{n}": 0.0 for n in measured}
    with np.errstate(all="ignore"):
        truth = Truth(np.zeros((rows, e.context.n)), np.zeros((rows, len(e.channels)))) if key.judged else None
        run = Observed(None, e.program, e.channels, e.facts, values, 1.0, e.context, truth=truth, probe=_nothing)
        more = e.kind.diagnostics(run)
    return (*(n for prefix in ("x.", "theta.", "y.") for n in outputs if n.startswith(prefix)), *more)


def _nothing(names: Sequence[str], values: Mapping[str, Any]) -> np.ndarray:
    return np.zeros((len(names), len(values["t"])))


def _present(parts: Parts, estimators: tuple[Estimator, ...]) -> list[Life]:
    """Return the lives of the present observers, in their order."""
    newest = {life.label: life for life in lives(parts)}
    return [newest[e.label] for e in estimators]


def _with(parts: Parts, experiment: Engine, rows: Rows) -> Parts:
    """Return the parts with newer rows; consecutive rows of one experiment are one part,
    since every part costs time."""
    if not parts or parts[-1][0] is not experiment:
        return (*parts, (experiment, rows))
    last = parts[-1][1]
    observers = tuple(np.concatenate(pair) for pair in zip(last.observers, rows.observers, strict=True))
    index, plant, y = (np.concatenate([getattr(last, n), getattr(rows, n)]) for n in ("index", "plant", "y"))
    loops = [r.loop for r in (last, rows) if r.loop is not None]
    joined = Rows(index, plant, y, observers, loop=LoopRows.concatenated(loops) if loops else None)
    return (*parts[:-1], (experiment, joined))
