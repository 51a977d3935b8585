"""Write CSV: a header, then one line per row; every number is the shortest text that reads back to the same float64."""

import csv
import io
from collections.abc import Iterator

import numpy as np
import orjson

from thetascope.export.selection import Table

_BLOCK = 8192
"""Values in a piece. Python's lock is held while one is made, for a millisecond, so others are answered between two."""
_FORMULA = ("=", "+", "-", "@", "＝", "＋", "－", "＠")  # spreadsheets also accept the full-width forms
_CONTROL = {code: " " for code in (*range(32), *range(127, 160), 0x2028, 0x2029)}


def csv_chunks(table: Table) -> Iterator[bytes]:
    """Yield the file in pieces: the header, then blocks of rows. Missing values (after a divergence) are `nan`."""
    yield _header(table.names)
    rows = max(1, _BLOCK // max(1, len(table.names)))
    for start in range(0, table.rows, rows):
        yield _rows(np.ascontiguousarray(table.data[:, start : start + rows].T))


def as_text(cell: str) -> str:
    """Return text that no spreadsheet takes for a formula: an apostrophe precedes it where it would begin one.

    Control characters, line ends among them, become spaces.
    """
    line = cell.translate(_CONTROL)
    return f"'{line}" if line.lstrip().startswith(_FORMULA) else line


def _header(names: tuple[str, ...]) -> bytes:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(as_text(name) for name in names)
    return line.getvalue().encode()


def _rows(block: np.ndarray) -> bytes:
    """Return the lines of a C-contiguous (rows, columns) block.

    orjson formats an array ten times faster than Python's repr and as exactly; its brackets are removed afterwards.
    JSON has no nan or infinity (orjson writes null for both), so blocks with an infinity are formatted with repr.
    """
    if np.isinf(block).any():
        return b"".join(b",".join(repr(number).encode() for number in row) + b"\n" for row in block.tolist())
    text = orjson.dumps(block, option=orjson.OPT_SERIALIZE_NUMPY)
    return text[2:-2].replace(b"],[", b"\n").replace(b"null", b"nan") + b"\n"
