"""The schemas of plants, signals, faults, observers, experiments, runs and the messages of the service.

Server, command line and clients exchange data in these forms. Only pydantic and the standard library are used here.
"""

from thetascope_schemas.experiment.base import SCHEMA_VERSION
from thetascope_schemas.experiment.diagnosis import (
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
from thetascope_schemas.experiment.experiment import Experiment, Noise, ResolvedExperiment
from thetascope_schemas.experiment.faults import Fault
from thetascope_schemas.experiment.figures import Figure, Panel, Trace
from thetascope_schemas.experiment.observers import ObserverConfig
from thetascope_schemas.experiment.plant import Channel, Definition, Input, KnownSignal, Output, Parameter, Plant, State
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.field_error import FieldError, field_errors
from thetascope_schemas.service.record import Record
from thetascope_schemas.service.run import Problem, Progress, Run, RunSummary

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
    "ResolvedExperiment",
    "Run",
    "RunSummary",
    "Signal",
    "State",
    "Trace",
    "field_errors",
]
