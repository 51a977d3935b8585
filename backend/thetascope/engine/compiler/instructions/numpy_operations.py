"""Evaluation of graph operations on NumPy arrays, for checks, analyses and tests; runs use compiled kernels."""

from collections.abc import Callable

import numpy as np

MOST_ITERATIONS = 1000  # evaluations of the equations in Newton's method
SHORTEST = 2.0**-30  # share of a step that is tried
CLOSE = 1e-9  # a step below this share of z is the last one: the error after it is its square
ROUNDING = 1e-13  # a residual below this share of its terms is zero


def _locate(x, grid: tuple[float, ...]):
    return np.where(np.isnan(x), 0.0, np.searchsorted(grid, x, side="right"))


def _piece(x, index, pieces: tuple[tuple[float, ...], ...]):
    row = np.moveaxis(np.asarray(pieces)[np.asarray(index, dtype=int)], -1, 0)
    s = x - row[0]
    total = row[-1]
    for c in row[-2:0:-1]:
        total = total * s + c
    return total


def _spow(x, a):
    return np.copysign(np.abs(x) ** a, x)


def newton(start: np.ndarray, at: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the roots (n, …) of equations by a damped Newton method; NaN where it does not converge.

    ``at(z)`` returns g, the step J⁻¹g and the size of the terms of g, of shape (3, n, …). A step is halved until the
    residuals, each relative to the size of its terms at the point before, become smaller.
    """
    z, d, w = start, np.zeros_like(start), np.ones_like(start)
    level, factor = np.full(start.shape[1:], np.inf), np.ones(start.shape[1:])
    result, open_ = np.full_like(start, np.nan), np.ones(start.shape[1:], dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(MOST_ITERATIONS):
            trial = z - factor * d
            g, step, size = at(trial)
            residual = np.sum(np.abs(g) * w, axis=0)
            finite = np.isfinite(residual) & np.isfinite(step).all(axis=0)
            close = (np.abs(step) <= CLOSE * np.abs(trial)) | (np.abs(g) <= ROUNDING * size)
            done = open_ & finite & close.all(axis=0)
            result = np.where(done, trial - step, result)
            open_ &= ~done
            if not open_.any():
                break
            better = finite & (residual <= (1 - factor / 4) * level)
            weight = np.where(size > 0, 1 / size, 0.0)
            z, d, w = (np.where(better, new, old) for new, old in ((trial, z), (step, d), (weight, w)))
            level = np.where(better, np.sum(np.abs(g) * weight, axis=0), level)
            factor = np.where(better, np.minimum(1.0, 2 * factor), factor / 2)
            open_ &= np.isfinite(level) & (factor > SHORTEST)
    return result


NUMPY = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "fma": lambda a, b, c: a * b + c,
    "min": lambda a, b: np.where(b < a, b, a),
    "max": lambda a, b: np.where(b > a, b, a),
    "sign": lambda a: np.where(a > 0, 1.0, np.where(a < 0, -1.0, a * 0.0)),
    "lt": lambda a, b: np.where(a < b, 1.0, 0.0),
    "le": lambda a, b: np.where(a <= b, 1.0, 0.0),
    "and": lambda a, b: np.where((a != 0) & (b != 0), 1.0, 0.0),
    "or": lambda a, b: np.where((a != 0) | (b != 0), 1.0, 0.0),
    "where": lambda c, a, b: np.where(c != 0, a, b),
    "pow": lambda a, b: a**b,
    "spow": _spow,
    "atan2": np.arctan2,
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "floor": np.floor,
    "abs": np.abs,
    "locate": _locate,
    "piece": _piece,
    "root": lambda roots, j: roots[int(j)],
}
