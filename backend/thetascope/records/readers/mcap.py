"""Read MCAP files with the package mcap, which is optional: messages in JSON, and others whose decoder is installed."""

import io
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

import numpy as np
import orjson

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.readers.cells_of_values import joined, table_of_arrays
from thetascope.records.table import MOST_BYTES, MOST_ROWS, Table, check_size

_DECODERS = {"protobuf": "mcap_protobuf.decoder", "cdr": "mcap_ros2.decoder", "ros1": "mcap_ros1.decoder"}
_DEEPEST = 6
_FIELDS = 500
_NANO = 1e-9


def read_mcap(name: str, data: bytes) -> Table:
    """Return the numbers in the messages of all topics over all their times. Raises SpecError."""
    from mcap.reader import SeekingReader

    series: dict[str, tuple[list[int], list[dict[str, float]]]] = {}
    encodings: set[str] = set()
    count = 0
    reader = SeekingReader(io.BytesIO(data), decoder_factories=_factories(), record_size_limit=MOST_BYTES)
    for schema, channel, message in reader.iter_messages():
        count += 1
        if count > MOST_ROWS:
            check_size(count, 1)
        value = _decoded(reader, schema, channel, message)
        if value is None:
            encodings.add(channel.message_encoding)
            continue
        times, rows = series.setdefault(channel.topic.strip("/"), ([], []))
        times.append(message.log_time)
        rows.append(dict(_numbers(value)))
    if not series:
        raise SpecError("file", None, Message("record.file.mcap-encoding", names=sorted(encodings) or ["?"]))
    begin = min(times[0] for times, _ in series.values())
    parts = [(_seconds(times, begin), _columns(topic, rows)) for topic, (times, rows) in series.items()]
    return table_of_arrays(joined(parts, "time"), {"time": "s"}, "mcap")


def _factories() -> list[Any]:
    """Return the decoders that are installed."""
    found = []
    for module in _DECODERS.values():
        try:
            found.append(import_module(module).DecoderFactory())
        except ImportError:
            continue
    return found


def _decoded(reader: Any, schema: Any, channel: Any, message: Any) -> Any:
    """Return a message's content, or None where nothing installed can decode it."""
    if channel.message_encoding == "json":
        return orjson.loads(message.data)
    for factory in reader._decoder_factories:
        decode = factory.decoder_for(channel.message_encoding, schema)
        if decode is not None:
            return decode(message.data)
    return None


def _seconds(times: list[int], begin: int) -> np.ndarray:
    return (np.array(times, dtype="i8") - begin) * _NANO


def _columns(topic: str, rows: list[dict[str, float]]) -> dict[str, np.ndarray]:
    names = list(dict.fromkeys(name for row in rows for name in row))[:_FIELDS]
    check_size(len(rows), len(names))
    return {f"{topic}.{name}": np.array([row.get(name, np.nan) for row in rows]) for name in names}


def _numbers(value: Any, path: str = "", depth: int = 0) -> Iterator[tuple[str, float]]:
    """Yield the numbers in a message by their path."""
    if isinstance(value, bool | int | float):
        yield path or "value", float(value)
    elif depth < _DEEPEST:
        if isinstance(value, Mapping):
            fields = list(value.items())
        elif hasattr(value, "DESCRIPTOR"):
            fields = [(field.name, getattr(value, field.name)) for field in value.DESCRIPTOR.fields]
        elif hasattr(value, "__slots__"):
            fields = [(field, getattr(value, field)) for field in value.__slots__]
        elif isinstance(value, list | tuple) and len(value) <= 20:
            fields = [(str(k), item) for k, item in enumerate(value)]
        else:
            return
        for name, item in fields:
            yield from _numbers(item, f"{path}.{name}" if path else str(name), depth + 1)
