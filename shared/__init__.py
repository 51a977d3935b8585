"""The contract: what a plant, a signal, a fault, an observer, an experiment and a run look like as data.

Only pydantic and the standard library are used here. Server, command line and clients speak these schemas.
"""

from shared.base import SCHEMA_VERSION, FieldError, field_errors
from shared.diagnosis import (
    Alarm,
    Calibration,
    Diagnosis,
    DiagnosisSettings,
    Excitation,
    InputProposal,
    NoiseLevel,
    Observability,
    ObserverDiagnosis,
    Resolution,
)
from shared.experiment import Experiment, Noise
from shared.faults import Fault
from shared.figures import Figure, Panel, Trace
from shared.observers import ObserverConfig
from shared.plant import Channel, Definition, Input, KnownSignal, Output, Parameter, Plant, State
from shared.record import Record
from shared.run import Problem, Progress, Run, RunSummary
from shared.signals import Signal

__all__ = [
    "SCHEMA_VERSION",
    "Alarm",
    "Calibration",
    "Channel",
    "Definition",
    "Diagnosis",
    "DiagnosisSettings",
    "Excitation",
    "Experiment",
    "Fault",
    "FieldError",
    "Figure",
    "Input",
    "InputProposal",
    "KnownSignal",
    "Noise",
    "NoiseLevel",
    "Observability",
    "ObserverConfig",
    "ObserverDiagnosis",
    "Output",
    "Panel",
    "Parameter",
    "Plant",
    "Problem",
    "Progress",
    "Record",
    "Resolution",
    "Run",
    "RunSummary",
    "Signal",
    "State",
    "Trace",
    "field_errors",
]
