"""/api/papers: the papers whose experiments the library has; and what is measured in a run."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope import library
from thetascope.api.http.answers import from_result, json_response
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Use
from thetascope.assembly.paper_page import paper_page
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished
from thetascope.runs.results.measures import Readings, columns_read, value_of
from thetascope.runs.specs.refusals import Unknown, invalid
from thetascope_schemas.service.learning.measured import Measured, MeasuresRequest
from thetascope_schemas.service.learning.paper import PaperList, PaperPage
from thetascope_schemas.texts.refusal import suggestion

router = APIRouter()


@router.get("/papers", response_model=PaperList, tags=["papers"])
def list_papers() -> Response:
    """Return the papers: who published them, and what they claim."""
    lines = [paper.model_dump(include={"id", "citation", "claim"}) for paper in library.papers().values()]
    return json_response({"papers": lines})


@router.get("/papers/{id}", response_model=PaperPage, responses=documented(404), tags=["papers"])
def get_paper(id: str) -> Response:
    """Return a paper: equations (TeX and MathML), figures and numbers to compute, errata with their evidence."""
    if id not in library.papers():
        raise Unknown(Message("paper.unknown", id=id[:80]))
    return json_response(paper_page(id).model_dump(mode="json"))


@router.post(
    "/runs/{id}/measures",
    response_model=Measured,
    openapi_extra=body_schema("MeasuresRequest"),
    responses=documented(404, 409, 413, 415, 422, 429),
    tags=["results"],
)
async def measure_run(request: Request, id: str, services: Use) -> Response:
    """Measure times, levels and rates in a run, as lessons and the pages of the papers do. Times count from 0."""
    body = await parsed_as(request, services, MeasuresRequest)
    return json_response(
        (await from_result(request, services, id, lambda finished: measured(finished, body))).model_dump(mode="json")
    )


def measured(finished: Finished, asked: MeasuresRequest) -> Measured:
    """Return the measured numbers. Raises InvalidSpec for a column that the run does not have."""
    result, summary = finished.result, finished.snapshot.summary
    for name, measure in asked.measures.items():
        for column in columns_read(measure):
            if column not in result.names:
                hint = Message.from_data(suggestion(column, result.names))
                raise invalid(f"measures.{name}.column", column, Message("measure.column.unknown", column=column), hint)
    observers = summary.observers if summary else ()
    readings = Readings(
        t=result.column("t"),
        read=result.column,
        mark=0.0,
        alarms=summary.diagnosis.detector.alarms if summary and summary.diagnosis else (),
        diverged={one.label: one.diverged.time for one in observers if one.diverged},
        gains={one.label: dict(one.gains) for one in finished.snapshot.spec.observers},
    )
    return Measured(values={name: value_of(measure, readings) for name, measure in asked.measures.items()})
