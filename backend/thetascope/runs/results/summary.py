"""Summarise a result in a few numbers."""

import math
from typing import Any

import numpy as np

from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation.metrics import LAST, event_times, final_values, settling, state_rmse, step_changes
from thetascope.diagnosis.evaluation.observer_comparison import compare
from thetascope.engine.model.result import Accuracy as Reached
from thetascope.engine.model.result import Check, Diverged, ObserverReport, Result
from thetascope.runs.results.comparison_rows import comparison_rows, facts_of
from thetascope_schemas import Experiment, ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.diagnosis import Diagnosis
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis
from thetascope_schemas.service.run import Accuracy, AssumptionCheck, Divergence, ObserverSummary, RunSummary


def summarise(result: Result, spec: ResolvedExperiment) -> RunSummary:
    """Return the run's summary: facts at its end, and divergence, errors, settling and checks of every observer."""
    comparison = compare(result, spec.faults, findings(result))
    return RunSummary(
        columns=len(result.names),
        rows=result.data.shape[1],
        step=result.step,
        substeps=result.substeps,
        accuracy=_accuracy(result.accuracy),
        diverged=_divergence(result.diverged),
        observers=tuple(_observer(result, report, spec) for report in result.observers),
        comparison=comparison_rows(comparison),
        facts=facts_of(result, spec, comparison),
        diagnosis=None if result.diagnosis is None else Diagnosis.model_validate(result.diagnosis),
        record=None if result.record is None else RecordDiagnosis.model_validate(result.record),
        notes=tuple(Text.of(note) for note in result.notes),
        seconds=result.seconds,
    )


def _observer(result: Result, report: ObserverReport, spec: Experiment) -> ObserverSummary:
    steps, events = step_changes(spec.faults, spec.horizon), event_times(spec.faults)
    return ObserverSummary(
        label=report.label,
        kind=report.kind,
        title=Text.of(report.title),
        diverged=_divergence(report.diverged),
        rmse=state_rmse(result, report.label),
        rmse_end=state_rmse(result, report.label, LAST),
        theta=jsonable(final_values(result, report.label)),
        settling=tuple(jsonable(vars(s)) for s in settling(result, report.label, steps, events)),
        checks=tuple(_check(check) for check in report.checks),
        facts={name: jsonable(value) for name, value in report.facts.items()},
    )


def _accuracy(reached: Reached | None) -> Accuracy | None:
    if reached is None:
        return None
    values = {name: getattr(reached, name) for name in Accuracy.model_fields}
    return Accuracy(**values)


def _check(check: Check) -> AssumptionCheck:
    value, threshold = jsonable(check.value), jsonable(check.threshold)
    return AssumptionCheck(
        name=Text.of(check.name),
        verdict=check.verdict,
        text=Text.of(check.text),
        value=value,
        threshold=threshold,
        source=check.source,
        gains=jsonable(check.gains),
    )


def _divergence(diverged: Diverged | None) -> Divergence | None:
    return None if diverged is None else Divergence(time=diverged.time, cause=Text.of(diverged.cause))


def jsonable(value: object) -> Any:
    """Return plain JSON data: arrays as lists, complex numbers as [re, im], null for values that are not finite.

    Other objects become text.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, complex):
        return [jsonable(value.real), jsonable(value.imag)]
    if isinstance(value, dict):
        return {str(key): jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [jsonable(item) for item in value]
    return str(value)
