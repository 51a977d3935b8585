"""The comparison of a run's observers as the contract has it."""

from dataclasses import asdict

from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation.observer_comparison import COVERED, FOUND, MISSED, Row, compare
from thetascope.engine.model.result import Result
from thetascope_schemas import Experiment
from thetascope_schemas.service.comparison import Comparison, ComparisonRow


def compared(result: Result, spec: Experiment) -> Comparison:
    """Compare the observers of a result; the spec gives the faults."""
    found = compare(result, spec.faults, findings(result))
    return Comparison.model_validate(
        {"windows": [asdict(window) for window in found.windows], "observers": [_row(row) for row in found.rows]}
    )


def _row(row: Row) -> ComparisonRow:
    return ComparisonRow(
        label=row.label,
        rmse=row.rmse,
        peak=row.peak,
        steps=tuple(asdict(step) for step in row.steps),
        faults=None if row.verdicts is None else tuple(asdict(verdict) for verdict in row.verdicts),
        found=row.count(FOUND),
        covered=row.count(COVERED),
        missed=row.count(MISSED),
        false_alarms=row.false_alarms,
        isolation_errors=row.isolation_errors,
        delay=row.delay,
        grace=row.grace,
        cost=None if row.cost is None else 1e6 * row.cost,
    )
