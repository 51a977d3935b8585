"""Read JSON: lines of objects, lists of rows, and columns by name."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import orjson

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.readers.cells_of_values import column_of_values
from thetascope.records.table import Table, check_size, distinct
from thetascope.records.text.decoding import decoded

_DEEPEST = 4  # objects within objects whose fields become columns
_ROWS = ("data", "rows", "records", "values", "samples", "measurements", "items")
_COLUMNS = ("columns", "data")


def read_json(name: str, data: bytes) -> Table:
    """Return the table of a JSON file. Raises SpecError with the line of an error."""
    text, _ = decoded(data)
    try:
        content = orjson.loads(text)
    except orjson.JSONDecodeError as error:
        rows = _lines(text, error)
        return _of_rows(*rows, "jsonl")
    if isinstance(content, Mapping):
        head = content.get("columns")
        rows = next((content[field] for field in _ROWS if isinstance(content.get(field), list)), None)
        if rows is not None and _is_names(head):
            content = [head, *rows]
        elif (table := _of_columns(content)) is not None:
            return table
        else:
            content = [content] if rows is None else rows
    if not isinstance(content, list) or not content:
        raise SpecError("file", None, Message("record.file.no-columns"))
    return _of_rows(content, list(range(1, len(content) + 1)), "json")


def _lines(text: str, error: orjson.JSONDecodeError) -> tuple[list[Any], list[int]]:
    """Return the values of JSON lines and their line numbers; a last line that is cut off is left out."""
    rows: list[Any] = []
    numbers: list[int] = []
    lines = [(k, line) for k, line in enumerate(text.split("\n"), 1) if line.strip()]
    for number, line in lines:
        try:
            rows.append(orjson.loads(line))
        except orjson.JSONDecodeError as wrong:
            if number == lines[-1][0] and len(rows) > 1:
                break
            first = error if number == lines[0][0] else wrong
            problem = Message("record.json.invalid", line=number, detail=first.msg)
            raise SpecError("file", line[:60], problem) from None
        numbers.append(number)
    return rows, numbers


def _is_names(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, str) for item in value)


def _of_columns(content: Mapping[str, Any]) -> Table | None:
    """Return columns by name, or None for another object: lists, or objects of values by row as pandas writes them."""
    for inner in (content, *(content.get(field) for field in _COLUMNS)):
        if not isinstance(inner, Mapping) or not inner:
            continue
        if all(
            isinstance(v, Mapping) and not any(isinstance(x, list | dict) for x in v.values()) for v in inner.values()
        ):
            lists = {key: list(column.values()) for key, column in inner.items()}
        else:
            lists = {key: column for key, column in inner.items() if _is_list(column)}
        rows = {len(column) for column in lists.values()}
        if not lists or max(rows) < 2:
            continue
        if len(rows) > 1:
            name = next(n for n, column in lists.items() if len(column) < max(rows))
            problem = Message("record.columns.uneven", rows=max(rows))
            raise SpecError(f"columns.{name}", len(lists[name]), problem)
        return _table(list(lists), list(lists.values()), list(range(1, max(rows) + 1)), "json")
    return None


def _is_list(value: object) -> bool:
    return isinstance(value, list) and not any(isinstance(item, list | dict) for item in value)


def _of_rows(rows: Sequence[Any], numbers: list[int], format: str) -> Table:
    """Return the table of rows: objects, or lists with the names in the first."""
    if all(isinstance(row, Mapping) for row in rows):
        flat = [_flat(row) for row in rows]
        names = list(dict.fromkeys(name for row in flat for name in row))
        check_size(len(rows), len(names))
        return _table(names, [[row.get(name) for row in flat] for name in names], numbers, format)
    width = len(rows[0]) if isinstance(rows[0], list) else 0
    head = rows[0] if _is_names(rows[0]) else None
    body, numbers = (rows[1:], numbers[1:]) if head else (rows, numbers)
    check_size(len(body), width)
    for number, row in zip(numbers, body, strict=True):
        if not _is_list(row) or len(row) != width:
            cells = len(row) if isinstance(row, list) else 1
            raise SpecError("file", str(row)[:60], Message("record.csv.row", line=number, n=width, cells=cells))
    if not body or not width:
        raise SpecError("file", None, Message("record.file.no-rows"))
    columns = [list(column) for column in zip(*body, strict=True)]
    return _table(head or [""] * width, columns, numbers, format, named=head is not None)


def _flat(row: Mapping[str, Any], prefix: str = "", depth: int = 0) -> dict[str, Any]:
    """Return the fields of an object, those of objects within it by their path."""
    result: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, Mapping) and depth < _DEEPEST:
            result |= _flat(value, f"{prefix}{name}.", depth + 1)
        else:
            result[prefix + name] = None if isinstance(value, list | Mapping) else value
    return result


def _table(
    names: Sequence[str], columns: Sequence[Sequence[Any]], numbers: list[int], format: str, named: bool = True
) -> Table:
    check_size(len(numbers), len(names))
    shown = distinct([str(name) for name in names])
    made = [column_of_values(name, cells) for name, cells in zip(shown, columns, strict=True)]
    return Table(tuple(made), np.array(numbers), format, Message(f"record.dialect.{format}"), named)
