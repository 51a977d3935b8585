"""Tables of a study for people: a row for each point, a cell for each measure; as text, LaTeX, CSV or Parquet."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import polars as pl

from thetascope.studies.summary import SHARES, Rate, Spread, measures, rate_of, runs_of, spread_of, values_of
from thetascope_schemas.service.study.study import Study

_SHOWN = ("found.", "delay.", "size_error.", "rmse.")
"""Beginnings of the measures that a table shows if nobody chooses any, the most wanted first."""
_COLUMNS = 6


@dataclass(frozen=True)
class PointRow:
    """A point: its factors' values, how many runs are there, and a cell for each measure."""

    values: tuple[float | str, ...]
    runs: int
    cells: tuple[Spread | Rate, ...]


@dataclass(frozen=True)
class PointTable:
    """The table: names of factors and measures, and a row for each point."""

    factors: tuple[str, ...]
    measures: tuple[str, ...]
    rows: tuple[PointRow, ...]


def usual_measures(table: pl.DataFrame, study: Study) -> tuple[str, ...]:
    """Return the measures that are shown if nobody chooses any: of the detector, then of estimates of faults."""
    known = measures(table, study)
    detector = [name for start in _SHOWN[:3] for name in known if name.startswith(f"{start}detector.")]
    alarms = ["alarms.detector"] if "alarms.detector" in known and not all(study.modes) else []
    errors = [name for name in known if name.startswith("rmse.") and ".theta." in name]
    rest = [name for start in _SHOWN for name in known if name.startswith(start)]
    numbers = [name for name in known if name.startswith("number.")]
    return tuple(dict.fromkeys([*alarms, *numbers, *detector, *errors, *rest]))[:_COLUMNS]


def point_table(table: pl.DataFrame, study: Study, chosen: Sequence[str]) -> PointTable:
    """Return the table of all points.

    Of `alarms.…` it counts the runs without faults that had any; of columns of 0 and 1 it gives rates; of all others
    the median and the middle half of the runs.
    """
    factors = tuple(factor.column for factor in study.vary)
    if not len(table):
        return PointTable(factors, tuple(chosen), ())
    rows = []
    for _, group in table.group_by(["point"], maintain_order=True):
        values = tuple(group.get_column(name)[0] for name in factors)
        rows.append(PointRow(values, len(group), tuple(_cell(group, name) for name in chosen)))
    return PointTable(factors, tuple(chosen), tuple(rows))


def _cell(group: pl.DataFrame, measure: str) -> Spread | Rate:
    column = runs_of(group, measure).get_column(measure)
    if measure.startswith("alarms."):
        known = column.drop_nulls()
        return rate_of(int((known > 0).sum()), len(known))
    if measure.startswith(SHARES):
        known = column.drop_nulls()
        return rate_of(int(known.sum()), len(known))
    return spread_of(column)


def point_answers(table: pl.DataFrame, study: Study, chosen: Sequence[str]) -> list[dict[str, object]]:
    """Return the rows of `point_table` as plain data, with the values of the factors and the numbers to draw."""
    if not len(table):
        return []
    firsts = table.group_by("point", maintain_order=True).agg(pl.col("run").first()).rows()
    rows = point_table(table, study, chosen).rows
    return [
        {
            "point": point,
            "run": run,
            "runs": row.runs,
            "values": values_of(study, point),
            "cells": [cell_text(cell) for cell in row.cells],
            "numbers": [cell.share if isinstance(cell, Rate) else cell.median for cell in row.cells],
        }
        for (point, run), row in zip(firsts, rows, strict=True)
    ]


def cell_text(cell: Spread | Rate) -> str:
    """Return a cell as text: `12/20 (36–81 %)`, or `0.31 [0.28, 0.35]`."""
    if isinstance(cell, Rate):
        return f"{cell.count}/{cell.of} ({100 * cell.low:.3g}–{100 * cell.high:.3g} %)" if cell.of else "–"
    if cell.median is None:
        return "–"
    return f"{cell.median:.4g} [{cell.low:.3g}, {cell.high:.3g}]"


def value_text(value: float | str | None) -> str:
    """Return the value of a factor as text."""
    return "–" if value is None else value if isinstance(value, str) else f"{value:.6g}"


def latex(table: PointTable) -> str:
    """Return the table as LaTeX for the package booktabs."""
    head = [*table.factors, "runs", *table.measures]
    lines = [f"\\begin{{tabular}}{{{'l' * len(table.factors)}r{'c' * len(table.measures)}}}", "\\toprule"]
    lines += [" & ".join(_escaped(name) for name in head) + r" \\", r"\midrule"]
    for row in table.rows:
        cells = [*map(value_text, row.values), str(row.runs), *map(cell_text, row.cells)]
        lines.append(" & ".join(_escaped(cell) for cell in cells) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"]) + "\n"


_SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "–": "--"}


def _escaped(text: str) -> str:
    return "".join(_SPECIAL.get(char, f"\\{char}" if char in "&%$#_{}" else char) for char in text)


def csv_bytes(table: pl.DataFrame) -> bytes:
    """Return all runs as CSV: numbers in full, an empty cell where nothing was measured."""
    return table.write_csv().encode()


def parquet_bytes(table: pl.DataFrame) -> bytes:
    """Return all runs as a Parquet file."""
    buffer = io.BytesIO()
    table.write_parquet(buffer, compression="zstd")
    return buffer.getvalue()
