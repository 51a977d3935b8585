"""Linear equations of a filter that has lost its way: an answer in place of an exception."""

import numpy as np


def solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return x with matrix · x = right; the shortest least-squares solution where the matrix is singular, 0 where
    numbers are not finite."""
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return np.zeros_like(right)
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(matrix, right, rcond=None)[0]
