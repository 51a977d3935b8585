"""Write MATLAB .mat files (version 5): one column vector per column, under a name that MATLAB accepts."""

import io
import re
from collections.abc import Sequence

import numpy as np

from thetascope.export.selection import Table
from thetascope.figures.html_symbols import GREEK

_LONGEST = 63
_GREEK = {letter: word for word, letter in GREEK.items()}


def matlab_bytes(table: Table) -> bytes:
    """Return the file's bytes.

    Column `adaptive.theta.theta1` becomes the variable `adaptive_theta_theta1` (see :func:`matlab_names`). The cell
    array `columns` holds the original names, `variables` the names used here, in the same order.
    """
    from scipy.io import savemat  # slow to import and used only here

    variables = matlab_names(table.names)
    contents: dict[str, np.ndarray] = dict(zip(variables, table.data, strict=True))
    contents["columns"] = _cells(table.names)
    contents["variables"] = _cells(variables)
    stream = io.BytesIO()
    savemat(stream, contents, oned_as="column")
    return stream.getvalue()


def matlab_names(names: Sequence[str]) -> list[str]:
    """Return valid, distinct variable names of at most 63 characters: Greek letters by name, others as `_`."""
    taken: set[str] = {"columns", "variables"}
    variables = []
    for name in names:
        base = re.sub(r"[^A-Za-z0-9_]", "_", "".join(_GREEK.get(letter, letter) for letter in name))
        base = (base if base[:1].isascii() and base[:1].isalpha() else f"c_{base}")[:_LONGEST]
        candidate, count = base, 2
        while candidate in taken:
            suffix = f"_{count}"
            candidate, count = base[: _LONGEST - len(suffix)] + suffix, count + 1
        taken.add(candidate)
        variables.append(candidate)
    return variables


def _cells(texts: Sequence[str]) -> np.ndarray:
    cells = np.empty((len(texts), 1), dtype=object)
    cells[:, 0] = texts
    return cells
