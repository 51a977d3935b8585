"""Read Parquet and Arrow (Feather version 2) files with polars."""

import io
import os
from typing import Any

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.readers.cells_of_values import column_of_values
from thetascope.records.table import Column, Table, check_size, date_column, distinct, number_column
from thetascope.records.text.moments import NONE

_THREADS = "2"


def read_parquet(name: str, data: bytes) -> Table:
    """Return the table of a Parquet file. Its rows are counted from its metadata first."""
    polars = _polars()
    source = polars.scan_parquet(io.BytesIO(data), hive_partitioning=False)
    return _table(source, "parquet")


def read_arrow(name: str, data: bytes) -> Table:
    """Return the table of an Arrow file or stream."""
    polars = _polars()
    if data.startswith(b"ARROW1"):
        return _table(polars.scan_ipc(io.BytesIO(data)), "arrow")
    return _table(polars.read_ipc_stream(io.BytesIO(data)).lazy(), "arrow")


def _polars() -> Any:
    os.environ.setdefault("POLARS_MAX_THREADS", _THREADS)
    import polars

    return polars


def _table(source: Any, format: str) -> Table:
    polars = _polars()
    schema = source.collect_schema()
    rows = int(source.select(polars.len()).collect().item())
    check_size(rows, len(schema))
    if not len(schema) or not rows:
        raise SpecError("file", None, Message("record.file.no-rows"))
    frame = source.collect()
    names = distinct(list(schema.names()))
    columns = [_column(name, frame[own]) for name, own in zip(names, schema.names(), strict=True)]
    return Table(tuple(columns), np.arange(1, rows + 1), format, Message(f"record.dialect.{format}"))


def _column(name: str, series: Any) -> Column:
    """Return a column of numbers, dates, texts, or without values for lists and the like."""
    polars = _polars()
    kind = series.dtype
    if kind.is_numeric() or kind == polars.Boolean:
        return number_column(name, series.cast(polars.Float64).fill_null(float("nan")).to_numpy())
    if kind in (polars.Datetime, polars.Date):
        series = series.cast(polars.Datetime("ns")) if kind == polars.Date else series.dt.cast_time_unit("ns")
        return date_column(name, _ticks(series))
    if kind == polars.Time:
        times = _ticks(series)
        return Column(name, "datetime", times, first=tuple(str(v) for v in series[:3]), epoch="clock")
    if kind == polars.Duration:
        numbers = series.dt.cast_time_unit("ns").to_physical().cast(polars.Float64).fill_null(float("nan"))
        return number_column(name, numbers.to_numpy() / 1e9, "s")
    if kind in (polars.String, polars.Categorical, polars.Enum):
        return column_of_values(name, series.cast(polars.String).to_list())
    return Column(name, "text", np.full(len(series), np.nan))


def _ticks(series: Any) -> np.ndarray:
    polars = _polars()
    return series.to_physical().cast(polars.Int64).fill_null(int(NONE)).to_numpy()
