"""Results as files: CSV, JSON and MATLAB .mat, whole or in part; the comparison of the observers as CSV."""

from backend.export.comparison import comparison_csv
from backend.export.csv import csv_chunks
from backend.export.json import json_bytes
from backend.export.matlab import matlab_bytes, matlab_names
from backend.export.table import Table, select

#: Format name → media type of what it writes.
MEDIA_TYPES = {"csv": "text/csv; charset=utf-8", "json": "application/json", "mat": "application/x-matlab-data"}

__all__ = ["MEDIA_TYPES", "Table", "comparison_csv", "csv_chunks", "json_bytes", "matlab_bytes", "matlab_names", "select"]
