"""From what the engine records to what is shown: columns of the newest rows, with a tail of older ones for windows.

The columns are made by the very functions that a run uses, on the tail and the new rows together, so they are the run's.
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from thetascope.engine.estimation.covariance import Spreads, has_spread, latest, sigma_columns
from thetascope.engine.execution.result_columns import finite_rows, observer_columns, plant_columns, plant_values
from thetascope.engine.execution.stages import Life, lives
from thetascope.engine.model.result import Diverged
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.simulation.experiment import Estimator, Rows
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope_schemas.service.run import AssumptionCheck
from thetascope_schemas.service.session import Assumptions, Event

_LEAST = 200  # rows
Parts = tuple[tuple[Engine, Rows], ...]


@dataclass(frozen=True)
class ColumnBatch:
    """Of the newest rows: their columns (columns × rows), S of each observer at them and after, and t, signals, parameters."""

    data: np.ndarray
    tables: Spreads
    values: dict

    def until(self, count: int) -> "ColumnBatch":
        """Of the first rows only."""
        return ColumnBatch(
            self.data[:, :count],
            {k: v[: count + 1] for k, v in self.tables.items()},
            {n: v[:count] if np.ndim(v) else v for n, v in self.values.items()},
        )


@dataclass(frozen=True)
class LiveColumns:
    """``parts`` hold the rows from ``first`` on; ``lost`` the observers that have diverged, when and why; ``plant_lost``: the same of
    the plant."""

    columns: tuple[str, ...]
    first: int
    parts: Parts = ()
    lost: dict[str, Diverged] | None = None
    plant_lost: Diverged | None = None
    spreads: Spreads = field(default_factory=dict)  # after the newest row

    @classmethod
    def opening(cls, experiment: Engine, row: int) -> "LiveColumns":
        """A view with no rows yet."""
        return cls(columns_of(experiment), row, (), {})

    @classmethod
    def resumable(cls, experiment: Engine, row: int, until: int, spreads: Spreads) -> "LiveColumns | None":
        """A view that begins at ``row`` and is right from ``until`` on; None if the windows need rows before that."""
        if row > _tail_start(experiment, until):
            return None
        return replace(cls.opening(experiment, row), spreads=spreads)

    def carried(self, experiment: Engine, row: int) -> "LiveColumns":
        """The view when another experiment goes on from a row."""
        present = {e.label for e in experiment.estimators if e.since // experiment.every < row}
        lost = {label: why for label, why in (self.lost or {}).items() if label in present}
        return replace(self, columns=columns_of(experiment), lost=lost)

    @property
    def last_measured(self) -> np.ndarray | None:
        """y in the newest row, if there is one."""
        return self.parts[-1][1].y[-1] if self.parts and len(self.parts[-1][1].y) else None

    def extended(self, experiment: Engine, rows: Rows) -> tuple["LiveColumns", "ColumnBatch"]:
        """The view with the newest rows, and what was made of them."""
        rows = self._without_lost(experiment, rows)
        parts = _with(self.parts, experiment, rows)
        plant = np.concatenate([r.plant for _, r in parts])
        y = np.concatenate([r.y for _, r in parts])
        ended = 0 if self.plant_lost else finite_rows(plant)
        plant[ended:], y[ended:] = np.nan, np.nan
        values = plant_values(parts, plant)
        count = len(rows.index)
        columns = {n: c[-count:] for n, c in plant_columns(experiment, values, plant, y).items()}
        lost = dict(self.lost or {})
        for life in _present(parts, experiment.estimators):
            more, report = observer_columns(
                life, values, y, ended, check=False, first_row=self.first, wanted=len(plant) - count
            )
            columns |= {f"{life.label}.{n}": c[-count:] for n, c in more.items()}
            if report.diverged is not None and life.label not in lost:
                lost[life.label] = report.diverged
        newest = {n: v[-count:] if np.ndim(v) else v for n, v in values.items()}
        sure, tables = sigma_columns(experiment, rows, newest, self.spreads)
        columns |= {
            n: np.where(np.isfinite(columns[n.replace(".sigma.", ".theta.", 1)]), c, np.nan) for n, c in sure.items()
        }
        data = np.stack([columns[n] for n in self.columns]) if count else np.empty((len(self.columns), 0))
        plant_lost = self.plant_lost
        if plant_lost is None and ended < len(plant):
            plant_lost = Diverged(float(values["t"][ended]), "the plant's own state escapes to infinity")
        after = replace(self, parts=parts, lost=lost, plant_lost=plant_lost, spreads=latest(tables))
        return after._trimmed(experiment), ColumnBatch(data, tables, newest)

    def continued(self, experiment: Engine, rows: Rows, spreads: Spreads) -> "LiveColumns":
        """The view with rows whose columns are known, and in which nothing is lost; ``spreads``: after them."""
        rows = self._without_lost(experiment, rows)
        return replace(self, parts=_with(self.parts, experiment, rows), spreads=spreads)._trimmed(experiment)

    def _without_lost(self, experiment: Engine, rows: Rows) -> Rows:
        """Rows of a diverged observer are void, whatever its numbers do later."""
        states = tuple(
            np.full_like(s, np.nan) if e.label in (self.lost or {}) else s
            for e, s in zip(experiment.estimators, rows.observers, strict=True)
        )
        return replace(rows, observers=states)

    def _trimmed(self, experiment: Engine) -> "LiveColumns":
        """Without the rows that no window needs any more."""
        end = self.first + sum(len(r.index) for _, r in self.parts)
        start = _tail_start(experiment, end)
        parts, first = list(self.parts), self.first
        while parts and first + len(parts[0][1].index) <= start:
            first += len(parts.pop(0)[1].index)
        if parts and first < start:
            parts[0] = (parts[0][0], parts[0][1].part(start - first))
            first = start
        return replace(self, parts=tuple(parts), first=first)

    # ---- what is said about it ---------------------------------------------------------------------------------------

    def lost_since(self, before: "LiveColumns", record: float) -> list[Event]:
        """Events for what has diverged in the newest rows, each at the first row that is none."""
        new = {k: v for k, v in (self.lost or {}).items() if k not in (before.lost or {})}
        if self.plant_lost and not before.plant_lost:
            new[""] = self.plant_lost
        return [
            Event(
                row=round(d.time / record),
                t=d.time,
                kind="diverged",
                subject=name,
                text=f"{name} diverged: {d.cause}" if name else d.cause,
            )
            for name, d in new.items()
        ]

    def assumptions(self, experiment: Engine) -> list[Assumptions]:
        """The checks of each observer over the rows of the tail; not of one that has none yet."""
        if not self.parts:
            return []
        end = self.first + sum(len(r.index) for _, r in self.parts)
        begun = tuple(e for e in experiment.estimators if e.since // experiment.every < end)
        plant = np.concatenate([r.plant for _, r in self.parts])
        y = np.concatenate([r.y for _, r in self.parts])
        values, ended = plant_values(self.parts, plant), finite_rows(plant)
        found = []
        for life in _present(self.parts, begun):
            if life.label in (self.lost or {}):
                continue
            _, report = observer_columns(life, values, y, ended, first_row=self.first)
            checks = tuple(
                AssumptionCheck(**{**vars(c), "value": _plain(c.value), "threshold": _plain(c.threshold)})
                for c in report.checks
            )
            found.append(Assumptions(observer=life.label, checks=checks))
        return found


def _plain(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)


def _tail_start(experiment: Engine, row: int) -> int:
    """The row from which on rows must be kept for the rows from ``row`` on to be right: two whole windows before.

    A few are kept in any case, for the checks of assumptions.
    """
    start = row - _LEAST
    for e in experiment.estimators:
        window = e.parameters.get("g.window")
        if window is not None:
            length = max(1, round(window / (experiment.every * experiment.step)))
            start = min(start, (row // length - 2) * length)
    return max(0, start)


def columns_of(experiment: Engine) -> tuple[str, ...]:
    """The columns of an experiment's rows, in the order of every export."""
    names = ["t"]
    for prefix in ("u.", "signal."):
        names += [n for n in experiment.signals if n.startswith(prefix)]
    names += [*experiment.plant.states, *(n for n in experiment.signals if n.startswith("theta."))]
    names += experiment.plant.outputs
    for e in experiment.estimators:
        names += [f"{e.label}.{n}" for n in _own_columns(e)]
    return tuple(names)


def _own_columns(e: Estimator) -> tuple[str, ...]:
    sure = tuple(f"sigma.{c}" for c in e.channels) if has_spread(e) else ()
    return _named(_Kept(e)) + sure


class _Kept:
    """An estimator as a key: what decides the names of its columns."""

    def __init__(self, e: Estimator):
        self.e = e
        self.key = (e.program.digest, e.kind.id, e.channels, tuple(std > 0 for std in e.context.noise_std))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Kept) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


@lru_cache(maxsize=256)
def _named(kept: _Kept) -> tuple[str, ...]:
    """Names of x̂, θ̂, ŷ and the diagnostics, found by asking for the diagnostics of a few rows of nothing."""
    e = kept.e
    rows = 4
    outputs = [n for n in e.program.outputs if not n.startswith("init.")]
    values = {n: np.zeros(rows) for n in (*e.program.states, *e.program.inputs, *outputs)}
    values |= {"t": np.arange(rows) * 1.0} | dict(e.parameters)
    measured = [n for n in e.program.inputs if n.startswith("y.")]
    values |= {f"intensity.{n}": 0.0 for n in measured}
    with np.errstate(all="ignore"):
        run = Observed(None, e.program, e.channels, e.facts, values, 1.0, e.context)
        more = e.kind.diagnostics(run)
    return (*(n for prefix in ("x.", "theta.", "y.") for n in outputs if n.startswith(prefix)), *more)


def _present(parts: Parts, estimators: tuple[Estimator, ...]) -> list[Life]:
    """The lives of the observers that watch now, in their order."""
    newest = {life.label: life for life in lives(parts)}
    return [newest[e.label] for e in estimators]


def _with(parts: Parts, experiment: Engine, rows: Rows) -> Parts:
    """The parts with newer rows; what the same experiment gave is one part, since every part costs time to look at."""
    if not parts or parts[-1][0] is not experiment:
        return (*parts, (experiment, rows))
    last = parts[-1][1]
    observers = tuple(np.concatenate(pair) for pair in zip(last.observers, rows.observers, strict=True))
    joined = Rows(*(np.concatenate([getattr(last, n), getattr(rows, n)]) for n in ("index", "plant", "y")), observers)
    return (*parts[:-1], (experiment, joined))
