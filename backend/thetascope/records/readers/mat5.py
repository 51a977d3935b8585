"""Read MATLAB files up to version 7 with SciPy. Packed variables are unpacked here first, within limits."""

import io
import struct
import zlib
from typing import Any

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.readers.cells_of_values import column_of_values, table_of_arrays
from thetascope.records.readers.mat5_elements import Damaged, Unsupported, check_variable
from thetascope.records.table import MOST_BYTES, Column, Table, check_bytes

_HEAD = 128
_COMPRESSED, _MATRIX = 15, 14
_DEEPEST = 6
_FIELDS = 2000


def read_mat(name: str, data: bytes) -> Table:
    """Return the vectors and matrices of a file, also those within structures. Raises SpecError."""
    from scipy.io import loadmat

    if data.startswith(b"MATLAB 5.0"):
        data = plain(data)
    try:
        content = loadmat(io.BytesIO(data), struct_as_record=False, squeeze_me=True, mat_dtype=False)
    except (TypeError, ValueError) as error:
        raise _damaged(str(error)[:100]) from None
    arrays: dict[str, np.ndarray] = {}
    texts: dict[str, Column] = {}
    for variable, value in content.items():
        if not variable.startswith("__"):
            _collect(variable, value, arrays, texts, 0)
    _name_columns(arrays, content)
    return table_of_arrays(arrays, {}, "mat", texts)


def plain(data: bytes) -> bytes:
    """Return a file of version 5 without packed variables, and only with those that hold numbers or text.

    Raises SpecError for lengths that the file does not have.
    """
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        raise _damaged("no byte order")
    parts, place, size = [data[:_HEAD]], _HEAD, _HEAD
    while place + 8 <= len(data):
        kind, length = struct.unpack(f"{order}II", data[place : place + 8])
        if kind not in (_COMPRESSED, _MATRIX):
            raise _damaged(f"element of type {kind}")
        end = place + 8 + length
        if end > len(data):
            raise _damaged("the file ends early")
        content = data[place:end]
        if kind == _COMPRESSED:
            decoder = zlib.decompressobj()
            try:
                content = decoder.decompress(data[place + 8 : end], MOST_BYTES + 1 - size)
            except zlib.error as error:
                raise _damaged(str(error)) from None
        size += len(content)
        check_bytes(size)
        if len(content) < 8 or struct.unpack(f"{order}I", content[4:8])[0] > len(content):
            raise _damaged("the file ends early")
        place = end
        try:
            check_variable(content, order)
        except Damaged as error:
            raise _damaged(str(error)) from None
        except Unsupported:
            continue
        parts.append(content)
    return b"".join(parts)


def _damaged(detail: str) -> SpecError:
    return SpecError("file", None, Message("record.file.damaged", format="mat", detail=detail))


def _collect(path: str, value: Any, arrays: dict[str, np.ndarray], texts: dict[str, Column], depth: int) -> None:
    """Add the arrays in a variable by their path: fields of structures, elements of arrays of structures."""
    if len(arrays) > _FIELDS or depth > _DEEPEST:
        return
    fields = getattr(value, "_fieldnames", None)
    if fields:
        label = getattr(value, "label", None)
        for field in fields[:_FIELDS]:
            title = label.strip() if isinstance(label, str) and field == "values" else ""
            inner = title or f"{path}.{field}"
            _collect(inner, getattr(value, field), arrays, texts, depth + 1)
        return
    array = np.asarray(value)
    if array.dtype.kind in "biuf" and array.size > 1:
        arrays[path] = array
    elif array.dtype.kind == "U" and array.ndim == 1 and array.size > 1:
        texts[path] = column_of_values(path, [str(cell) for cell in array])
    elif array.dtype.kind == "O" and array.ndim == 1 and 0 < array.size <= 200:
        if all(isinstance(item, str) for item in array):
            texts[path] = column_of_values(path, list(array))
            return
        for k, item in enumerate(array):
            _collect(f"{path}({k + 1})", item, arrays, texts, depth + 1)


def _name_columns(arrays: dict[str, np.ndarray], content: dict[str, Any]) -> None:
    """Split the only matrix of a file by a list of names that has one for each of its columns."""
    lists = [
        [str(item) for item in np.ravel(value)]
        for value in content.values()
        if isinstance(value, np.ndarray) and value.size and all(isinstance(item, str) for item in np.ravel(value))
    ]
    for path, array in list(arrays.items()):
        names = next((n for n in lists if array.ndim == 2 and len(n) == array.shape[1] < array.shape[0]), None)
        if names:
            del arrays[path]
            arrays |= {name: array[:, k] for k, name in enumerate(names)}
