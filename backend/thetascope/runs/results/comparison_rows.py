"""Convert the comparison of a run's observers to schemas."""

from dataclasses import asdict

from thetascope.assembly.analyses.facts import DetectorState, Losses, facts
from thetascope.assembly.analyses.record_run import alarms_of
from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation.observer_comparison import (
    COVERED,
    DETECTOR,
    FOUND,
    MISSED,
    Row,
    compare,
)
from thetascope.diagnosis.evaluation.observer_comparison import Comparison as Compared
from thetascope.diagnosis.evaluation.verdicts import Judgement
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope_schemas import Experiment, ResolvedExperiment
from thetascope_schemas.service.comparison import AlarmOutcome, Comparison, ComparisonRow, FaultOutcome, StepFollowed
from thetascope_schemas.service.facts import Facts
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis


def compared(result: Result, spec: Experiment) -> Comparison:
    """Return the comparison of the observers of a result; the spec gives the faults."""
    return comparison_rows(compare(result, spec.faults, findings(result)))


def comparison_rows(comparison: Compared) -> Comparison:
    """Return a comparison as a schema."""
    return Comparison.model_validate(
        {
            "windows": [asdict(window) for window in comparison.windows],
            "observers": [_row(row) for row in comparison.rows],
        }
    )


def facts_of(result: Result, spec: ResolvedExperiment, comparison: Compared) -> Facts:
    """Return the facts at the end of a run; for a saved session, those of the session."""
    if spec.truth.record is not None:
        return record_facts(spec, result)
    diagnosis = findings(result).get(DETECTOR)
    judgement = next((row.judgement for row in comparison.rows if row.label == DETECTOR), None)
    settled = diagnosis.calibration.from_time if diagnosis and diagnosis.calibration else 0.0
    note = diagnosis.note if diagnosis else Message("diagnosis.none.disabled")
    alarms = sorted(diagnosis.alarms, key=lambda alarm: alarm.t) if diagnosis and judgement else ()
    lost = {r.label: (r.diverged.time, r.diverged.cause) for r in result.observers if r.diverged is not None}
    end = float(result.column("t")[-1])
    detector = DetectorState(alarms, judgement, diagnosis, settled, None if judgement else note)
    return facts(spec, end, end, detector, Losses(lost, result.diverged.time if result.diverged else None))


def record_facts(spec: ResolvedExperiment, result: Result) -> Facts:
    """Return the facts at the end of a record: the alarms of its faults, on which nobody can give verdicts."""
    lost = {r.label: (r.diverged.time, r.diverged.cause) for r in result.observers if r.diverged is not None}
    end = float(result.column("t")[-1])
    diagnosis = None if result.record is None else RecordDiagnosis.model_validate(result.record)
    alarms = () if diagnosis is None else alarms_of(diagnosis)
    known = facts(
        spec, end, end, DetectorState(alarms, None, None, 0.0, Message("diagnosis.none.disabled")), Losses(lost)
    )
    return known if diagnosis is None else known.model_copy(update={"summary": diagnosis.sentence})


def _row(row: Row) -> ComparisonRow:
    return ComparisonRow(
        label=row.label,
        rmse=row.rmse,
        peak=row.peak,
        steps=tuple(StepFollowed.model_validate(asdict(step)) for step in row.steps),
        faults=None if row.judgement is None else outcomes(row.judgement)[0],
        alarms=None if row.judgement is None else outcomes(row.judgement)[1],
        found=row.count(FOUND),
        covered=row.count(COVERED),
        missed=row.count(MISSED),
        false_alarms=row.false_alarms,
        isolation_errors=row.isolation_errors,
        delay=row.delay,
        grace=row.grace,
        cost=None if row.cost is None else 1e6 * row.cost,
    )


def outcomes(judgement: Judgement) -> tuple[tuple[FaultOutcome, ...], tuple[AlarmOutcome, ...]]:
    """Return the verdicts on faults and alarms as schemas, for runs and live sessions."""
    return (
        tuple(FaultOutcome.model_validate(asdict(fault)) for fault in judgement.faults),
        tuple(AlarmOutcome.model_validate(asdict(alarm)) for alarm in judgement.alarms),
    )
