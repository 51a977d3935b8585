"""Read a text table: CSV in any dialect."""

import csv
import io
import re
from collections.abc import Iterable, Iterator

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.table import Table, check_size, distinct
from thetascope.records.text.column_values import Cells, column_of
from thetascope.records.text.decoding import decoded
from thetascope.records.text.dialect import Dialect, Separator, dialect_of, is_comment, split

_BLOCK = 50_000  # lines that are split at a time
_LONGEST = 100_000  # characters of one line
_HEAD = 200  # lines that are looked at one by one in any case
_SPECIAL = re.compile(r"\n(?:[ ,;\t|]*(?:\n|\Z)|#|%|//|!|\"#)")  # empty lines and comments
_SHOWN = {",": "comma", ";": "semicolon", "\t": "tab", "|": "pipe", " ": "blank"}


def read_csv(name: str, data: bytes) -> Table:
    """Return the table of a text file. Raises SpecError with the line, column and cell."""
    text, encoding = decoded(data)
    return table_of_text(text, encoding)


def table_of_text(text: str, encoding: str = "UTF-8", separator: Separator | None = None) -> Table:
    """Return the table in a text, with a separator that is known or found. Raises SpecError with line and cell."""
    lines, numbers, comments = _lines(text)
    if not lines:
        raise SpecError("file", None, Message("record.file.empty"))
    dialect = dialect_of(lines, comments, separator)
    names = distinct([*(dialect.names or [""] * dialect.width)])
    width = dialect.width - dialect.trailing
    check_size(len(lines) - dialect.first, width)
    columns, kept, notes = _columns(lines, numbers, dialect, names)
    if not kept:
        raise SpecError("file", None, Message("record.file.no-rows"))
    shown = Message(f"record.separator.{_SHOWN[dialect.separator]}")
    code = "record.dialect.csv-decimal-comma" if dialect.decimal == "," else "record.dialect.csv"
    about = Message(code, separator=shown, encoding=encoding)
    made = [column_of(names[k], cells, dialect.units[k]) for k, cells in enumerate(columns[:width])]
    return Table(tuple(made), np.array(kept), "csv", about, dialect.names is not None, tuple(notes))


def _lines(text: str) -> tuple[list[str], list[int], list[str]]:
    """Return the lines with content, their numbers from 1 on, and the comments before the first of them."""
    if '"' in text and text.count('"') % 2 == 0:
        text = _joined(text)
    comments: list[str] = []
    lines: list[str] = []
    numbers: list[int] = []
    head = text.split("\n", _HEAD)
    rest = head.pop().rstrip("\n") if len(head) > _HEAD else ""
    plain = bool(rest) and _SPECIAL.search(rest) is None and not _SPECIAL.match("\n" + rest)
    for number, line in enumerate(head if plain else text.split("\n"), 1):
        if not line.strip(" ,;\t|"):
            continue
        if is_comment(line):
            if not lines:
                comments.append(line)
            continue
        lines.append(line)
        numbers.append(number)
    if plain:
        body = rest.split("\n")
        lines += body
        numbers += range(_HEAD + 1, _HEAD + 1 + len(body))
    for number, line in zip(numbers, lines, strict=True):
        if len(line) > _LONGEST:
            raise SpecError("file", line[:60], Message("record.file.long-line", line=number, limit=_LONGEST))
    return lines, numbers, comments


def _joined(text: str) -> str:
    """Return a text in which line breaks within quotes are blanks, if there are any."""
    parts = text.split('"')
    if not any("\n" in part for part in parts[1::2]):
        return text
    parts[1::2] = [part.replace("\n", " ") for part in parts[1::2]]
    return '"'.join(parts)


def _columns(
    lines: list[str], numbers: list[int], dialect: Dialect, names: list[str]
) -> tuple[list[Cells], list[int], list[tuple[Message, int]]]:
    """Return the cells of each column, the numbers of the rows, and notes."""
    columns = [Cells(dialect.decimal) for _ in names]
    kept: list[int] = []
    notes: list[tuple[Message, int]] = []
    head = set(lines[: dialect.first])
    last = len(lines) - 1
    for begin in range(dialect.first, len(lines), _BLOCK):
        block, places = lines[begin : begin + _BLOCK], numbers[begin : begin + _BLOCK]
        if head and not head.isdisjoint(block):
            notes += [(Message("record.note.repeated-head"), places[k]) for k, line in enumerate(block) if line in head]
            places = [places[k] for k, line in enumerate(block) if line not in head]
            block = [line for line in block if line not in head]
        if begin + _BLOCK > last and block and len(block) + len(kept) > 1 and _is_cut(block[-1], dialect):
            notes.append((Message("record.note.cut-off"), places[-1]))
            block, places = block[:-1], places[:-1]
        for column, cells in zip(columns, _cells(block, places, dialect), strict=True):
            column.add(cells)
        kept += places
    return columns, kept, notes


def _is_cut(line: str, dialect: Dialect) -> bool:
    """Return whether the last line of a file has fewer cells, as where a logger was switched off."""
    return len(split(line, dialect.separator)) < dialect.width - dialect.trailing


def _cells(block: list[str], places: list[int], dialect: Dialect) -> Iterable[list[str]]:
    """Return the cells of lines, column by column. Raises SpecError for a line with another number of cells."""
    width, separator = dialect.width, dialect.separator
    if separator != " " and not any('"' in line for line in block):
        if all(line.count(separator) == width - 1 for line in block):
            flat = separator.join(block).split(separator) if block else []
            return [flat[place::width] for place in range(width)]
        rows: Iterator[list[str]] = (line.split(separator) for line in block)
    elif separator == " ":
        rows = (split(line, separator) for line in block)
    else:
        rows = csv.reader(io.StringIO("\n".join(block)), delimiter=separator, skipinitialspace=True)
    complete = []
    try:
        for place, line, row in zip(places, block, rows, strict=True):
            complete.append(row if len(row) == width else _repaired(row, line, place, dialect))
    except csv.Error as error:
        raise SpecError("csv", None, Message("record.csv.invalid", detail=str(error))) from None
    return [list(column) for column in zip(*complete, strict=True)] if complete else [[] for _ in range(width)]


def _repaired(row: list[str], line: str, place: int, dialect: Dialect) -> list[str]:
    """Return a row without the separator at its end, or with one. Raises SpecError for other lengths."""
    width = dialect.width
    if dialect.trailing and len(row) == width - 1:
        return [*row, ""]
    while len(row) > width and not row[-1].strip():
        row = row[:-1]
    if len(row) != width:
        n = width - dialect.trailing
        raise SpecError("csv", line[:60], Message("record.csv.row", line=place, n=n, cells=len(row)))
    return row
