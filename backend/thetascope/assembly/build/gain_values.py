"""Turn gains given as data into numbers of the declared shape, within bounds and with defaults filled in."""

from collections.abc import Mapping, Sequence
from typing import Any

from thetascope.engine.errors import SpecError
from thetascope.engine.observers.support.declaration import Context, Gain
from thetascope.engine.observers.support.draft import Size
from thetascope.messages import Message

Values = float | list[float] | list[list[float]]
"""A gain: a number, a column, or the rows of a matrix."""


def gain_values(gain: Gain, given: Any, context: Context) -> Values:
    """Return the numbers of a gain. A column may be given as rows of one number each, any gain as one number for all.

    Args:
        gain: the declaration.
        given: a number, a sequence of numbers or of rows; None for the default.
        context: the plant's sizes and names.

    Raises SpecError that names the rows of the gain where the shape is not the declared one.
    """
    value = given
    if given is None:  # some defaults are designed for the plant with SymPy: compute them only where needed
        value = gain.default(context) if callable(gain.default) else gain.default
    shape = gain.shape(context)
    if callable(gain.default) and _rows(given) not in (None, shape if isinstance(shape, int | None) else shape[0]):
        gain.default(context)  # raises the reason if the plant does not suit the observer
    values = _shaped(gain, value, shape, context, given is None)
    for number in _flat(values):
        if (problem := gain.bounds_problem(number)) is not None:
            raise SpecError(f"gains.{gain.name}", number, problem)
    return values


def parameters(name: str, values: Values) -> dict[str, float]:
    """Return a gain as the parameters of the program: ``g.name``, ``g.name.i`` or ``g.name.i.j``."""
    if not isinstance(values, list):
        return {f"g.{name}": values}
    numbers: dict[str, float] = {}
    for i, row in enumerate(values):
        if isinstance(row, list):
            numbers |= {f"g.{name}.{i}.{j}": v for j, v in enumerate(row)}
        else:
            numbers[f"g.{name}.{i}"] = row
    return numbers


def from_parameters(name: str, shape: Size, numbers: Mapping[str, float]) -> Values:
    """Return the gain whose parameters are in ``numbers``: the inverse of :func:`parameters`."""
    if shape is None:
        return numbers[f"g.{name}"]
    if isinstance(shape, int):
        return [numbers[f"g.{name}.{i}"] for i in range(shape)]
    return [[numbers[f"g.{name}.{i}.{j}"] for j in range(shape[1])] for i in range(shape[0])]


def size_of(values: Values) -> Size:
    """Return the size of a gain for a Draft."""
    if not isinstance(values, list):
        return None
    first = values[0] if values else None
    return (len(values), len(first)) if isinstance(first, list) else len(values)


def _rows(value: Any) -> int | None:
    return len(value) if isinstance(value, Sequence) else None


def _flat(values: Values) -> list[float]:
    if not isinstance(values, list):
        return [values]
    return [v for row in values for v in (row if isinstance(row, list) else [row])]


def _shaped(gain: Gain, value: Any, shape: Size, context: Context, is_default: bool) -> Values:
    field = f"gains.{gain.name}"
    if shape is None:
        if isinstance(value, Sequence):
            raise SpecError(field, list(value), Message("observer.gain.one-number"))
        return float(value)
    rows, columns = (shape, None) if isinstance(shape, int) else shape
    if not isinstance(value, Sequence):
        return [float(value)] * rows if columns is None else [[float(value)] * columns for _ in range(rows)]
    listed = list(value)
    if is_default and 0 < len(listed) < rows:
        listed += [listed[-1]] * (rows - len(listed))
    if len(listed) != rows and not (is_default and len(listed) > rows):
        names = gain.row_labels(context)
        problem = Message("observer.gain.length", given=len(listed), needed=rows, names=names)
        raise SpecError(field, listed, problem, None if columns is None else _matrix_remedy(gain, context))
    if columns is None:
        return [_entry(gain, row, i, context) for i, row in enumerate(listed[:rows])]
    return [_row(gain, row, i, columns, context) for i, row in enumerate(listed[:rows])]


def _entry(gain: Gain, value: Any, i: int, context: Context) -> float:
    """Return an entry of a column; it may be given as a row of one number."""
    if isinstance(value, Sequence):
        if len(value) != 1:
            problem = Message("observer.gain.row", row=gain.row_labels(context)[i], given=len(value), needed=1)
            raise SpecError(f"gains.{gain.name}.{i}", list(value), problem, Message("observer.gain.row.remedy.column"))
        return float(value[0])
    return float(value)


def _row(gain: Gain, value: Any, i: int, columns: int, context: Context) -> list[float]:
    given = len(value) if isinstance(value, Sequence) else 1
    if not isinstance(value, Sequence) or given != columns:
        problem = Message("observer.gain.row", row=gain.row_labels(context)[i], given=given, needed=columns)
        shown = list(value) if isinstance(value, Sequence) else value
        raise SpecError(f"gains.{gain.name}.{i}", shown, problem, _matrix_remedy(gain, context))
    return [float(v) for v in value]


def _matrix_remedy(gain: Gain, context: Context) -> Message:
    rows, columns = gain.row_labels(context), gain.column_labels(context)
    return Message("observer.gain.row.remedy", rows=rows, columns=columns, n=len(rows), each=len(columns))
