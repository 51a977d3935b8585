"""Turn the cells of a text column into numbers, times or words."""

from collections import Counter

import numpy as np

from thetascope.records.table import Column, Origin
from thetascope.records.text.cells import Decimal, clean, is_missing, is_time, number, switch, with_unit
from thetascope.records.text.moments import nanoseconds

_SHARE = 0.8  # of the cells with content that are numbers in a column of numbers; the rest are words
_KEPT = 20  # words that are kept for messages
_FIRST = 3


class Cells:
    """The cells of one column, added block by block: numbers as such, all other cells as text."""

    def __init__(self, decimal: Decimal = ".") -> None:
        self.decimal: Decimal = decimal
        self._blocks: list[np.ndarray] = []
        self.others: list[tuple[int, str]] = []
        self.first: list[str] = []
        self.rows = 0

    def add(self, cells: list[str]) -> None:
        """Add the next cells."""
        joined = "".join(cells)
        commas = self.decimal == "," and "," in joined
        values = np.empty(0)
        plain = "_" not in joined and not (self.decimal == "," and "." in joined)
        try:
            values = np.array([float(cell.replace(",", ".")) for cell in cells] if commas else list(map(float, cells)))
            plain = plain and bool(np.isfinite(values).all())
        except ValueError:
            plain = False
        if len(self.first) < _FIRST:
            self.first += [cell.strip()[:40] for cell in cells[:1000] if cell.strip()][: _FIRST - len(self.first)]
        self._blocks.append(values if plain else self._one_by_one(cells))
        self.rows += len(cells)

    def values(self) -> np.ndarray:
        """Return the numbers, NaN where a cell is not a plain one."""
        return np.concatenate(self._blocks) if self._blocks else np.empty(0)

    def _one_by_one(self, cells: list[str]) -> np.ndarray:
        values = np.full(len(cells), np.nan)
        seen: dict[str, float | None] = {}
        for k, cell in enumerate(cells):
            if cell not in seen:
                seen[cell] = number(cell, self.decimal)
            value = seen[cell]
            if value is None:
                self.others.append((self.rows + k, cell))
            else:
                values[k] = value
        return values


def column_of(name: str, cells: Cells, unit: str = "") -> Column:
    """Return a column: of numbers if most of its cells are numbers, of times, or of words."""
    values = cells.values()
    origin: Origin = "second-line" if unit else ""
    first = tuple(cells.first)
    seen = {cell: _value(clean(cell), cells.decimal) for cell in dict.fromkeys(cell for _, cell in cells.others)}
    suffixes = Counter(suffix for _, suffix, _ in seen.values() if suffix)
    suffix = suffixes.most_common(1)[0][0] if suffixes else ""
    words: list[tuple[int, str]] = []
    missing = 0
    for row, cell in cells.others:
        value, own, cleaned = seen[cell]
        if value is None or own and own != suffix:  # another unit than that of the other cells
            words.append((row, cleaned))
        elif value != value:
            missing += 1
        else:
            values[row] = value
    full = cells.rows - missing
    if full == 0:
        return Column(name, "empty", values, unit, origin, first)
    if len(words) <= (1 - _SHARE) * full:
        suffix = "" if unit else suffix
        origin = origin or ("file" if suffix else "")
        return Column(name, "number", values, unit or suffix, origin, first, tuple(words[:_KEPT]), len(words))
    if sum(1 for _, cell in words[:1000] if is_time(cell)) > _SHARE * min(len(words), 1000):
        times = nanoseconds(cells.rows, words)
        if times is not None:
            ticks, epoch, wrong = times
            return Column(name, "datetime", ticks, unit, origin, first, tuple(wrong[:_KEPT]), len(wrong), epoch=epoch)
    return Column(name, "text", np.full(cells.rows, np.nan), unit, origin, first, tuple(words[:_KEPT]), len(words))


def _value(cell: str, decimal: Decimal) -> tuple[float | None, str, str]:
    """Return a cell's number and unit, NaN for a mark of a missing value, None for a word, and the cell."""
    if is_missing(cell):
        return np.nan, "", cell
    value = number(cell, decimal)
    if value is None:
        value = switch(cell)
    if value is None and (pair := with_unit(cell, decimal)):
        return *pair, cell
    return value, "", cell
