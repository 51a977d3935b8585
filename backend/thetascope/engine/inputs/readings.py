"""The readings of a record as signals: each output held until its next reading, and the recorded inputs between rows.

A reading holds for 1.5 usual intervals of its output. In a longer gap it is missing: ``present`` is 0 there, and
observers predict (`engine/programs/replay.py`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thetascope.engine.inputs.signals import Signal, constant, steps, table

HELD, HELD_BEFORE, LINEAR = "held", "held-before", "linear"
"""Inputs between rows: those of the row before, of the row after (recorded before they changed), or interpolated."""
GAP = 1.5  # usual intervals of an output: for longer a reading does not hold
_ON_GRID = 1e-6  # of a step: a row as near to a base step is on it


@dataclass(frozen=True, eq=False)
class Readings:
    """Rows of a record on the base steps of a simulation.

    Attributes:
        t: (rows,), ascending times in s from 0 on; those near a base step are on it.
        y: (rows, outputs), readings; NaN where a cell is missing.
        outputs: the names of the outputs, ``y.*``.
        step: the base step in s.
    """

    t: np.ndarray
    y: np.ndarray
    outputs: tuple[str, ...]
    step: float

    @cached_property
    def held(self) -> tuple[Signal, ...]:
        """Return each output's last reading as a signal; before the first one it is the first one."""
        return tuple(_held(self.t[rows], self.y[rows, k]) for k, rows in enumerate(self._rows))

    @cached_property
    def present(self) -> dict[str, Signal]:
        """Return the signals ``present.<output>`` of outputs with gaps: 1 while a reading holds, else 0."""
        signals = {}
        for name, rows in zip(self.outputs, self._rows, strict=True):
            t = self.t[rows]
            gaps = self._gaps(t)
            if len(gaps):
                signals[f"present.{name}"] = steps(list(gaps.ravel()), [1.0, *[0.0, 1.0] * len(gaps)])
        return signals

    @cached_property
    def instants(self) -> np.ndarray | None:
        """Return the times in s at which an observer that works at samples acts; None: all base steps.

        They are the rows with a reading, and in gaps further instants a usual interval apart, without one.
        """
        taken = np.isfinite(self.y).any(axis=1)
        t = self.t[taken]
        usual = float(np.median(np.diff(t))) if len(t) > 1 else self.step
        regular = np.abs(t / self.step - np.rint(t / self.step)) < _ON_GRID
        if regular.all() and abs(usual - self.step) < _ON_GRID * self.step:
            return None
        parts = [np.linspace(a, b, max(1, round((b - a) / usual)) + 1)[1:] for a, b in zip(t[:-1], t[1:], strict=True)]
        return np.concatenate([t[:1], *parts])

    @cached_property
    def fresh(self) -> dict[str, Signal]:
        """Return the signals ``fresh.<output>``: 1 over the base step or instant that has a reading, else 0.

        Only outputs without a reading at some instant have one.
        """
        instants = self.instants
        last = self.t[-1] if len(self.t) else 0.0
        grid = np.arange(round(last / self.step) + 1) * self.step if instants is None else instants
        slack = _ON_GRID * self.step
        signals = {}
        for name, rows in zip(self.outputs, self._rows, strict=True):
            place = np.searchsorted(grid, self.t[rows] - slack)
            on = np.zeros(len(grid))
            on[place[place < len(grid)]] = 1.0
            if not on.all():
                signals[f"fresh.{name}"] = _held(grid, on)
        return signals

    @cached_property
    def _rows(self) -> list[np.ndarray]:
        """Return the rows in which each output has a reading."""
        return [np.flatnonzero(np.isfinite(column)) for column in self.y.T]

    def _gaps(self, t: np.ndarray) -> np.ndarray:
        """Return the beginnings and ends in s (gaps, 2) of the times without a reading; ``t``: of an output's rows."""
        longest = GAP * float(np.median(np.diff(t))) if len(t) > 1 else np.inf
        ends = np.append(t[1:], self.t[-1] + self.step)
        late = ends - t > longest * (1 + _ON_GRID)
        begins, ends = t[late] + longest, ends[late]
        if len(t) and t[0] > self.t[0] + _ON_GRID * self.step:
            begins, ends = np.append(self.t[0] - self.step, begins), np.append(t[0], ends)
        return np.stack([begins, ends], axis=1)


def on_grid(t: np.ndarray, step: float, only: bool = False) -> np.ndarray:
    """Return times with those near a base step moved onto it; ``only``: with all of them moved."""
    nearest = np.rint(t / step)
    return np.where(only | (np.abs(t / step - nearest) < _ON_GRID), nearest * step, t)


def input_between(t: np.ndarray, values: np.ndarray, course: str) -> Signal:
    """Return a recorded input as a signal; `course`: HELD, HELD_BEFORE or LINEAR."""
    if len(set(values.tolist())) <= 1:
        return constant(float(values[0]) if len(values) else 0.0)
    if course == LINEAR:
        return table(t.tolist(), values.tolist(), "linear")
    return _held(t, values if course == HELD else np.append(values[1:], values[-1]))


def _held(t: Sequence[float] | np.ndarray, values: np.ndarray) -> Signal:
    """Return the signal that is values[k] from t[k] on, and values[0] before; it breaks where the value changes."""
    if not len(values):
        return constant(0.0)
    changes = np.flatnonzero(np.diff(values) != 0) + 1
    return steps(list(np.asarray(t)[changes]), [values[0], *values[changes]])
