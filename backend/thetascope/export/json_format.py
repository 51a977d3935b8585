"""Write JSON: columns as plain arrays, or as base64 of little-endian float64 (`bdata`, which Plotly.js reads, too)."""

import base64

import numpy as np
import orjson

from thetascope.export.selection import Table


def json_bytes(table: Table, encoding: str = "plain") -> bytes:
    """Return `{"rows": n, "columns": {name: values}}`: numbers with null for nan, or `{"dtype": "f8", "bdata": …}`."""
    if encoding == "bdata":
        columns = {name: _typed(column) for name, column in zip(table.names, table.data, strict=True)}
    else:
        columns = {name: np.ascontiguousarray(column) for name, column in zip(table.names, table.data, strict=True)}
    return orjson.dumps({"rows": table.rows, "columns": columns}, option=orjson.OPT_SERIALIZE_NUMPY)


def _typed(column: np.ndarray) -> dict[str, str]:
    packed = np.ascontiguousarray(column, dtype="<f8")
    return {"dtype": "f8", "bdata": base64.b64encode(packed.data).decode("ascii")}
