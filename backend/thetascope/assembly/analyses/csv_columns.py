"""Read columns of numbers from CSV text: every cell must be a number, because nothing is filled in here."""

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.columns.times import TimeChoice, seconds_of
from thetascope.records.table import Column, Table
from thetascope.records.text.csv_table import table_of_text
from thetascope_schemas.texts.names import normalised_path


def columns_of_csv(text: str) -> dict[str, np.ndarray]:
    """Return each column of numbers or times by its name; columns of words are passed over.

    Times become seconds from the first row on. Raises SpecError with the line that is not a row of numbers.
    """
    table = table_of_text(text.removeprefix("\ufeff"))
    names = [column.name for column in table.columns]
    if not table.named or any(f"{name} (2)" in names for name in names):
        raise SpecError("csv", ",".join(names)[:60], Message("record.csv.names"))
    columns = {}
    for column in table.columns:
        if column.kind == "datetime":
            values = seconds_of(table, TimeChoice(column.name, None, None, Message("record.reason.dates"))).t
        elif column.kind == "number" or column.count < len(table):
            values = column.values
            _check(column, table, text)
        else:
            continue
        columns[normalised_path(column.name)] = values
    return columns


def _check(column: Column, table: Table, text: str) -> None:
    """Raise SpecError for the first cell that is neither a number nor written as one that is not finite."""
    lines = text.splitlines()
    rows = [row for row, _ in column.words[:1]] or np.flatnonzero(np.isnan(column.values)).tolist()
    for row in rows:
        number = int(table.lines[row])
        line = lines[number - 1]
        if "nan" not in line.lower() or column.words:
            n = len(table.columns)
            raise SpecError("csv", line[:60], Message("record.csv.row", line=number, n=n, cells=n))
