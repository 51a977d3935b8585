"""A peculiarity of a record, before it is sent: rows as places, quantities by name."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from thetascope.messages import Message
from thetascope_schemas.service.record_inspection import Severity

MOST = 10
"""Rows that a finding names."""
_MOST_RANGES = 6


@dataclass(frozen=True)
class Finding:
    """One finding; `lines` and `times` are those of its first rows, `until` is the end of a single stretch in s."""

    kind: str
    severity: Severity
    text: Message
    treatment: Message | None = None
    quantity: str | None = None
    column: str | None = None
    count: int = 0
    lines: tuple[int, ...] = ()
    times: tuple[float, ...] = ()
    until: float | None = None
    proposal: dict[str, Any] | None = None


@dataclass(frozen=True)
class Rows:
    """Rows in the order of time: their lines in the file and their times in s."""

    lines: np.ndarray
    t: np.ndarray

    def marks(self, places: np.ndarray) -> dict[str, Any]:
        """Return the count, lines and times of rows, for a Finding."""
        first = np.asarray(places)[:MOST]
        return {
            "count": len(places),
            "lines": tuple(int(line) for line in self.lines[first]),
            "times": tuple(float(t) for t in self.t[first]),
        }


def stretches(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return the runs of true flags as half-open ranges."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def lines_text(lines: Sequence[int] | np.ndarray) -> str:
    """Return line numbers for a sentence: ranges are joined, and those beyond the first six are left out."""
    parts: list[str] = []
    begin = last = None
    for line in lines:
        if last is not None and line == last + 1:
            last = line
            continue
        if begin is not None:
            parts.append(f"{begin}" if begin == last else f"{begin}–{last}")
        if len(parts) > _MOST_RANGES:
            return ", ".join(parts[:_MOST_RANGES]) + " …"
        begin = last = line
    if begin is not None:
        parts.append(f"{begin}" if begin == last else f"{begin}–{last}")
    return ", ".join(parts[:_MOST_RANGES]) + (" …" if len(parts) > _MOST_RANGES else "")
