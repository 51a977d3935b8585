"""Columns from plain Python values, and one table from arrays of several lengths."""

from collections.abc import Mapping, Sequence

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.table import Column, Table, check_size, distinct, number_column
from thetascope.records.text.column_values import Cells, column_of


def column_of_values(name: str, values: Sequence[object], unit: str = "") -> Column:
    """Return a column of numbers, None, booleans and texts."""
    try:
        numbers = np.array([np.nan if v is None else v for v in values], dtype=float)
    except (TypeError, ValueError, OverflowError):
        cells = Cells()
        cells.add(["" if v is None else str(v) for v in values])
        return column_of(name, cells, unit)
    if any(isinstance(v, str) for v in values[:100]):
        cells = Cells()
        cells.add(["" if v is None else str(v) for v in values])
        return column_of(name, cells, unit)
    return number_column(name, numbers, unit)


def table_of_arrays(
    arrays: Mapping[str, np.ndarray], units: Mapping[str, str], format: str, columns: Mapping[str, Column] | None = None
) -> Table:
    """Return the arrays that have the most common length as columns; matrices are split into their columns.

    Raises SpecError if no array has two rows.
    """
    made: dict[str, Column] = {}
    unnamed: set[str] = set()
    for name, array in arrays.items():
        parts = _columns(name, np.asarray(array))
        unnamed |= {part for part, _ in parts} if len(parts) > 1 else set()
        for part, values in parts:
            made[part] = number_column(part, values, units.get(name, ""))
    made |= columns or {}
    lengths = [len(column.values) for column in made.values() if len(column.values) > 1]
    if not lengths:
        raise SpecError("file", None, Message("record.file.no-columns"))
    length = max(set(lengths), key=lambda n: (lengths.count(n) * n, n))
    kept = {name: column for name, column in made.items() if len(column.values) == length}
    check_size(length, len(kept))
    left = [name for name in made if name not in kept]
    notes = ((Message("record.note.other-length", names=left[:20], rows=length), 0),) if left else ()
    names = distinct([short for short in _short(list(kept))])
    shown = [Column(**{**vars(column), "name": name}) for name, column in zip(names, kept.values(), strict=True)]
    about = Message(f"record.dialect.{format}")
    return Table(tuple(shown), np.arange(1, length + 1), format, about, not unnamed >= set(kept), notes)


def _columns(name: str, array: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return an array as columns: a vector is one, a matrix has one for each of its columns."""
    if array.dtype.kind not in "biuf" or array.ndim == 0:
        return []
    if array.ndim > 2:
        array = array.reshape(array.shape[0], -1)
    if array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.ndim == 1:
        return [(name, array.astype(float))]
    if array.shape[1] > array.shape[0]:
        array = array.T
    check_size(*array.shape)
    return [(f"{name}_{k + 1}", array[:, k].astype(float)) for k in range(array.shape[1])]


def _short(names: list[str]) -> list[str]:
    """Return paths of names without the folders that all have in common."""
    while len(names) > 1 and all("." in name or "/" in name for name in names):
        heads = {min(name.partition(".")[0], name.partition("/")[0], key=len) for name in names}
        if len(heads) > 1:
            break
        cut = len(heads.pop()) + 1
        names = [name[cut:] for name in names]
    return names


def joined(parts: Sequence[tuple[np.ndarray, Mapping[str, np.ndarray]]], name: str) -> dict[str, np.ndarray]:
    """Return columns of several rates over all their times, NaN where a column has no sample.

    Args:
        parts: times in s (rows,) and the columns that are sampled at them.
        name: of the column of times.
    """
    total = sum(len(columns) for _, columns in parts) + 1
    every = np.unique(np.concatenate([times for times, _ in parts]))
    check_size(len(every), total)
    result = {name: every}
    for times, columns in parts:
        places = np.searchsorted(every, times)
        for column, values in columns.items():
            unique, number = column, 2
            while unique in result:
                unique, number = f"{column} ({number})", number + 1
            result[unique] = np.full(len(every), np.nan)
            result[unique][places] = values
    return result
