"""Read workbooks (xlsx). Cells are read in rows, so that neither declared sizes nor far cells cost memory."""

import io
import os
from collections.abc import Iterator
from dataclasses import replace
from datetime import date, datetime, time, timedelta
from typing import Any

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.table import MOST_CELLS, Table, check_size
from thetascope.records.text.csv_table import table_of_text

_SHEETS = 50
_MOST_ROWS = 1_048_576  # of a sheet, in any program that writes them


def read_xlsx(name: str, data: bytes) -> Table:
    """Return the table of the sheet with the most filled rows. Raises SpecError with row, column and cell."""
    os.environ.setdefault("OPENPYXL_LXML", "False")  # the parser of the standard library loads nothing from elsewhere
    from openpyxl import load_workbook

    workbook = load_workbook(io.BytesIO(data), read_only=True, data_only=True, keep_links=False)
    best: tuple[int, str, list[str]] = (0, "", [])
    for sheet in workbook.worksheets[:_SHEETS]:
        sheet.reset_dimensions()
        lines = list(_lines(sheet.iter_rows(values_only=True)))
        filled = sum(1 for line in lines if line.strip())
        if filled > best[0]:
            best = (filled, sheet.title, lines)
    if not best[0]:
        raise SpecError("file", None, Message("record.file.empty"))
    table = table_of_text("\n".join(best[2]), separator="\t")
    others = [sheet.title for sheet in workbook.worksheets if sheet.title != best[1]]
    notes = ((Message("record.note.other-sheets", sheet=best[1], names=others[:20]), 0),) if others else ()
    return replace(
        table, format="xlsx", dialect=Message("record.dialect.xlsx", sheet=best[1]), notes=notes + table.notes
    )


def _lines(rows: Iterator[tuple[Any, ...]]) -> list[str]:
    """Return rows as lines of text, cells apart by tabs, all of the same width; empty rows are empty lines."""
    texts: list[tuple[int, list[str]]] = []
    width = cells = 0
    for number, row in enumerate(rows):
        cells += len(row)
        if number >= _MOST_ROWS or cells > MOST_CELLS:  # far rows and cells cost nothing in the file, but here
            raise SpecError(
                "file", number, Message("record.rows.over-limit", rows=number + 1, limit=min(number, _MOST_ROWS))
            )
        filled = [_text(cell) for cell in row]
        while filled and not filled[-1]:
            filled.pop()
        if filled:
            texts.append((number, filled))
            width = max(width, len(filled))
    check_size(len(texts), width)
    lines = [""] * (texts[-1][0] + 1 if texts else 0)
    for number, row in texts:
        lines[number] = "\t".join(row) + "\t" * (width - len(row))
    return lines


def _text(cell: Any) -> str:
    """Return a cell as text from which the same value is read."""
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, int | float):
        return repr(cell)
    if isinstance(cell, datetime):
        return cell.isoformat()
    if isinstance(cell, date | time):
        return cell.isoformat()
    if isinstance(cell, timedelta):
        return str(cell)
    return " ".join(str(cell).split())
