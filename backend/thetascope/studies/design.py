"""The points of a study: which value each factor takes at a point. Pure: a point depends on its number only."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.stats import qmc

from thetascope_schemas.service.study.factors import (
    AnyFactor,
    CasesFactor,
    FaultsFactor,
    ListFactor,
    ObserversFactor,
    RangeFactor,
)
from thetascope_schemas.service.study.study import Study

_CHUNK = 1024
"""Points of a Sobol sequence that are drawn at once; a power of two, as the sequence asks for."""


@dataclass(frozen=True)
class Value:
    """The value of a factor at a point.

    Args:
        column: name of the factor's column.
        shown: the value in the table, a number or a text.
        changes: path → new value.
        faults: channels and sizes that replace the faults; None: the experiment's stay.
        observer: label of the only observer that stays; None: all.
    """

    column: str
    shown: float | str
    changes: Mapping[str, object]
    faults: tuple[Mapping[str, object], ...] | None = None
    observer: str | None = None


def values_at(study: Study, point: int) -> tuple[Value, ...]:
    """Return the value of each factor at a point, in the order of `vary`."""
    if study.design == "grid":
        return _of_grid(study, point)
    shares = _shares(study.design, len(study.vary), study.design_seed, study.point_count, point)
    return tuple(_sampled(factor, float(share)) for factor, share in zip(study.vary, shares, strict=True))


def is_number(factor: AnyFactor) -> bool:
    """Return whether a factor's column holds numbers."""
    if isinstance(factor, ListFactor):
        return all(type(value) in (int, float) for value in factor.values)
    return isinstance(factor, RangeFactor)


def _of_grid(study: Study, point: int) -> tuple[Value, ...]:
    """Return the values of a point of the grid, in which the last factor changes fastest."""
    places: list[int] = []
    for size in reversed([size or 1 for size in study.sizes]):
        point, place = divmod(point, size)
        places.append(place)
    return tuple(_item(factor, place) for factor, place in zip(study.vary, reversed(places), strict=True))


def _sampled(factor: AnyFactor, share: float) -> Value:
    """Return the value of a factor at a share in [0, 1) of its range or of its items."""
    if isinstance(factor, RangeFactor):
        return _number(factor, _between(factor, share))
    size = _count(factor)
    return _item(factor, min(int(share * size), size - 1))


def _count(factor: AnyFactor) -> int:
    match factor:
        case ListFactor():
            return len(factor.values)
        case CasesFactor():
            return len(factor.cases)
        case FaultsFactor():
            return len(factor.sets)
        case ObserversFactor():
            return len(factor.labels)
        case RangeFactor():
            return factor.points or 1


def _item(factor: AnyFactor, place: int) -> Value:
    match factor:
        case RangeFactor():
            assert factor.points is not None, "the schema asks for points in a grid"
            return _number(factor, _between(factor, place / (factor.points - 1)))
        case ListFactor():
            value = factor.values[place]
            if is_number(factor) and isinstance(value, int | float):
                return Value(factor.column, float(value), {factor.path: value})
            return Value(factor.column, value if isinstance(value, str) else json.dumps(value), {factor.path: value})
        case CasesFactor():
            label = list(factor.cases)[place]
            return Value(factor.column, label, factor.cases[label])
        case FaultsFactor():
            channels = factor.sets[place]
            steps = tuple(_step(factor, channel) for channel in channels)
            return Value(factor.column, " + ".join(channels), {}, faults=steps)
        case ObserversFactor():
            label = factor.labels[place]
            return Value(factor.column, label, {}, observer=label)


def _step(factor: FaultsFactor, channel: str) -> dict[str, object]:
    size = factor.sizes[channel]
    return {"channel": channel, "shape": "step", "size": size, "onset": factor.onset, "end": factor.end}


def _number(factor: RangeFactor, value: float) -> Value:
    return Value(factor.column, value, {factor.path: value})


def _between(factor: RangeFactor, share: float) -> float:
    """Return a number of a range; its bounds exactly at the shares 0 and 1."""
    if share in (0.0, 1.0):
        return factor.high if share else factor.low
    if factor.scale == "log":
        return math.exp(math.log(factor.low) * (1 - share) + math.log(factor.high) * share)
    return factor.low * (1 - share) + factor.high * share


def _shares(design: str, dimension: int, seed: int, count: int, point: int) -> Sequence[float]:
    """Return a point of the unit box (dimension,)."""
    if dimension == 0:
        return ()
    if design == "random":
        generator = np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, point]))
        return generator.random(dimension).tolist()
    if design == "latin-hypercube":
        return _hypercube(dimension, seed, count)[point].tolist()
    return _sobol(dimension, seed, point // _CHUNK)[point % _CHUNK].tolist()


@lru_cache(maxsize=2)
def _hypercube(dimension: int, seed: int, count: int) -> np.ndarray:
    return qmc.LatinHypercube(dimension, rng=np.random.default_rng(seed)).random(count)


@lru_cache(maxsize=8)
def _sobol(dimension: int, seed: int, chunk: int) -> np.ndarray:
    """Return a chunk of a scrambled Sobol sequence (points, dimension)."""
    sequence = qmc.Sobol(dimension, rng=np.random.default_rng(seed))
    if chunk:
        sequence.fast_forward(chunk * _CHUNK)
    return sequence.random(_CHUNK)
