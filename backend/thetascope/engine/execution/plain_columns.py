"""Columns of a run without checks, bands and diagnostics: the truth, y and the estimates.

For studies of many runs, in which these take longer than the simulation. A run has the same bits here, alone or in
lanes, as with everything.
"""

from collections.abc import Callable, Sequence

import numpy as np

from thetascope.engine.execution.divergence import end_of_plant
from thetascope.engine.execution.result_columns import estimates, lived, plant_columns, plant_values
from thetascope.engine.execution.run_experiment import spans_of
from thetascope.engine.execution.stages import final_estimator, lives
from thetascope.engine.inputs.time_grid import Grid, cut
from thetascope.engine.model.result import Diverged, ObserverReport, Result
from thetascope.engine.simulation.batch import run_batch
from thetascope.engine.simulation.experiment import Experiment, Rows
from thetascope.engine.simulation.simulation import Simulation


def plain_run(experiment: Experiment) -> Result:
    """Run an experiment alone, with the steps that its accuracy needs."""
    parts = spans_of(experiment)
    return _columns([(experiment, Rows.joined([rows for _, rows in parts]))])


def plain_batch(experiments: Sequence[Experiment], cancelled: Callable[[], bool] | None = None) -> list[Result]:
    """Run experiments of one shape in lanes; each has the bits of `plain_run`. Raises ValueError as `run_batch`.

    They must have a fixed number of substeps, and `in_lanes` must hold for them.
    """
    batch = run_batch(experiments, cancelled)
    results, grids = [], {}
    for i, e in enumerate(experiments):
        plant = batch.plant[i]
        y = _measured(e, batch.index, plant, grids)
        rows = Rows(batch.index, plant.copy(), y, tuple(states[i] for states in batch.observers))
        results.append(_columns([(e, rows)]))
    return results


def _measured(e: Experiment, index: np.ndarray, plant: np.ndarray, grids: dict[bytes, Grid]) -> np.ndarray:
    """Return the measured outputs (rows, m) of a run in lanes, in which nothing feeds the measurement back.

    `grids` keeps the grids of runs of this shape by the times at which their steps are divided.
    """
    simulation = Simulation(e, e.substeps or 1)
    breaks = simulation.breaks(0, e.steps + 1)
    grid = grids.get(breaks.tobytes())
    if grid is None:
        grid = grids[breaks.tobytes()] = cut(0, e.steps + 1, e.step, breaks, e.every, simulation.substeps)
    return simulation.measured_rows(grid, 0, index, plant, None)


def _columns(parts: Sequence[tuple[Experiment, Rows]]) -> Result:
    (e, rows), *_ = parts
    plant, y = rows.plant.copy(), rows.y.copy()
    ended, cause = end_of_plant(e, rows.index, plant, y)
    diverged = None
    if cause is not None:
        diverged = Diverged(float(rows.index[ended] * e.step), cause)
        plant[ended:], y[ended:] = np.nan, np.nan
    values = plant_values(parts, plant)
    columns = plant_columns(e, values, plant, y)
    reports = []
    for life in lives(parts):
        states, lost = lived(life, values, ended)
        found, _ = estimates(life, values, y, states)
        columns |= {f"{life.label}.{name}": column for name, column in found.items()}
        one = final_estimator(life)
        reports.append(ObserverReport(one.label, one.kind.id, one.kind.title, (), lost, one.facts))
    data = np.empty((len(columns), len(rows.index)))
    for row, column in zip(data, columns.values(), strict=True):
        row[:] = column
    substeps = max(e.substeps or 1, rows.accuracy.substeps if rows.accuracy else 1)
    accuracy = rows.accuracy
    return Result(tuple(columns), data, tuple(reports), diverged, e.step, substeps, (), {}, accuracy=accuracy)
