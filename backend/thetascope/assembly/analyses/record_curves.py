"""Curves of the diagnosis of a record, thinned for drawing: statistic, simulation, innovations."""

import numpy as np

from thetascope.diagnosis.records.diagnose import RecordAnswer
from thetascope.diagnosis.records.model import first_noise, start_of
from thetascope.diagnosis.records.noise_fit import Start
from thetascope_schemas import Plant

_POINTS = 800


def statistic(answer: RecordAnswer) -> dict | None:
    """Return the statistic along the record, the largest in each interval."""
    if not len(answer.statistic):
        return None
    edges = _places(len(answer.statistic))
    return {
        "t": answer.rows.t[edges].tolist(),
        "largest": np.maximum.reduceat(answer.statistic, edges).tolist(),
    }


def curves(plant: Plant, answer: RecordAnswer) -> dict:
    """Return the state in the first judged row, which fits the first rows, the simulation from there, and the
    innovations of the filter without faults."""
    model, rows = answer.model, answer.rows
    with np.errstate(all="ignore"):
        start = start_of(model, rows, first_noise(model, rows))
        initial = {n: float(x) for n, x in zip(plant.names("states"), start.x, strict=True) if np.isfinite(x)}
        return {
            "initial": initial,
            "simulated": _simulated(plant, answer, start.x),
            "innovations": _innovations(plant, answer, start),
        }


def _innovations(plant: Plant, answer: RecordAnswer, start: Start) -> dict | None:
    """Return the innovations in standard deviations: the smallest and the largest in each interval of time."""
    if answer.noise is None:
        return None
    noise, filter_ = answer.noise, answer.model.filter
    z, P = start.extended(noise.noise, noise.coloured)
    nu = np.concatenate([r.path.nu for _, _, r in filter_.blocks(answer.rows, noise.noise, z, P)])
    edges = _places(len(nu))
    low = np.fmin.reduceat(np.where(np.isfinite(nu), nu, np.nan), edges, axis=0)
    high = np.fmax.reduceat(np.where(np.isfinite(nu), nu, np.nan), edges, axis=0)
    named = {name: (low[:, k], high[:, k]) for k, name in enumerate(plant.names("outputs"))}
    return {
        "t": answer.rows.t[edges].tolist(),
        "low": {name: _finite(column) for name, (column, _) in named.items()},
        "high": {name: _finite(column) for name, (_, column) in named.items()},
    }


def _finite(column: np.ndarray) -> list[float | None]:
    """Return numbers, None for those that are not finite."""
    return [float(v) if np.isfinite(v) else None for v in column]


def _simulated(plant: Plant, answer: RecordAnswer, start: np.ndarray) -> dict:
    """Return the outputs of a simulation from the first judged row on, thinned."""
    model, rows = answer.model, answer.rows
    _, y = model.filter.simulate(rows, start)
    places = _places(len(rows.t))
    columns = np.where(np.isfinite(y[places]), y[places], np.nan).T
    outputs = {name: _finite(column) for name, column in zip(plant.names("outputs"), columns, strict=True)}
    return {"t": rows.t[places].tolist(), "outputs": outputs}


def _places(rows: int) -> np.ndarray:
    """Return the rows at which intervals of a curve begin."""
    return np.unique(np.linspace(0, rows, _POINTS + 1).astype(int))[:-1]
