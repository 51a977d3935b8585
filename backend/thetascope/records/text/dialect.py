"""Find how a text table is written: separator, decimal sign, names, units, and the line where the data begin."""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from thetascope.records.text.cells import (
    Decimal,
    clean,
    decimal_evidence,
    is_missing,
    is_time,
    number,
    switch,
    with_unit,
)

Separator = Literal[",", ";", "\t", "|", " "]

SEPARATORS: tuple[Separator, ...] = (",", ";", "\t", "|", " ")
COMMENTS = ("#", "%", "//", "!", '"#')
_SAMPLE = 400  # lines from the beginning of the file by which its dialect is found,
_LATER = 200  # and lines from the rest of it
_WIDER = (r"\s+(?![\[(])", r"\s{2,}|\t", r"\s*[,;|\t]\s*")
_REMARKS = ("", "comment", "comments", "remark", "remarks", "note")  # heads of columns that rows may leave out
_FEW = 0.5  # share of cells above which a column is of a kind
_UNIT = re.compile(
    r"[\[(].{0,23}[\])]|-|%|(?=.*[°²³µμΩ℃/^*·])(?:1/)?[^\d,;][^,;]{0,20}"
    r"|[kmMucn]?(?:s|m|g|V|A|W|Pa|N|l|L|Hz|J|bar|Ohm|mol)"
    r"|sec|min|h|hr|d|TS|RN|K|C|F|deg ?[CFK]?|Deg C|cm[23]|psi|rpm|pct|lpm|gpm|rad|Nm|inch|ft|ppm|pH"
    r"|秒|分|分钟|小时|毫秒|米|厘米|毫米|摄氏度|帕|千帕|伏|安|瓦|升|转"
)


@dataclass(frozen=True)
class Dialect:
    """How a text table is written.

    Attributes:
        separator: between cells; a blank: any number of blanks.
        width: cells in a row.
        decimal: the decimal sign.
        names: of the columns, or None where the file has none.
        units: of the columns, from a line below the names; an empty text for none.
        first: place of the first line of data among the lines given.
        trailing: whether every row ends with a separator after which nothing follows.
    """

    separator: Separator
    width: int
    decimal: Decimal
    names: tuple[str, ...] | None
    units: tuple[str, ...]
    first: int
    trailing: bool = False


def split(line: str, separator: Separator) -> list[str]:
    """Return the cells of a line."""
    if '"' in line:
        if separator == " ":
            return next(csv.reader([" ".join(line.split())], delimiter=" "), [])
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    return line.split() if separator == " " else line.split(separator)


def is_comment(line: str) -> bool:
    """Return whether a line is a comment."""
    return line.startswith(COMMENTS)


def dialect_of(lines: Sequence[str], comments: Sequence[str] = (), separator: Separator | None = None) -> Dialect:
    """Return the dialect of a table.

    Args:
        lines: all lines of the file that are neither empty nor comments.
        comments: the comments before the first of them, of which the last may hold the names.
        separator: if it is known.
    """
    sample = lines[:_SAMPLE]
    rest = lines[_SAMPLE :: max(1, (len(lines) - _SAMPLE) // _LATER)] if len(lines) > _SAMPLE else ()
    declared = re.fullmatch(r"sep=(.)", sample[0].strip()) if sample else None
    skip = 1 if declared else 0
    separator, width = _separator([*sample[skip:], *rest], declared[1] if declared else separator)
    rows = [split(line, separator) for line in sample]
    later = [split(line, separator) for line in rest]
    body = [row for row in [*rows[len(rows) // 4 :], *later] if len(row) == width] or rows
    decimal = _decimal(body, separator)
    kinds = _kinds(body, width, decimal)
    first = _first_row(rows, skip, width, kinds, decimal)
    trailing = width > 1 and all(not row[-1].strip() for row in body)
    heads = [sample[k] for k in range(skip, first)]
    names, units = _head(heads, separator, width, trailing)
    if names is None and comments:
        names, _ = _head([comments[-1].lstrip('#%/!" ')], separator, width, trailing)
    return Dialect(separator, width, decimal, names, units, first, trailing)


def _separator(lines: Sequence[str], declared: str | None) -> tuple[Separator, int]:
    """Return the separator that gives rows of equal length with the most numbers, and that length."""
    best: tuple[float, Separator, int] = (0.0, ",", 1)
    body = lines[len(lines) // 8 :] or lines
    for separator in SEPARATORS:
        if declared is not None and separator != declared:
            continue
        rows = [split(line, separator) for line in body]
        widths = Counter(len(row) for row in rows if len(row) > 1)
        if not widths:
            continue
        width, count = max(widths.items(), key=lambda item: (item[1], item[0]))
        alike = [row for row in rows if len(row) == width]
        cells = [clean(cell) for row in alike[:100] for cell in row]
        good = sum(1 for cell in cells if is_missing(cell) or _is_value(cell)) / len(cells)
        score = round(count / len(rows) * (0.05 + good), 3)
        if score > best[0]:
            best = (score, separator, width)
    return best[1], best[2]


def _is_value(cell: str) -> bool:
    return number(cell, ".") is not None or is_time(cell)


def _decimal(rows: Sequence[Sequence[str]], separator: Separator) -> Decimal:
    """Return the decimal sign that most cells prove; a comma where it separates no cells and numbers have one."""
    seen: Counter[str] = Counter(decimal_evidence(clean(cell)) for row in rows for cell in row)
    if seen[","] != seen["."]:
        return "," if seen[","] > seen["."] else "."
    commas = separator != "," and any("," in cell for row in rows for cell in row if _is_value(clean(cell)))
    return "," if commas and not seen["."] else "."


def _kind(cell: str, decimal: Decimal) -> str:
    """Return n for a number, d for a time, e for nothing, t for another text."""
    if is_missing(cell):
        return "e"
    if number(cell, decimal) is not None:
        return "n"
    if is_time(cell):
        return "d"
    return "n" if switch(cell) is not None or with_unit(cell, decimal) else "t"


def _kinds(rows: Sequence[Sequence[str]], width: int, decimal: Decimal) -> str:
    """Return the usual kind of the cells of each column as one letter."""
    result = ""
    for place in range(width):
        seen = Counter(_kind(clean(row[place]), decimal) for row in rows if len(row) > place)
        full = sum(seen.values()) - seen["e"]
        usual = max("ndt", key=lambda kind: seen[kind])
        result += usual if full and seen[usual] >= _FEW * full else "t" if full else "e"
    return result


def _first_row(rows: Sequence[Sequence[str]], skip: int, width: int, kinds: str, decimal: Decimal) -> int:
    """Return the place of the first row of data: it has values where the column has values, and so have the next."""
    valued = [place for place, kind in enumerate(kinds) if kind in "nd"]
    if not valued:
        return min(skip + 1, len(rows))

    def is_data(row: Sequence[str]) -> bool:
        if len(row) != width:
            return False
        own = [_kind(clean(row[place]), decimal) for place in valued]
        return sum(kind == kinds[place] for kind, place in zip(own, valued, strict=True)) > own.count("t")

    headless = True  # so far no line is as wide as the data: the first one that has a word holds the names
    for index in range(skip, len(rows)):
        if len(rows[index]) == width and headless:
            headless = False
            if any(
                clean(rows[index][place]).isalpha() and _kind(clean(rows[index][place]), decimal) == "t"
                for place in valued
            ):
                continue
        following = rows[index + 1 : index + 4]
        if is_data(rows[index]) and 2 * sum(map(is_data, following)) >= len(following):
            return index
    return len(rows)


def _head(
    lines: Sequence[str], separator: Separator, width: int, trailing: bool
) -> tuple[tuple[str, ...] | None, tuple[str, ...]]:
    """Return the names and units in the lines above the data."""
    fitting = [row for line in lines if (row := _fitted(split(line, separator), width, trailing)) is not None]
    if not fitting and separator == " ":  # names may have blanks in them
        parts = [re.split(pattern, line.strip()) for line in lines for pattern in _WIDER]
        fitting = [row for part in parts if (row := _fitted(part, width, trailing)) is not None]
    if not fitting:
        return None, ("",) * width
    filled = [sum(map(bool, row)) for row in fitting]
    full = [k for k, count in enumerate(filled) if count == max(filled)]
    names = full[-1]  # a remark above may happen to have as many parts
    units = next((k for k in range(names + 1, len(fitting)) if _are_units(fitting[k])), None)
    if len(full) > 1 and _are_units(fitting[names]):
        names, units = full[-2], names
    if units is None:
        return tuple(fitting[names]), ("",) * width
    return tuple(fitting[names]), tuple(c.strip("[]() ") if c not in ("-", "[-]") else "" for c in fitting[units])


def _are_units(row: Sequence[str]) -> bool:
    """Return whether the cells of a line are units: at least half of those that are not empty are well known."""
    cells = [cell for cell in row if cell]
    return len(cells) > 0 and 2 * sum(1 for cell in cells if _UNIT.fullmatch(cell)) >= len(cells)


def _fitted(cells: Sequence[str], width: int, trailing: bool) -> list[str] | None:
    """Return the cells of a head as a row of the data's width, or None if they do not fit."""
    row = [clean(cell) for cell in cells]
    if len(row) == width - 1:
        row = [*row, ""] if trailing else ["", *row]
    if len(row) == width + 1 and row[-1].lower() in _REMARKS:
        row = row[:-1]
    return row if len(row) == width and any(row) else None
