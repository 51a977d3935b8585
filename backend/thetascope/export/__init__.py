"""Export results as CSV, JSON, MATLAB .mat or Parquet, in full or in part, and comparisons of observers as CSV."""

from thetascope.export.comparison_csv import comparison_csv
from thetascope.export.csv_format import csv_chunks
from thetascope.export.json_format import json_bytes, json_chunks
from thetascope.export.mat_format import matlab_bytes, matlab_names
from thetascope.export.parquet_format import parquet_bytes
from thetascope.export.selection import Table, indices, select

#: Format name → media type.
MEDIA_TYPES = {
    "csv": "text/csv; charset=utf-8",
    "json": "application/json",
    "mat": "application/x-matlab-data",
    "parquet": "application/vnd.apache.parquet",
}

__all__ = [
    "MEDIA_TYPES",
    "Table",
    "comparison_csv",
    "csv_chunks",
    "indices",
    "json_bytes",
    "json_chunks",
    "matlab_bytes",
    "matlab_names",
    "parquet_bytes",
    "select",
]
