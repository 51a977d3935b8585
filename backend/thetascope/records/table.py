"""A file as columns, before anything is known of a plant."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message

MOST_ROWS = 2_000_000
MOST_COLUMNS = 2000
MOST_CELLS = 20_000_000
MOST_BYTES = 256 * 1024**2
"""The largest table, and the most bytes that a file may have when it is unpacked."""

Origin = Literal["", "second-line", "file"]
Kind = Literal["number", "datetime", "text", "empty"]


@dataclass(frozen=True)
class Column:
    """A column of a file.

    Attributes:
        name: as the file has it, without its unit only in formats that keep units apart.
        kind: `number`: values are float64, NaN where a number is missing; `datetime`: int64 nanoseconds, see `epoch`;
            `text` and `empty`: values are all NaN.
        values: (rows,)
        unit, unit_from: the unit that the file writes below the names or as metadata, and where.
        first: its first cells that are not empty.
        words: cells that are neither numbers nor empty, as (row from 0, text); at most a few, `count` has them all.
        count: number of those cells.
        epoch: of a datetime column: whether nanoseconds count from 1970 (`date`) or from midnight (`clock`).
    """

    name: str
    kind: Kind
    values: np.ndarray
    unit: str = ""
    unit_from: Origin = ""
    first: tuple[str, ...] = ()
    words: tuple[tuple[int, str], ...] = ()
    count: int = 0
    epoch: Literal["", "date", "clock"] = ""


@dataclass(frozen=True)
class Table:
    """The columns of a file.

    Attributes:
        columns: of equal length.
        lines: (rows,), line or row of each row in the file, from 1 on.
        format: short name of the format.
        dialect: how the file is written, for people.
        named: whether names are the file's; otherwise they are col1, col2, …
        notes: what the reader did, such as dropping a line that is cut off: (message, line).
    """

    columns: tuple[Column, ...]
    lines: np.ndarray
    format: str
    dialect: Message
    named: bool = True
    notes: tuple[tuple[Message, int], ...] = field(default=())

    def __len__(self) -> int:
        return len(self.lines)

    def named_as(self, name: str) -> Column | None:
        """Return the column of a name."""
        return next((column for column in self.columns if column.name == name), None)

    def rows(self, index: np.ndarray | slice) -> "Table":
        """Return some of the rows, in the given order."""
        columns = tuple(replace(column, values=column.values[index]) for column in self.columns)
        return replace(self, columns=columns, lines=self.lines[index])


def check_size(rows: int, columns: int) -> None:
    """Raise SpecError for a table that is larger than may be read."""
    if columns > MOST_COLUMNS:
        raise SpecError("file", columns, Message("record.file.too-wide", columns=columns, limit=MOST_COLUMNS))
    if rows > MOST_ROWS or rows * max(1, columns) > MOST_CELLS:
        limit = min(MOST_ROWS, MOST_CELLS // max(1, columns))
        raise SpecError("file", rows, Message("record.rows.over-limit", rows=rows, limit=limit))


def check_bytes(size: int) -> None:
    """Raise SpecError for content that is larger, when unpacked, than may be read."""
    if size > MOST_BYTES:
        raise SpecError("file", size, Message("record.file.too-large", limit=MOST_BYTES // 1024**2))


def distinct(names: list[str]) -> list[str]:
    """Return names of columns: an empty one becomes its place (col3), a repeated one gets a number."""
    result: list[str] = []
    for place, name in enumerate(names, 1):
        name = " ".join(name.split())[:200] or f"col{place}"
        unique, number = name, 2
        while unique in result:
            unique, number = f"{name[:190]} ({number})", number + 1
        result.append(unique)
    return result


def number_column(name: str, values: np.ndarray, unit: str = "") -> Column:
    """Return a column of numbers from a binary format; what is not finite is missing."""
    numbers = np.asarray(values, dtype=float)
    numbers = np.where(np.isfinite(numbers), numbers, np.nan)
    good = np.flatnonzero(~np.isnan(numbers))
    kind: Kind = "number" if len(good) else "empty"
    first = tuple(f"{numbers[k]:.10g}" for k in good[:3])
    return Column(name, kind, numbers, unit, "file" if unit else "", first)


def date_column(name: str, nanoseconds: np.ndarray) -> Column:
    """Return a column of dates with times, as int64 nanoseconds since 1970."""
    times = np.asarray(nanoseconds, dtype="i8")
    first = tuple(str(t.astype("M8[ms]")) for t in times[:3].astype("M8[ns]"))
    return Column(name, "datetime", times, first=first, epoch="date")
