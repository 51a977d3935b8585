"""The result of a run."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from thetascope.messages import Message

Verdict = Literal["holds", "fails", "cannot tell"]
HOLDS: Verdict = "holds"
TOLERANCE = 1e-6
"""Error of the integration, relative to a state's scale, that steps are chosen for."""
OBSERVER_TOLERANCE = 1e-4
"""The same for the estimates of observers, which follow noisy measurements and forget their errors."""
FAILS: Verdict = "fails"
CANNOT_TELL: Verdict = "cannot tell"


@dataclass(frozen=True)
class Diverged:
    """The time in s at which a plant or an observer left the finite numbers or the bound 1e12, and the likely cause."""

    time: float
    cause: Message


@dataclass(frozen=True)
class Accuracy:
    """The accuracy that the integration of a span reached, and the steps that it took.

    Attributes:
        plant: largest estimated error of a plant state, relative to its scale.
        observers: the same of the observers' states.
        substeps: largest number of explicit substeps of a base step.
        implicit: largest number of implicit substeps, 0 if none were taken.
        tolerance, observer_tolerance: errors that the steps were chosen for.
    """

    plant: float = 0.0
    observers: float = 0.0
    substeps: int = 1
    implicit: int = 0
    tolerance: float = TOLERANCE
    observer_tolerance: float = OBSERVER_TOLERANCE

    def with_part(self, other: "Accuracy") -> "Accuracy":
        """Return the accuracy of two spans together."""
        mine, theirs = vars(self), vars(other)
        return Accuracy(**{name: max(mine[name], theirs[name]) for name in mine})


@dataclass(frozen=True)
class Check:
    """Result of checking one assumption of an observer's theorem for the plant, the gains and the run."""

    name: Message
    verdict: Verdict
    text: Message
    value: float | None = None
    threshold: float | None = None
    source: str = ""
    gains: dict[str, list[float]] | None = None  # that meet it, where others were designed


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
    record: dict | None = None
    """The diagnosis of the record as plain data (thetascope_schemas' RecordDiagnosis); None without a record."""
    accuracy: Accuracy | None = None
    """The accuracy that the integration reached; None where it was not measured: fixed substeps, discrete time."""

    @property
    def accuracy_message(self) -> Message | None:
        """Return the accuracy of the integration as a sentence; None where it was not measured."""
        known = self.accuracy
        if known is None:
            return None
        errors = {"plant": known.plant, "observers": known.observers}
        tolerances = {"tolerance": known.tolerance, "observer_tolerance": known.observer_tolerance}
        return Message("run.accuracy", **errors, **tolerances)

    def column(self, name: str) -> np.ndarray:
        """Return one column by name, shape (rows,). Raises KeyError."""
        try:
            return self.data[self.names.index(name)]
        except ValueError:
            raise KeyError(name) from None
