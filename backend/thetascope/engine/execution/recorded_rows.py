"""Reduce a result from the rows at which the run was examined to those that the experiment records.

Examined rows are ``every`` base steps apart, recorded ones ``record``. Where a recorded row lies between two examined
ones, states, inputs, outputs and estimates are computed there; bands and diagnostics keep their last value.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thetascope.engine.execution.result_columns import estimates, plant_columns, plant_values
from thetascope.engine.execution.stages import lives
from thetascope.engine.model.result import Diverged, Result
from thetascope.engine.simulation.experiment import Experiment, Rows

Parts = Sequence[tuple[Experiment, Rows]]


def every_nth(parts: Parts, steps: int) -> list[tuple[Experiment, Rows]]:
    """Return the rows of spans at multiples of a number of base steps."""
    return [(e, rows.where(rows.index % steps == 0)) for e, rows in parts]


def with_rows(result: Result, parts: Parts, every: int, record: int) -> Result:
    """Return a result of examined rows with the recorded rows; ``parts``: the run, with both kinds of rows."""
    if record == every:
        return result
    if record % every == 0:
        return replace(result, data=np.ascontiguousarray(result.data[:, :: record // every]))
    wanted = every_nth(parts, record)
    exact = _exact_columns(wanted, result)
    latest = np.concatenate([rows.index for _, rows in wanted]) // every
    data = np.empty((len(result.names), len(latest)))
    for row, name, examined in zip(data, result.names, result.data, strict=True):
        row[:] = exact.get(name, examined[latest])
    absent = {life.label: np.ones(len(latest), dtype=bool) for life in lives(wanted)}
    for life in lives(wanted):
        absent[life.label][life.where] = False
    for label, places in absent.items():
        for row, name in zip(data, result.names, strict=True):
            if name.startswith(f"{label}.") and name not in exact:
                row[places] = np.nan
    return replace(result, data=data)


def _exact_columns(parts: Parts, result: Result) -> dict[str, np.ndarray]:
    """Return the columns that depend on the present row only; NaN after a divergence and where no observer runs."""
    first = parts[0][0]
    plant, y = (np.concatenate([getattr(rows, name) for _, rows in parts]) for name in ("plant", "y"))
    t = np.concatenate([rows.index for _, rows in parts]) * first.step
    plant[_after(t, result.diverged)], y[_after(t, result.diverged)] = np.nan, np.nan
    values = plant_values(parts, plant)
    columns = plant_columns(first, values, plant, y)
    diverged = {report.label: report.diverged or result.diverged for report in result.observers}
    for life in lives(parts):
        states = np.concatenate(life.states)
        states[_after(t[life.where], diverged[life.label])] = np.nan
        for name, column in estimates(life, values, y, states)[0].items():
            columns.setdefault(f"{life.label}.{name}", np.full(len(t), np.nan))[life.where] = column
    return {n: np.where(np.isfinite(c), c, np.nan) for n, c in columns.items()}


def _after(t: np.ndarray, diverged: Diverged | None) -> np.ndarray:
    """Return whether each time in s is after a divergence."""
    return np.zeros(len(t), dtype=bool) if diverged is None else t >= diverged.time
