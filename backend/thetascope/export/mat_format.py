"""MATLAB .mat (version 5): one column vector per column, under a name that MATLAB accepts."""

import io
import re
from collections.abc import Sequence

import numpy as np

from thetascope.export.selection import Table

_LONGEST = 63


def matlab_bytes(table: Table) -> bytes:
    """The file's bytes.

    Column `adaptive.theta.theta1` becomes the variable `adaptive_theta_theta1` (see :func:`matlab_names`); the cell
    array `columns` holds the names as they are elsewhere, `variables` the names used here, in the same order.
    """
    from scipy.io import savemat  # slow to import, and only this needs it

    variables = matlab_names(table.names)
    contents: dict[str, np.ndarray] = dict(zip(variables, table.data, strict=True))
    contents["columns"] = _cells(table.names)
    contents["variables"] = _cells(variables)
    stream = io.BytesIO()
    savemat(stream, contents, oned_as="column")
    return stream.getvalue()


def matlab_names(names: Sequence[str]) -> list[str]:
    """Valid, distinct variable names: other characters than letters, digits and `_` become `_`; at most 63 long."""
    taken: set[str] = {"columns", "variables"}
    made = []
    for name in names:
        base = re.sub(r"[^A-Za-z0-9_]", "_", name)
        base = (base if base[:1].isascii() and base[:1].isalpha() else f"c_{base}")[:_LONGEST]
        candidate, count = base, 2
        while candidate in taken:
            suffix = f"_{count}"
            candidate, count = base[: _LONGEST - len(suffix)] + suffix, count + 1
        taken.add(candidate)
        made.append(candidate)
    return made


def _cells(texts: Sequence[str]) -> np.ndarray:
    cells = np.empty((len(texts), 1), dtype=object)
    cells[:, 0] = texts
    return cells
