"""Scales of states for the control of the step: the size against which the error of each state is judged.

The scale of a plant's state is its largest absolute value along the healthy run, or so far in the run if that is
larger. The scale of an estimate is at least that of the quantity that it estimates. An element of a matrix (Γ, P, Υ …)
is judged by its own size, at least by a share of the size that its rows and columns suggest, and MATRIX_TOLERANCE times
less strictly: its error reaches the estimates only as a factor of the innovations.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from thetascope.engine.observers.support.kalman_defaults import typical_sizes
from thetascope.engine.simulation.experiment import Estimator, Experiment

MATRIX_TOLERANCE = 100.0  # times that of the estimates
DIVERGED = 1e12  # times the scale: a state that is as large is lost, and no longer measured
_INFINITE = 1e150  # the same for a state without a scale: its square is not finite
_SHARE = 1e-3  # of the size that rows and columns suggest: the least scale of an element of a matrix
_COVARIANCES = ("P", "Gamma", "S")
_SENSITIVITIES = ("Upsilon", "Omega")


def plant_scales(experiment: Experiment) -> np.ndarray:
    """Return the least scale of each plant state (n,); states that only the true plant has are judged by their size."""
    least = np.abs(experiment.x0.astype(float))
    healthy = experiment.context.healthy
    if healthy is not None:
        known = len(healthy.scales.extents)
        least[:known] = np.maximum(least[:known], healthy.scales.extents)
    return least


class ObserverScales:
    """Scales of an observer's states, from their largest sizes so far and the scales of the plant's states."""

    def __init__(self, estimator: Estimator):
        context = estimator.context
        names = tuple(s["name"] for s in context.model["states"])
        typical = dict(zip(estimator.channels, typical_sizes(context), strict=False))
        self._groups = _groups(estimator.program.states)
        places = _places(estimator.program.states, names, tuple(typical))
        by_kind = {
            kind: np.array([p for k, *p in places if k == kind] or np.empty((0, 3)), dtype=int) for kind in _KINDS
        }
        self._x, self._theta, self._covariance, entries = (by_kind[kind] for kind in _KINDS)
        self._sensitivities = [entries[entries[:, 1] == row] for row in np.unique(entries[:, 1])]
        self._diagonal = np.array([place for kind, place, *_ in places if kind == "diagonal"], dtype=int)
        self._typical = np.array(list(typical.values()) or [1.0])
        loose = np.full(len(estimator.program.states), MATRIX_TOLERANCE)
        loose[self._x[:, 0]] = loose[self._theta[:, 0]] = 1.0
        self._loose = loose

    def __call__(self, sizes: np.ndarray, plant: np.ndarray) -> np.ndarray:
        """Return scales like ``sizes`` (points, states); ``plant``: scales of the plant's states (points, n)."""
        floor = np.zeros_like(sizes)
        for first, last in self._groups:  # of what kind is not known: an element that is zero is not judged by rounding
            floor[:, first:last] = 1e-13 * sizes[:, first:last].max(axis=1, keepdims=True)
        floor[:, self._diagonal] = 0.0
        place, i, _ = self._x.T
        floor[:, place] = plant[:, i]
        place, i, _ = self._theta.T
        floor[:, place] = self._typical[i]
        place, i, j = self._covariance.T
        floor[:, place] = _SHARE * np.sqrt(sizes[:, i]) * np.sqrt(sizes[:, j])
        for row in self._sensitivities:  # its unit is not known, only that of each column, which belongs to one fault
            place, typical = row[:, 0], self._typical[row[:, 2]]
            floor[:, place] = _SHARE * (sizes[:, place] * typical).max(axis=1, keepdims=True) / typical
        return np.maximum(sizes, floor)

    def errors(self, errors: np.ndarray, scales: np.ndarray) -> np.ndarray:
        """Return errors (points, states) relative to scales, those of matrices divided by MATRIX_TOLERANCE."""
        return np.abs(errors) / np.maximum(scales * self._loose, 1e-300)

    def limits(self, plant: np.ndarray) -> np.ndarray:
        """Return the size (states,) beyond which each state is lost; ``plant``: scales of the plant's states (n,)."""
        limits = np.full(len(self._loose), _INFINITE)
        limits[self._x[:, 0]] = DIVERGED * plant[self._x[:, 1]]
        limits[self._theta[:, 0]] = DIVERGED * self._typical[self._theta[:, 1]]
        return np.minimum(limits, _INFINITE)


_KINDS = ("x", "theta", "covariance", "sensitivity")


@lru_cache(maxsize=256)
def _places(
    states: tuple[str, ...], plant: tuple[str, ...], channels: tuple[str, ...]
) -> tuple[tuple[str, int, int, int], ...]:
    """Return the kind, the place, and two indices that the kind needs, of each state whose floor has a kind."""
    position = {s: i for i, s in enumerate(states)}
    places: list[tuple[str, int, int, int]] = []
    for place, name in enumerate(states):
        head, *rest = name.split(".")
        if head == "xh" and name[3:] in plant:
            places.append(("x", place, plant.index(name[3:]), 0))
        elif head == "thetah" and name[7:] in channels:
            places.append(("theta", place, channels.index(name[7:]), 0))
        elif len(rest) == 2 and all(r.isdigit() for r in rest):
            i, j = map(int, rest)
            first, second = position.get(f"{head}.{i}.{i}"), position.get(f"{head}.{j}.{j}")
            if head in _COVARIANCES and first is not None and second is not None and i != j:
                places.append(("covariance", place, first, second))
            elif head in _COVARIANCES:
                places.append(("diagonal", place, i, i))
            elif head in _SENSITIVITIES and j < len(channels):
                places.append(("sensitivity", place, 2 * i + _SENSITIVITIES.index(head), j))
    return tuple(places)


def _groups(states: Sequence[str]) -> list[tuple[int, int]]:
    """Return the first place, and the place after the last, of the states with each head."""
    heads = [s.split(".")[0] for s in states]
    starts = [i for i, head in enumerate(heads) if i == 0 or head != heads[i - 1]]
    return list(zip(starts, [*starts, len(states)][1:], strict=True))


def grown(size: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the largest sizes so far at each point (points, states), from those before and the values there."""
    with np.errstate(invalid="ignore"):
        known = np.where(np.isfinite(values), np.abs(values), 0.0)
    return np.maximum.accumulate(np.vstack([size[None, :], known]), axis=0)[1:]
