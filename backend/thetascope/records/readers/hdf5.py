"""Read HDF5 and MATLAB 7.3 files with h5py. Links and data outside of the file are never followed."""

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.readers.cells_of_values import column_of_values, table_of_arrays
from thetascope.records.table import MOST_BYTES, Column, Table, check_bytes, check_size

_OBJECTS = 5000
_DEEPEST = 8
_HIDDEN = ("#refs#", "#subsystem#")
_UNITS = ("unit", "units", "Unit", "Units", "UNIT", "UNITS")
_LONGEST = 1000  # bytes of one text


def read_hdf5(name: str, data: bytes) -> Table:
    """Return the columns of an HDF5 file: vectors, matrices, tables, and frames as pandas stores them.

    Declared shapes are checked before anything is read. Raises SpecError.
    """
    import h5py

    arrays: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    texts: dict[str, Column] = {}
    matlab = data[:128].startswith(b"MATLAB 7.3")
    read = 0
    with h5py.File(io.BytesIO(data), "r") as file:
        frames = dict(_frames(file))
        for path, dataset in _datasets(file):
            if any(path.startswith(frame) for frame in frames):
                continue
            read += _size(dataset)
            check_bytes(read)
            _read(path, dataset, matlab, arrays, texts)
            unit = next((_decoded(dataset.attrs[k]) for k in _UNITS if k in dataset.attrs), "")
            units |= dict.fromkeys(_parts(path, dataset), unit) if unit else {}
        for path, frame in frames.items():
            arrays |= _frame(path, frame)
    return table_of_arrays(arrays, units, "mat" if matlab else "hdf5", texts)


def _parts(path: str, dataset: Any) -> list[str]:
    return [path, *(f"{path}_{k + 1}" for k in range(min(dataset.shape[-1] if dataset.ndim == 2 else 0, 200)))]


def _datasets(file: Any) -> Iterator[tuple[str, Any]]:
    """Yield the datasets of a file by their path, without links to elsewhere. Raises SpecError for data elsewhere."""
    import h5py

    count, visited = 0, set()
    stack = [("", file, 0)]
    while stack:
        path, group, depth = stack.pop()
        for name in group:
            count += 1
            if count > _OBJECTS:
                raise SpecError("file", count, Message("record.file.too-many-objects", limit=_OBJECTS))
            link = group.get(name, getlink=True)
            if name in _HIDDEN or not isinstance(link, h5py.HardLink):
                continue
            item = group[name]
            key = hash(item.id)  # equal for links to the same object
            if key in visited:
                continue
            visited.add(key)
            inner = f"{path}/{name}" if path else name
            if isinstance(item, h5py.Group) and depth < _DEEPEST:
                stack.append((inner, item, depth + 1))
            elif isinstance(item, h5py.Dataset):
                if item.is_virtual or item.id.get_create_plist().get_external_count():
                    raise SpecError("file", inner[:60], Message("record.file.external", name=inner[:60]))
                yield inner, item


def _size(dataset: Any) -> int:
    """Return the bytes of a dataset. Raises SpecError for a shape that is too large."""
    if dataset.shape is None:
        return 0
    size = int(np.prod([int(n) for n in dataset.shape], dtype=object)) * max(1, dataset.dtype.itemsize)
    check_bytes(size)
    return size


def _read(path: str, dataset: Any, matlab: bool, arrays: dict[str, np.ndarray], texts: dict[str, Column]) -> None:
    """Add a dataset's columns to `arrays` or `texts`."""
    import h5py

    kind = dataset.dtype
    if dataset.shape is None or dataset.size < 2 or dataset.attrs.get("MATLAB_empty"):
        return
    if kind.names is not None and dataset.ndim == 1:
        table = dataset[()]
        check_size(len(table), len(kind.names))
        for field in kind.names:
            if table[field].dtype.kind in "biuf":
                arrays[f"{path}/{field}"] = table[field]
    elif kind.kind in "biuf":
        if _decoded(dataset.attrs.get("MATLAB_class", b"")) not in ("char", "cell"):
            values = dataset[()]
            arrays[path] = values.T if matlab else values
    elif h5py.check_string_dtype(kind) is not None and dataset.ndim == 1:
        check_bytes(len(dataset) * 50)
        cells = [_decoded(value) for value in dataset[()]]
        texts[path] = column_of_values(path, cells)


def _decoded(value: Any) -> str:
    """Return an attribute or cell as text."""
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size else ""
    if isinstance(value, bytes):
        return value[:_LONGEST].decode("utf-8", "replace")
    return str(value)[:_LONGEST]


def _frames(file: Any) -> Iterator[tuple[str, Any]]:
    """Yield the groups in which pandas stored a frame, by their path with a slash after it."""
    import h5py

    for name in list(file)[:100]:
        if isinstance(file.get(name, getlink=True), h5py.HardLink):
            group = file[name]
            if isinstance(group, h5py.Group) and _decoded(group.attrs.get("pandas_type", b"")) == "frame":
                yield f"{name}/", group


def _frame(path: str, group: Any) -> dict[str, np.ndarray]:
    """Return the columns of a frame that pandas stored in blocks; its index is the column `index`."""
    arrays: dict[str, np.ndarray] = {}
    read = 0
    own = {inner: dataset for inner, dataset in _datasets(group)}
    for inner, dataset in own.items():
        read += _size(dataset)
        check_bytes(min(read, MOST_BYTES + 1))
        if inner == "axis1" and dataset.dtype.kind in "iuf" and dataset.ndim == 1:
            arrays[f"{path}index"] = dataset[()]
        if inner.endswith("_values") and f"{inner[:-7]}_items" in own and dataset.dtype.kind in "biuf":
            items = [_decoded(item) for item in own[f"{inner[:-7]}_items"][()]]
            values = dataset[()]
            values = values if values.ndim == 2 and values.shape[1] == len(items) else values.T
            arrays |= {f"{path}{item}": values[:, k] for k, item in enumerate(items)}
    return arrays
