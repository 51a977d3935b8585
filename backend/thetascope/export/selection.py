"""Select a part of a result: a range of time, some columns, every n-th row."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope_schemas.texts.names import normalised_path
from thetascope_schemas.texts.refusal import suggestion


@dataclass(frozen=True)
class Table:
    """Columns of equal length: `data` is float64 of shape (len(names), rows)."""

    names: tuple[str, ...]
    data: np.ndarray

    @property
    def rows(self) -> int:
        """Return the number of rows."""
        return self.data.shape[1]


def select(
    result: Result,
    columns: Sequence[str] | None = None,
    start: float | None = None,
    end: float | None = None,
    every: int = 1,
    points: int | None = None,
) -> Table:
    """Return rows with `start` <= t <= `end` (s): every `every`-th of them, or at most `points` evenly spaced rows.

    `columns` are names or patterns with `*` (`adaptive.theta.*`), in output order; None selects all.
    Without a range and decimation the table shares the result's memory. Raises SpecError for an unknown column.
    """
    time = result.data[result.names.index("t")]
    # The time of row k is k·record, which may differ from the decimal number by a rounding error.
    slack = 1e-9 * max(1.0, abs(float(time[-1])))
    first = 0 if start is None else int(np.searchsorted(time, start - slack, side="left"))
    last = time.size if end is None else int(np.searchsorted(time, end + slack, side="right"))
    last = max(first, last)
    if points is not None:
        every = max(every, -(-(last - first) // max(points, 1)))
    rows = slice(first, last, every)
    if columns is None:
        return Table(result.names, result.data[:, rows])
    chosen = indices(result.names, columns)
    return Table(tuple(result.names[i] for i in chosen), result.data[chosen, rows])


def indices(names: tuple[str, ...], patterns: Sequence[str]) -> list[int]:
    """Return the places of the names that match patterns, in the patterns' order. Raises SpecError for one without."""
    chosen: dict[int, None] = {}
    for pattern in map(normalised_path, patterns):
        matching = [i for i, name in enumerate(names) if name == pattern or fnmatchcase(name, pattern)]
        if not matching:
            hint = Message.from_data(suggestion(pattern[:80], names))
            raise SpecError("columns", pattern, Message("export.column.unknown", name=pattern[:80]), hint)
        chosen.update(dict.fromkeys(matching))
    return list(chosen)
