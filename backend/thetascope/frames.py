"""Columns as frames of polars or pandas."""

from collections.abc import Mapping
from typing import Any

import numpy as np

KINDS = ("polars", "pandas")


def frame_of(columns: Mapping[str, np.ndarray], kind: str = "polars") -> Any:
    """Return columns as a frame, one row for each time.

    Args:
        columns: name → values of shape (rows,).
        kind: "polars" or "pandas"; pandas must be installed.

    Raises:
        ValueError: the kind is another one.
        ImportError: pandas is not installed.
    """
    if kind not in KINDS:
        raise ValueError(f"a frame is of kind {' or '.join(KINDS)}, not {kind!r}")
    if kind == "polars":
        import polars

        return polars.DataFrame({name: np.array(values) for name, values in columns.items()})
    import pandas  # type: ignore[import-not-found]  # an optional package

    return pandas.DataFrame({name: np.array(values) for name, values in columns.items()})
