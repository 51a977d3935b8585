"""The result of a run."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from thetascope.messages import Message

Verdict = Literal["holds", "fails", "cannot tell"]
HOLDS: Verdict = "holds"
FAILS: Verdict = "fails"
CANNOT_TELL: Verdict = "cannot tell"


@dataclass(frozen=True)
class Diverged:
    """The time in s at which a plant or an observer left the finite numbers or the bound 1e12, and the likely cause."""

    time: float
    cause: Message


@dataclass(frozen=True)
class Check:
    """Result of checking one assumption of an observer's theorem for the plant, the gains and the run."""

    name: Message
    verdict: Verdict
    text: Message
    value: float | None = None
    threshold: float | None = None
    source: str = ""


@dataclass(frozen=True)
class ObserverReport:
    """The report on one observer: its checks, its divergence, and facts determined during its construction."""

    label: str
    kind: str
    title: Message
    checks: tuple[Check, ...]
    diverged: Diverged | None
    facts: dict[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """Columns of a run, in the order of every export. ``data`` holds one column per row: shape (names, rows)."""

    names: tuple[str, ...]
    data: np.ndarray
    observers: tuple[ObserverReport, ...]
    diverged: Diverged | None
    step: float
    substeps: int
    notes: tuple[Message, ...]
    seconds: dict[str, float]
    costs: dict[str, float] = field(default_factory=dict)
    """Processor time in s per simulated second, by observer. It is measured, so it differs between runs."""
    diagnosis: dict | None = None
    """The diagnosis as plain data (thetascope_schemas' Diagnosis); None if it was not requested."""

    def column(self, name: str) -> np.ndarray:
        """Return one column by name, shape (rows,). Raises KeyError."""
        try:
            return self.data[self.names.index(name)]
        except ValueError:
            raise KeyError(name) from None
