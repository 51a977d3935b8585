"""Read TDMS files with npTDMS, an optional package."""

import io
from typing import Any

import numpy as np

from thetascope.records.readers.cells_of_values import joined, table_of_arrays
from thetascope.records.table import Table, check_size, date_column

_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit")


def read_tdms(name: str, data: bytes) -> Table:
    """Return the channels of all groups; those of different rates over all their times. Raises SpecError."""
    from nptdms import TdmsFile

    metadata = TdmsFile.read_metadata(io.BytesIO(data))
    lengths = [len(channel) for group in metadata.groups() for channel in group.channels()]
    check_size(max(lengths, default=0), 1)
    check_size(sum(lengths), 1) if sum(lengths) > len(data) * 8 else None
    file = TdmsFile.read(io.BytesIO(data))
    several = len(file.groups()) > 1
    units: dict[str, str] = {}
    arrays: dict[str, np.ndarray] = {}
    dates = {}
    rates: dict[tuple[float, float, int], dict[str, np.ndarray]] = {}
    for group in file.groups():
        for channel in group.channels():
            values = np.asarray(channel[:])
            path = f"{group.name}.{channel.name}" if several else channel.name
            unit = next((str(channel.properties[k]) for k in _UNITS if k in channel.properties), "")
            if values.dtype.kind == "M":
                dates[path] = date_column(path, values.astype("M8[ns]").astype("i8"))
            elif values.dtype.kind in "biuf" and len(values):
                units |= {path: unit} if unit else {}
                rate = _rate(channel)
                if rate is None:
                    arrays[path] = values
                else:
                    rates.setdefault((*rate, len(values)), {})[path] = values.astype(float)
    if rates and not dates:
        parts = [(start + step * np.arange(rows), columns) for (start, step, rows), columns in rates.items()]
        arrays |= joined(parts, "time")
        units["time"] = "s"
    return table_of_arrays(arrays, units, "tdms", dates)


def _rate(channel: Any) -> tuple[float, float] | None:
    """Return the first time and the period in s of a waveform, or None for another channel."""
    step = channel.properties.get("wf_increment")
    if not isinstance(step, int | float) or not 0 < float(step) < np.inf:
        return None
    return float(channel.properties.get("wf_start_offset", 0.0)), float(step)
