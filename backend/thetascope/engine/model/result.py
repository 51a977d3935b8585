"""The results of a run."""

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
    """One assumption of an observer's theorem, on this plant, with these gains, in this run."""

    name: Message
    verdict: Verdict
    text: Message
    value: float | None = None
    threshold: float | None = None
    source: str = ""


@dataclass(frozen=True)
class ObserverReport:
    """What a run says of one observer: its checks, when it diverged, and facts of its construction."""

    label: str
    kind: str
    title: str
    checks: tuple[Check, ...]
    diverged: Diverged | None
    facts: dict[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """Columns of a run, in the order of every export. ``data`` has one row a column: shape (names, rows)."""

    names: tuple[str, ...]
    data: np.ndarray
    observers: tuple[ObserverReport, ...]
    diverged: Diverged | None
    step: float
    substeps: int
    notes: tuple[Message, ...]
    seconds: dict[str, float]
    costs: dict[str, float] = field(default_factory=dict)
    """Processor seconds per simulated second, measured, by observer: another number each time."""
    diagnosis: dict | None = None
    """What is said about the faults, as plain data (shared.diagnosis.Diagnosis); None where nobody asked."""

    def column(self, name: str) -> np.ndarray:
        """One column by name. Raises KeyError."""
        try:
            return self.data[self.names.index(name)]
        except ValueError:
            raise KeyError(name) from None
