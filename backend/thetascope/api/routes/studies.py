"""/api/studies: begin studies, follow them, and what is computed from the runs that are there."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict
from datetime import UTC, datetime
from functools import partial
from typing import Annotated, Any, Literal, TypeVar

import polars as pl
from fastapi import APIRouter, Query, Request
from pydantic import BaseModel
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import Principal, principal_of
from thetascope.api.http.answers import in_pieces, in_turn, json_response
from thetascope.api.http.computed import check_cpu, computed
from thetascope.api.http.language import Language, Prose
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.messages import Message
from thetascope.runs.specs import problem_documents
from thetascope.runs.specs.refusals import Busy, invalid, validated
from thetascope.runs.workers.limits import Crashed, LimitReached
from thetascope.studies import summary, tables
from thetascope.studies.block import seconds_of_run
from thetascope.studies.jobs import State
from thetascope.studies.kept import document_of
from thetascope.studies.plan import at_place, complete, experiment_of_point, place_of
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.study.answers import (
    Compromises,
    Confusion,
    Curves,
    FoundBySize,
    PointAnswers,
    Roc,
    Sensitivities,
    StudyList,
    StudySize,
    StudyState,
)
from thetascope_schemas.service.study.study import Study
from thetascope_schemas.texts.local_text import in_language

router = APIRouter(prefix="/studies", tags=["studies"])

Value = TypeVar("Value")
Column = Annotated[str, Query(max_length=200, description="A column of the table.")]
Who = Annotated[str, Query(max_length=64, description="`detector`, or the label of an observer with tests.")]
_TRIED = 8
"""Runs by which the time of a study is told before it is begun."""
_KINDS = {
    "csv": "text/csv; charset=utf-8",
    "parquet": "application/vnd.apache.parquet",
    "tex": "application/x-tex",
}


def parse_study(data: Any) -> Study:
    """Return the complete study of a body. Raises InvalidSpec, Unknown."""
    return complete(validated(Study, data))


@router.post(
    "",
    status_code=202,
    response_model=StudyState,
    openapi_extra=body_schema("Study"),
    responses=documented(404, 409, 413, 415, 422, 429, 503),
)
async def begin_study(request: Request, services: Use, language: Language) -> Response:
    """Begin a study, or go on with one that was ended. The same study has the same id, and no run is made twice."""
    check_cpu(request, services)
    by = principal_of(request.scope)
    id = await parsed(request, services, parse_study, lambda study: services.studies.begin(study, by))
    audit(request, "study.begun", study=id)
    return await _answered(request, services, id, language, 202)


@router.post(
    "/size",
    response_model=StudySize,
    openapi_extra=body_schema("Study"),
    responses=documented(404, 413, 415, 422, 429, 503),
)
async def measure_study(request: Request, services: Use) -> Response:
    """Return how many runs a study has and how long it will take, by its first runs, without beginning it."""
    study = await parsed(request, services, parse_study)
    tried = min(_TRIED, study.runs)
    seconds: float | None = None
    with suppress(LimitReached, Crashed, Busy):  # of the trial, and not of the study
        seconds = study.runs * await computed(request, services, seconds_of_run, document_of(study), tried)
    size = {"id": study.study_hash(), "runs": study.runs, "points": study.point_count, "seeds": study.seeds}
    return json_response(size | {"seconds": seconds})


@router.get("", response_model=StudyList)
async def list_studies(request: Request, services: Use, language: Language) -> Response:
    """Return the studies of this client, the newest first."""
    by = principal_of(request.scope)
    found = await in_turn(request, lambda: services.studies.all(by))
    return json_response({"studies": [_state(one, by, language) for one in found]})


@router.get("/{id}", response_model=StudyState, responses=documented(404))
async def get_study(request: Request, id: str, services: Use, language: Language) -> Response:
    """Return a study: how far it is, and the columns of its table."""
    return await _answered(request, services, id, language)


@router.get("/{id}/spec", response_model=Study, responses=documented(404))
async def get_study_spec(request: Request, id: str, services: Use, language: Prose) -> Response:
    """Return the study's spec, its experiment in full."""
    state = await in_turn(request, lambda: services.studies.state(id))
    return Response(state.study.model_dump_json(context={"language": language}), media_type="application/json")


@router.post("/{id}/cancel", response_model=StudyState, responses=documented(403, 404))
async def cancel_study(request: Request, id: str, services: Use, language: Language) -> Response:
    """End the computation. What was computed is kept, and POST of the same study goes on from there."""
    await run_in_threadpool(services.studies.cancel, id, principal_of(request.scope))
    audit(request, "study.cancelled", study=id)
    return await _answered(request, services, id, language)


@router.delete("/{id}", status_code=204, responses=documented(403, 404))
async def delete_study(request: Request, id: str, services: Use) -> Response:
    """Cancel a study and remove its table; runs of its points that were opened stay."""
    await run_in_threadpool(services.studies.remove, id, principal_of(request.scope))
    audit(request, "study.removed", study=id)
    return Response(status_code=204)


_TABLE = {"content": {media.partition(";")[0]: {} for media in _KINDS.values()}}


@router.get("/{id}/table.{kind}", response_class=Response, responses={200: _TABLE, **documented(404, 422)})
async def get_table(request: Request, id: str, kind: Literal["csv", "parquet", "tex"], services: Use) -> Response:
    """Return all runs that are there as CSV or Parquet, or a LaTeX table of the points."""

    def make(state: State) -> bytes:
        if kind == "csv":
            return tables.csv_bytes(state.table)
        if kind == "parquet":
            return tables.parquet_bytes(state.table)
        chosen = tables.usual_measures(state.table, state.study) if len(state.table) else ()
        return tables.latex(tables.point_table(state.table, state.study, chosen)).encode()

    content = await _of_study(request, services, id, make)
    return in_pieces(content, {"Content-Disposition": f'attachment; filename="study-{id[:8]}.{kind}"'}, _KINDS[kind])


@router.get("/{id}/runs/{run}", response_model=Experiment, responses=documented(404, 422))
async def get_study_run(request: Request, id: str, run: int, services: Use, language: Prose) -> Response:
    """Return the experiment of a run; POST /api/runs with it opens the run, with the same numbers."""

    def make(state: State) -> Experiment:
        if not 0 <= run < state.study.runs:
            raise invalid("run", run, Message("study.run.unknown", run=run, last=state.study.runs - 1))
        place = place_of(state.study, run)
        spec = at_place(experiment_of_point(state.study, place.point), place)
        row = state.table.filter(pl.col("run") == run) if len(state.table) else state.table
        if len(row) and row.get_column("substeps")[0] is not None:
            spec = spec.model_copy(update={"substeps": row.get_column("substeps")[0]})
        return spec

    spec = await _of_study(request, services, id, make)
    return Response(spec.model_dump_json(context={"language": language}), media_type="application/json")


# ---- what is computed from the runs that are there -------------------------------------------------------------------


@router.get("/{id}/curves", response_model=Curves, responses=documented(404, 422))
async def get_curves(
    request: Request, id: str, services: Use, measure: Column, against: Column, curve: Column | None = None
) -> Response:
    """Return a measure at each value of a factor: median and middle half, or the share with its interval."""

    def make(state: State) -> dict[str, Any]:
        _check_measure(state, "measure", measure)
        _check_factor(state, "against", against)
        if curve is not None:
            _check_factor(state, "curve", curve)
        return {"points": [asdict(one) for one in summary.against(state.table, measure, against, curve)]}

    return await _summary(request, services, id, Curves, make)


@router.get("/{id}/roc", response_model=Roc, responses=documented(404, 422))
async def get_roc(request: Request, id: str, services: Use, against: Column, who: Who = "detector") -> Response:
    """Return alarms in runs without faults against faults found, at each value of a factor."""

    def make(state: State) -> dict[str, Any]:
        _check_who(state, who)
        _check_factor(state, "against", against)
        return {"points": [asdict(one) for one in summary.roc(state.table, who, against)]}

    return await _summary(request, services, id, Roc, make)


@router.get("/{id}/sizes", response_model=FoundBySize, responses=documented(404, 422))
async def get_sizes(
    request: Request,
    id: str,
    services: Use,
    against: Column,
    who: Who = "detector",
    share: Annotated[float, Query(gt=0, le=1, description="Wanted share of faults that are found.")] = 0.9,
) -> Response:
    """Return how many faults of each size are found and how soon, and the smallest size that is found reliably."""

    def make(state: State) -> dict[str, Any]:
        _check_who(state, who)
        _check_number(state, "against", against)
        channels = summary.by_size(state.table, against, who, share)
        return {"share": share, "channels": [asdict(one) for one in channels]}

    return await _summary(request, services, id, FoundBySize, make)


@router.get("/{id}/confusion", response_model=Confusion, responses=documented(404, 422))
async def get_confusion(request: Request, id: str, services: Use, who: Who = "detector") -> Response:
    """Return what the first alarm named, by the true fault."""

    def make(state: State) -> dict[str, Any]:
        _check_who(state, who)
        return {"counts": summary.confusion(state.table, state.study, who)}

    return await _summary(request, services, id, Confusion, make)


@router.get("/{id}/sensitivity", response_model=Sensitivities, responses=documented(404, 422))
async def get_sensitivity(request: Request, id: str, services: Use, measure: Column) -> Response:
    """Return what each factor does to a measure: rank correlation and first-order Sobol index."""

    def make(state: State) -> dict[str, Any]:
        _check_measure(state, "measure", measure)
        return {"factors": [asdict(one) for one in summary.sensitivity(state.table, state.study, measure)]}

    return await _summary(request, services, id, Sensitivities, make)


@router.get("/{id}/pareto", response_model=Compromises, responses=documented(404, 422))
async def get_pareto(request: Request, id: str, services: Use, a: Column, b: Column) -> Response:
    """Return the points of the design by two measures, and which of them no other beats."""

    def make(state: State) -> dict[str, Any]:
        _check_measure(state, "a", a)
        _check_measure(state, "b", b)
        rows = summary.pareto(state.table, a, b)
        return {"points": [asdict(one) | {"values": summary.values_of(state.study, one.point)} for one in rows]}

    return await _summary(request, services, id, Compromises, make)


@router.get("/{id}/points", response_model=PointAnswers, responses=documented(404, 422))
async def get_points(
    request: Request,
    id: str,
    services: Use,
    measure: Annotated[list[str] | None, Query(max_length=20, description="Columns; default: the usual ones.")] = None,
) -> Response:
    """Return a row for each point of the design with median, or share, of each measure."""

    def make(state: State) -> dict[str, Any]:
        for name in measure or ():
            _check_measure(state, "measure", name)
        chosen = measure or (tables.usual_measures(state.table, state.study) if len(state.table) else ())
        return {"measures": list(chosen), "points": tables.point_answers(state.table, state.study, chosen)}

    return await _summary(request, services, id, PointAnswers, make)


async def _summary(
    request: Request, services: Services, id: str, model: type[BaseModel], make: Callable[[State], dict[str, Any]]
) -> Response:
    answer = await _of_study(request, services, id, lambda state: model.model_validate(make(state)))
    return Response(answer.model_dump_json(), media_type="application/json")


async def _of_study(request: Request, services: Services, id: str, make: Callable[[State], Value]) -> Value:
    return await in_turn(request, lambda: make(services.studies.state(id)))


async def _answered(request: Request, services: Services, id: str, language: str, status: int = 200) -> Response:
    by = principal_of(request.scope)
    answer = await _of_study(request, services, id, partial(_state, by=by, language=language))
    headers = {"Location": answer["links"]["self"]} if status == 202 else None
    return json_response(answer, status, headers)


def _state(state: State, by: Principal, language: str) -> dict[str, Any]:
    study, facts = state.study, state.facts
    base = f"/api/studies/{state.id}"
    experiment = study.experiment
    title = in_language(study.title, language)
    why = facts.problem and problem_documents.in_language(facts.problem, language)
    known = len(state.table) > 0
    return {
        "id": state.id,
        "title": title,
        "experiment": experiment if isinstance(experiment, str) else experiment.id,
        "status": facts.status,
        "runs": study.runs,
        "done": state.done,
        "points": study.point_count,
        "created": datetime.fromtimestamp(facts.created, UTC).isoformat().replace("+00:00", "Z"),
        "mine": by.is_machine or bool(facts.owner) and by.acts_for(facts.owner),
        "problem": why and why.model_dump(mode="json"),
        "factors": [factor.column for factor in study.vary],
        "sizes": list(summary.sizes_varied(study)),
        "measures": summary.measures(state.table, study) if known else [],
        "refused": len(state.table) - state.table.get_column("error").null_count() if known else 0,
        "links": {"self": base, **{part: f"{base}/{part}" for part in ("spec", "cancel", "points", "table.csv")}},
    }


def _check_measure(state: State, field: str, name: str) -> None:
    known = summary.measures(state.table, state.study) if len(state.table) else []
    if name not in known:
        raise invalid(field, name, Message("study.measure.unknown", name=name, names=known))


def _check_factor(state: State, field: str, name: str) -> None:
    known = [factor.column for factor in state.study.vary]
    if name not in known or not len(state.table):
        raise invalid(field, name, Message("study.factor.unknown", name=name, names=known))


def _check_number(state: State, field: str, name: str) -> None:
    _check_factor(state, field, name)
    if not state.table.schema[name].is_numeric():
        known = [one.column for one in state.study.vary if state.table.schema[one.column].is_numeric()]
        raise invalid(field, name, Message("study.factor.no-number", name=name, names=known))


def _check_who(state: State, who: str) -> None:
    known = [name.removeprefix("alarms.") for name in state.table.columns if name.startswith("alarms.")]
    if who not in known:
        raise invalid("who", who, Message("study.who.unknown", name=who, names=known))
