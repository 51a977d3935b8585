"""The part of a result that is asked for: a range of time, some columns, every n-th row."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope_schemas.texts.refusal import suggestion


@dataclass(frozen=True)
class Table:
    """Columns of equal length: `data` is float64 of shape (len(names), rows)."""

    names: tuple[str, ...]
    data: np.ndarray

    @property
    def rows(self) -> int:
        """Number of rows that are written."""
        return self.data.shape[1]


def select(
    result: Result,
    columns: Sequence[str] | None = None,
    start: float | None = None,
    end: float | None = None,
    every: int = 1,
    points: int | None = None,
) -> Table:
    """Rows with `start` <= t <= `end` (s), every `every`-th of them or as few as make at most `points` rows.

    `columns` are names or patterns with `*` (`adaptive.theta.*`), in the order wanted; None gives all.
    Without a range and decimation the table shares the result's memory. Raises SpecError for an unknown column.
    """
    time = result.data[result.names.index("t")]
    # Row k is at k·record, which may miss a decimal by a rounding.
    slack = 1e-9 * max(1.0, abs(float(time[-1])))
    first = 0 if start is None else int(np.searchsorted(time, start - slack, side="left"))
    last = time.size if end is None else int(np.searchsorted(time, end + slack, side="right"))
    last = max(first, last)
    if points is not None:
        every = max(every, -(-(last - first) // max(points, 1)))
    rows = slice(first, last, every)
    if columns is None:
        return Table(result.names, result.data[:, rows])
    chosen = _indices(result.names, columns)
    return Table(tuple(result.names[i] for i in chosen), result.data[chosen, rows])


def _indices(names: tuple[str, ...], wanted: Sequence[str]) -> list[int]:
    chosen: dict[int, None] = {}
    for pattern in wanted:
        found = [i for i, name in enumerate(names) if name == pattern or fnmatchcase(name, pattern)]
        if not found:
            hint = Message.from_data(suggestion(pattern[:80], names))
            raise SpecError("columns", pattern, Message("export.column.unknown", name=pattern[:80]), hint)
        chosen.update(dict.fromkeys(found))
    return list(chosen)
