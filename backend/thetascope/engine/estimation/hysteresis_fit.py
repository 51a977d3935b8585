"""Weights and thresholds of backlash operators from a record of the input and output of a hysteresis.

The model is (5)–(9) of Zhou & Tan 2012, a Prandtl–Ishlinskii model of play operators,

    v(k) = c + w0 x(k) + Σ wi zi(k),   zi(k) = min(max(zi(k−1), x(k) − Di), x(k) + Di),

with wi ≥ 0. Its Remark 1 takes the weights as identified. For given thresholds Di it is linear in c and w, and solved
by non-negative least squares; thresholds are found on a grid first, then moved by Gauss–Newton steps with the weights
eliminated (variable projection).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares, nnls

from thetascope.engine.errors import SpecError
from thetascope.messages import Message

_GRID = 60
"""Thresholds of the grid, evenly spaced up to half the range of x."""
_WIDEST = 0.99
"""Of half the range of x: a wider operator never leaves its memory."""
_LEAST, _MOST = 20, 50_000
"""Rows that a fit needs at least, and may have at most: the operators are stepped row by row, many times."""
_ABSENT = 1e-9
"""Of the largest weight: an operator below it is left out."""


@dataclass(frozen=True)
class HysteresisFit:
    """Identified operators.

    Attributes:
        thresholds: Di (operators,), ascending, in the unit of x.
        weights: wi (operators,), in units of v per unit of x.
        direct: w0, the share of v that follows x without memory.
        offset: c, in the unit of v.
        residual: standard deviation of v less the model, in the unit of v.
        used: number of rows that the fit rests on.
        deviations: standard deviations of the weights for white residuals (operators,).
    """

    thresholds: np.ndarray
    weights: np.ndarray
    direct: float
    offset: float
    residual: float
    used: int
    deviations: np.ndarray


def plays(x: np.ndarray, thresholds: np.ndarray) -> np.ndarray:
    """Return the outputs of play operators (rows, operators) for their input x (rows,); they start at x(0)."""
    out = np.empty((len(x), len(thresholds)))
    z = np.full(len(thresholds), x[0])
    for low, high, row in zip(x[:, None] - thresholds, x[:, None] + thresholds, out, strict=True):
        np.minimum(np.maximum(z, low, out=z), high, out=z)
        row[:] = z
    return out


def identify(
    x: np.ndarray, v: np.ndarray, operators: int = 7, thresholds: Sequence[float] | None = None
) -> HysteresisFit:
    """Return the operators that explain v by x in least squares.

    Args:
        x, v: input and output of the hysteresis, (rows,); rows with a missing value are left out of the fit.
        operators: how many operators there may be; fewer where fewer suffice.
        thresholds: their thresholds, where they are known.

    Raises SpecError for too few rows, an input that does not move, and thresholds that are not positive.
    """
    x, v = np.asarray(x, dtype=float), np.asarray(v, dtype=float)
    if x.shape != v.shape or x.ndim != 1:
        raise SpecError("v", list(v.shape), Message("hysteresis.fit.shape", x=len(x), v=len(v)))
    moved = np.isfinite(x)
    x, v = x[moved], v[moved]
    rows = np.isfinite(v)
    if rows.sum() < _LEAST:
        raise SpecError("v", int(rows.sum()), Message("hysteresis.fit.rows", least=_LEAST, rows=int(rows.sum())))
    if len(x) > _MOST:
        raise SpecError("x", len(x), Message("hysteresis.fit.long", most=_MOST, rows=len(x)))
    reach = float(np.ptp(x)) / 2
    if not reach > 0:
        raise SpecError("x", float(x[0]), Message("hysteresis.fit.still"))
    size = float(np.ptp(v[rows])) or 1.0
    known = None
    if thresholds is not None:
        known = np.sort(np.asarray(thresholds, dtype=float))
        if not len(known) or not (np.isfinite(known) & (known > 0)).all():
            raise SpecError("thresholds", list(known), Message("hysteresis.fit.thresholds"))
    try:
        fit = _scaled_fit(x / reach, v / size, rows, operators, None if known is None else known / reach)
    except _OutOfReach as narrow:
        raise SpecError(
            "x", float(np.ptp(x)), Message("hysteresis.fit.range", widest=2 * reach * narrow.width)
        ) from None
    return replace(
        fit,
        thresholds=fit.thresholds * reach if known is None else known[np.isin(known / reach, fit.thresholds)],
        weights=fit.weights * size / reach,
        direct=fit.direct * size / reach,
        offset=fit.offset * size,
        residual=fit.residual * size,
        deviations=fit.deviations * size / reach,
    )


class _OutOfReach(Exception):
    """Raised where x does not move by twice the least threshold, `width`, which is in units of half the range of x."""

    def __init__(self, width: float) -> None:
        super().__init__(width)
        self.width = width


def _scaled_fit(
    x: np.ndarray, v: np.ndarray, rows: np.ndarray, operators: int, thresholds: np.ndarray | None
) -> HysteresisFit:
    """Return the fit for x with a range of 2 and v with a range of 1: tolerances of the optimiser are absolute."""
    if thresholds is not None:
        return _fitted(x, v, rows, thresholds)
    best = _best_of(x, v, rows, np.arange(1, _GRID) / _GRID, operators)
    for spacing in (0.5, 0.25, 0.1):  # of the grid: around what was found, where a valley may have been missed
        sides = spacing / _GRID * np.arange(-4, 5)
        closer = np.unique(np.clip(best.thresholds[:, None] + sides, 1e-6, _WIDEST))
        again = _best_of(x, v, rows, closer, operators)
        best = min((best, again), key=lambda fit: fit.residual)
    return best


def _best_of(x: np.ndarray, v: np.ndarray, rows: np.ndarray, grid: np.ndarray, operators: int) -> HysteresisFit:
    """Return the best fit of at most `operators` thresholds that begins from those of a grid."""
    found = _fitted(x, v, rows, grid)
    chosen = _joined(found, operators)
    even = chosen.max(initial=0.5) * np.arange(1, operators + 1) / operators
    finer = _fitted(x, v, rows, _refined(x, v, rows, _joined(found, 2 * operators)))
    starts = [start for start in (chosen, even, _joined(finer, operators)) if len(start)]
    fits = [_fitted(x, v, rows, _refined(x, v, rows, start)) for start in starts]
    return min(fits, key=lambda fit: fit.residual)


def _design(x: np.ndarray, rows: np.ndarray, thresholds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the columns x, z1, … at the rows that a fit may use (rows, 1 + operators), and these rows.

    An operator's first value is not known. It no longer matters once x has moved by 2 D away from a turning point, so
    rows before that are left out.
    """
    low, high = np.minimum.accumulate(x), np.maximum.accumulate(x)
    settled = np.flatnonzero(high - low >= 2 * thresholds.max(initial=0.0))
    begin = int(settled[0]) if len(settled) else len(x)
    picked = np.flatnonzero(rows & (np.arange(len(x)) >= begin))
    return np.column_stack([x[picked], plays(x, thresholds)[picked]]), picked


def _fitted(x: np.ndarray, v: np.ndarray, rows: np.ndarray, thresholds: np.ndarray) -> HysteresisFit:
    design, picked = _design(x, rows, thresholds)
    while len(picked) < _LEAST and len(thresholds) > 1:  # x never moves far enough for the widest
        thresholds = thresholds[:-1]
        design, picked = _design(x, rows, thresholds)
    if len(picked) < _LEAST:
        raise _OutOfReach(float(thresholds.max()))
    weights, offset = _weights(design, v[picked])
    left = v[picked] - offset - design @ weights
    used = weights[1:] > _ABSENT * max(weights.max(), 1e-300)
    freedom = max(1, len(picked) - int(used.sum()) - 2)
    residual = float(np.sqrt(left @ left / freedom))
    active = np.column_stack([np.ones(len(picked)), design[:, np.concatenate([[True], used])]])
    covariance = np.linalg.pinv(active.T @ active) * residual**2
    deviations = np.sqrt(np.maximum(np.diag(covariance)[2:], 0.0))
    return HysteresisFit(
        thresholds[used], weights[1:][used], float(weights[0]), offset, residual, len(picked), deviations
    )


def _weights(design: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, float]:
    """Return w ≥ 0 and the offset, by least squares on columns of equal size."""
    centred, mean = design - design.mean(axis=0), v - v.mean()
    size = np.sqrt(np.einsum("ij,ij->j", centred, centred))
    size = np.where(size > 0, size, 1.0)
    scaled, _ = nnls(centred / size, mean, maxiter=50 * design.shape[1])
    weights = scaled / size
    return weights, float(v.mean() - design.mean(axis=0) @ weights)


def _joined(fit: HysteresisFit, operators: int) -> np.ndarray:
    """Return at most `operators` thresholds: neighbours of the grid are joined, the lightest pair first."""
    thresholds, weights = list(map(float, fit.thresholds)), list(map(float, fit.weights))
    while len(thresholds) > operators:
        cost = [
            weights[i] * weights[i + 1] / (weights[i] + weights[i + 1]) * (thresholds[i + 1] - thresholds[i]) ** 2
            for i in range(len(thresholds) - 1)
        ]
        i = int(np.argmin(cost))
        total = weights[i] + weights[i + 1]
        middle = (weights[i] * thresholds[i] + weights[i + 1] * thresholds[i + 1]) / total
        thresholds[i : i + 2], weights[i : i + 2] = [middle], [total]
    return np.array(thresholds)


def _refined(x: np.ndarray, v: np.ndarray, rows: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Return thresholds moved to the least sum of squares; the weights follow them at each step."""
    _, picked = _design(x, rows, np.array([_WIDEST]))
    if not len(chosen) or len(picked) < _LEAST:
        return chosen

    def left(thresholds: np.ndarray) -> np.ndarray:
        design = np.column_stack([x[picked], plays(x, thresholds)[picked]])
        weights, offset = _weights(design, v[picked])
        return v[picked] - offset - design @ weights

    moved = least_squares(left, chosen, bounds=(1e-6, _WIDEST), diff_step=1e-4, max_nfev=200)
    return np.sort(moved.x)
