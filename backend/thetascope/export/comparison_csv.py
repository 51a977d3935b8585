"""Write the comparison of a run's observers as CSV with one measure per line, easy to filter and pivot."""

import csv
import io
from collections.abc import Iterator

from thetascope.export.csv_format import as_text
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.comparison import Comparison, ComparisonRow, Window

HEAD = ("observer", "measure", "of", "from", "until", "value", "unit")
_COUNTS = ("found", "covered", "missed", "false_alarms", "isolation_errors")
Line = tuple[object, ...]


def comparison_csv(comparison: Comparison, plant: Plant) -> bytes:
    """Return all measures of all observers.

    Columns: observer; measure (rmse, peak, settling-10, settling-5, delay, fault-found, fault-covered or fault-missed,
    and the counts found, covered, missed, false-alarms, isolation-errors; cost); of (column, channel or output); from
    and until in s (until is empty for the end of the run); value; unit. Missing values are `nan`. The cost is measured,
    so it differs each time; all other values are reproducible.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEAD)
    units = {f"x.{s.name}": s.unit for s in plant.states} | {f"theta.{c.name}": c.unit for c in plant.channels}
    for row in comparison.observers:
        writer.writerows(
            (_written(row.label), *(_written(cell) for cell in line)) for line in _lines(row, comparison.windows, units)
        )
    return text.getvalue().encode()


def _lines(row: ComparisonRow, windows: tuple[Window, ...], units: dict[str, str]) -> Iterator[Line]:
    for measure, columns in (("rmse", row.rmse), ("peak", row.peak)):
        for column, values in columns.items():
            for window, value in zip(windows, values, strict=True):
                yield measure, column, window.start, window.end, _missing(value), units.get(column, "")
    for step in row.steps:
        for measure, value in (("settling-10", step.ten), ("settling-5", step.five)):
            yield measure, f"theta.{step.channel}", step.at, None, _missing(value), "s"
    for fault in row.faults or ():
        place = f"{'theta' if fault.kind == 'channel' else 'y'}.{fault.name}"
        yield "delay", place, fault.onset, fault.until, _missing(fault.delay), "s"
        yield f"fault-{fault.outcome}", place, fault.onset, fault.until, 1, ""
    for count in _COUNTS:
        yield count.replace("_", "-"), "", None, None, _missing(getattr(row, count)), ""
    yield "cost", "", None, None, _missing(row.cost), "us/s"


def _missing(value: float | None) -> float:
    return float("nan") if value is None else value


def _written(cell: object) -> object:
    """Return whole floats without `.0`, other floats as the shortest text that reads back exactly, text as text."""
    if isinstance(cell, float) and cell.is_integer() and abs(cell) < 1e15:
        return int(cell)
    return as_text(cell) if isinstance(cell, str) else "" if cell is None else cell
