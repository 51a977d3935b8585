"""Comparison of times up to rounding, relative to the times or to the spacing of rows, never to a second."""

import math

import numpy as np

_OF_A_ROW = 1e-6
_RELATIVE = 1e-9


def slack(t: np.ndarray) -> float:
    """Return the difference in s up to which an instant counts as that of a row; t: (rows,) in s."""
    return _OF_A_ROW * float(t[1] - t[0]) if len(t) > 1 else 0.0


def earlier(a: float, b: float) -> bool:
    """Return whether a is before b by more than rounding."""
    return a < b and not math.isclose(a, b, rel_tol=_RELATIVE)
