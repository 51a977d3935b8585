"""Linear matrix inequalities, solved by Clarabel.

The unknowns are the entries of one vector v. A matrix that is affine in v is a table of its coefficients: the constant
part first, then one symmetric matrix for each unknown, shape (1 + unknowns, size, size).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def least(cost: np.ndarray, positive: Sequence[np.ndarray]) -> np.ndarray | None:
    """Return the v (unknowns,) with the least cost·v for which each of the affine matrices is positive semidefinite.

    Returns None where there is none, or where the solver cannot tell. An interior-point method meets the inequalities
    to about 1e-8 of their coefficients: who needs strict ones leaves a margin and tests the answer.
    """
    import clarabel
    from scipy.sparse import csc_matrix

    rows = [-_triangle(table[1:]) for table in positive]
    constants = [_triangle(table[:1])[:, 0] for table in positive]
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_iter, settings.max_threads = False, 100, 1
    unknowns = len(cost)
    solver = clarabel.DefaultSolver(
        csc_matrix((unknowns, unknowns)),
        np.asarray(cost, dtype=float),
        csc_matrix(np.vstack(rows)),
        np.concatenate(constants),
        [clarabel.PSDTriangleConeT(table.shape[1]) for table in positive],
        settings,
    )
    answer = solver.solve()
    v = np.asarray(answer.x)
    solved = answer.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
    return v if solved and np.isfinite(v).all() else None


def _triangle(table: np.ndarray) -> np.ndarray:
    """Return the upper triangles, column by column, off-diagonal entries times √2 (triangle, matrices)."""
    size = table.shape[1]
    columns, rows = np.tril_indices(size)
    return (table[:, rows, columns] * np.where(rows == columns, 1.0, np.sqrt(2.0))).T
