"""Configure the diagnosis of a run from the settings of its experiment."""

from collections.abc import Callable
from dataclasses import replace

from thetascope.diagnosis.evaluation.observer_comparison import DETECTOR
from thetascope.diagnosis.monitor.detector import DetectorSettings
from thetascope.diagnosis.outcome.diagnose_run import DiagnosisRequest, diagnose
from thetascope.diagnosis.outcome.findings import detector_report, observer_report
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.engine.errors import Cancelled
from thetascope.engine.execution.run_experiment import Parts
from thetascope.engine.model.result import Result
from thetascope_schemas import ObserverConfig, ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import Diagnosis, ObserverDiagnosis


def detector_settings(spec: ResolvedExperiment) -> DetectorSettings:
    """Return the settings of the detector."""
    return DetectorSettings(spec.diagnosis.false_alarms, spec.diagnosis.doubt)


def span(spec: ResolvedExperiment) -> float:
    """Return the time in s over which thresholds are simulated."""
    return spec.diagnosis.span or spec.horizon


def calibration_key(spec: ResolvedExperiment, observers: tuple[ObserverConfig, ...] = ()) -> str:
    """Return the hash of everything that a calibration depends on: the experiment without its faults and observers."""
    initial_faults = tuple(f for f in spec.faults if f.site.kind == "channel" and f.onset == 0)
    changes = {
        "seed": 0,
        "horizon": span(spec),
        "record": None,
        "evaluate": spec.evaluate_interval,
        "observers": observers,
        "commands": (),
        "figures": (),
        "faults": initial_faults,
        "truth": spec.truth.sample_periods,
    }
    return spec.model_copy(update=changes).spec_hash()


def inspector(
    spec: ResolvedExperiment, cancelled: Callable[[], bool] | None = None
) -> Callable[[Parts, Result], Result] | None:
    """Return a function that adds the diagnosis to a run's result; None if diagnosis is disabled, and for a record.

    The function raises Cancelled soon after ``cancelled`` returns True.
    """
    if not spec.diagnosis.enabled or spec.truth.record is not None:  # a record has a diagnosis of its own
        return None

    def check() -> None:
        if cancelled is not None and cancelled():
            raise Cancelled("the run was cancelled")

    def inspect(parts: Parts, result: Result) -> Result:
        request = DiagnosisRequest(
            detector_settings(spec),
            spec.diagnosis.test,
            calibration_key(spec),
            calibration_key(spec, spec.observers),
            round(span(spec) / spec.step),
        )
        columns = {n: result.data[i] for i, n in enumerate(result.names) if ".theta." in n or ".sigma." in n}
        run_diagnosis = run_to_end(diagnose(parts, columns, request), check)
        confidence = spec.diagnosis.confidence
        report = {
            "detector": detector_report(run_diagnosis, confidence, spec.diagnosis.accuracy, span(spec)),
            "observers": [
                observer_report(own, run_diagnosis.interval, confidence, spec.diagnosis.false_alarms)
                for own in run_diagnosis.observers
            ],
        }
        return replace(result, diagnosis=Diagnosis.model_validate(report).model_dump(mode="json"))

    return inspect


def findings(result: Result) -> dict[str, ObserverDiagnosis]:
    """Return the findings by observer; the detector's under DETECTOR. Empty without a diagnosis."""
    if result.diagnosis is None:
        return {}
    report = Diagnosis.model_validate(result.diagnosis)
    return {DETECTOR: report.detector} | {own.observer: own for own in report.observers}
