"""Export results as CSV, JSON, MATLAB .mat, Parquet or a notebook, and comparisons of observers as CSV."""

from thetascope.export.comparison_csv import comparison_csv
from thetascope.export.csv_format import csv_chunks
from thetascope.export.json_format import json_bytes, json_chunks
from thetascope.export.mat_format import matlab_bytes, matlab_names
from thetascope.export.notebook import notebook_bytes
from thetascope.export.parquet_format import parquet_bytes
from thetascope.export.selection import Table, indices, select

#: Format name → media type.
MEDIA_TYPES = {
    "csv": "text/csv; charset=utf-8",
    "json": "application/json",
    "mat": "application/x-matlab-data",
    "parquet": "application/vnd.apache.parquet",
    "ipynb": "application/x-ipynb+json",
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
    "notebook_bytes",
    "parquet_bytes",
    "select",
]
