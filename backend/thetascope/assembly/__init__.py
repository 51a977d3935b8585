"""Build engine objects from schemas; only this package knows both."""

from thetascope.assembly.analyses.observer_catalogue import observer_kinds
from thetascope.assembly.analyses.plant_check import check_plant
from thetascope.assembly.analyses.record_run import (
    RecordBytes,
    carry_out,
    record_experiment,
    with_rows,
    with_rows_and_diagnosis,
)
from thetascope.assembly.build.prepare import Cost, Prepared, prepare

__all__ = [
    "Cost",
    "Prepared",
    "RecordBytes",
    "carry_out",
    "check_plant",
    "observer_kinds",
    "prepare",
    "record_experiment",
    "with_rows",
    "with_rows_and_diagnosis",
]
