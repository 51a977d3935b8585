"""/api/diagnosis: diagnose a record; /api/observability: test whether an experiment can reveal its faults."""

from typing import Any

import numpy as np
from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed
from thetascope.api.http.services import Use
from thetascope.engine.errors import SpecError
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope.runs.specs.refusals import from_engine, invalid, validated
from thetascope.runs.specs.resolve_spec import plant_of, resolved
from thetascope_schemas.experiment.diagnosis import Observability, ObserverDiagnosis
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record import MOST_ROWS, Record

router = APIRouter(tags=["diagnosis"])


@router.post(
    "/diagnosis",
    response_model=ObserverDiagnosis,
    openapi_extra=body_schema("Record"),
    responses=documented(404, 413, 415, 422),
)
async def diagnose_record(request: Request, services: Use, language: Language) -> Response:
    """Diagnose a record: return faults, onsets, sizes and their uncertainty, as `thetascope diagnose` does for a file.

    The noise is estimated from the record; thresholds are computed by simulating the plant with the recorded inputs.
    """
    from thetascope.assembly.analyses.record_diagnosis import diagnose_columns  # imports the engine

    record, plant, columns = await parsed(request, services.settings.max_record, _read)
    try:
        diagnosis = await computed(request, services, diagnose_columns, plant, columns, record.diagnosis, record.learn)
    except SpecError as error:
        raise from_engine(error) from None
    return Response(encode(diagnosis, language), media_type="application/json")


@router.post(
    "/observability",
    response_model=Observability,
    openapi_extra=body_schema("Experiment"),
    responses=documented(404, 413, 415, 422),
)
async def observe(request: Request, services: Use, language: Language) -> Response:
    """Return how well the outputs determine states and faults: structural rank; rank and condition along the run."""
    from thetascope.assembly.analyses.observability_report import observability

    spec = await parsed(request, services.settings.max_body, lambda data: resolved(validated(Experiment, data)))
    try:
        report = await computed(request, services, observability, spec)
    except SpecError as error:
        raise from_engine(error, True) from None
    return Response(encode(report, language), media_type="application/json")


def _read(data: Any) -> tuple[Record, Plant, dict[str, np.ndarray]]:
    record = validated(Record, data)
    return record, plant_of(record.plant), _columns(record)


def _columns(record: Record) -> dict[str, np.ndarray]:
    from thetascope.assembly.analyses.csv_columns import columns_of_csv

    if record.csv is not None and record.columns is None:
        columns = columns_of_csv(record.csv)
    elif record.columns is not None and record.csv is None:
        columns = {name: np.array(values) for name, values in record.columns.items()}
    else:
        raise invalid("columns", None, Message("record.columns-or-csv"))
    rows = {len(column) for column in columns.values()}
    if len(rows) > 1:
        name = next(n for n, column in columns.items() if len(column) < max(rows))
        problem = Message("record.columns.uneven", rows=max(rows))
        raise invalid(f"columns.{name}", len(columns[name]), problem)
    if max(rows, default=0) > MOST_ROWS:
        raise invalid("columns", max(rows), Message("record.rows.over-limit", rows=max(rows), limit=MOST_ROWS))
    return columns
