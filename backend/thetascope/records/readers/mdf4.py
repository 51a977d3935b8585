"""Read MDF files (version 3 and 4) with asammdf, an optional package."""

import io
from importlib import import_module

import numpy as np

from thetascope.records.readers.cells_of_values import joined, table_of_arrays
from thetascope.records.table import MOST_CELLS, Table, check_size

_CHANNELS = 500


def read_mdf4(name: str, data: bytes) -> Table:
    """Return all channels over all their times. Rows are counted from the metadata first. Raises SpecError."""
    MDF = import_module("asammdf").MDF

    parts: list[tuple[np.ndarray, dict[str, np.ndarray]]] = []
    units: dict[str, str] = {}
    cells = 0
    with MDF(io.BytesIO(data)) as file:
        for index, group in enumerate(file.groups):
            rows = int(group.channel_group.cycles_nr)
            cells += rows * len(group.channels)
            check_size(cells if cells > MOST_CELLS else rows, 1)
            columns: dict[str, np.ndarray] = {}
            times = None
            masters = file.masters_db.get(index)
            for place, channel in enumerate(group.channels[:_CHANNELS]):
                if place == masters:
                    continue
                signal = file.get(group=index, index=place, ignore_invalidation_bits=False)
                if signal.samples.dtype.kind in "biuf" and signal.samples.ndim == 1 and len(signal.samples):
                    times = np.asarray(signal.timestamps, dtype=float)
                    columns[channel.name] = signal.samples.astype(float)
                    units |= {channel.name: str(signal.unit)} if signal.unit else {}
            if times is not None:
                parts.append((times, {n: v for n, v in columns.items() if len(v) == len(times)}))
    units["time"] = "s"
    return table_of_arrays(joined(parts, "time") if parts else {}, units, "mdf4")
