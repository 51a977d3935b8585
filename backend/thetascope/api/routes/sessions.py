"""/api/sessions: open, fork, save, read and end live sessions. The websocket is in session_stream.py."""

from collections.abc import Callable
from math import ceil, floor
from typing import Annotated, Any, Literal
from urllib.parse import quote

from fastapi import APIRouter, Header, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse
from starlette.routing import WebSocketRoute

from thetascope.access.principal import principal_of
from thetascope.api.http.answers import (
    ended,
    in_pieces,
    in_turn,
    json_response,
    kept_until_sent,
    pieces_in_turn,
    progress_response,
    run_response,
)
from thetascope.api.http.computed import (
    check_cpu,
    client_of,
    computed,
    computed_for_library,
    limits_for,
    while_connected,
)
from thetascope.api.http.language import Language
from thetascope.api.http.problems import PROBLEM, documented, problem_response
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.request_bodies import ForkRequest, SessionRequest
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.api.processes.others import elsewhere, get
from thetascope.api.routes import table_query
from thetascope.api.routes.session_stream import Stream, matches
from thetascope.engine.errors import SpecError, Unwatchable
from thetascope.export import MEDIA_TYPES, Table, csv_chunks, indices, json_chunks, matlab_bytes
from thetascope.live.facts.window_comparison import window_comparison, window_table
from thetascope.live.room.advice import propose_input_for
from thetascope.live.scheduling.hub import TooManySessions
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.specs.problem_documents import problem
from thetascope.runs.specs.refusals import NotReady, Unknown, from_engine, invalid
from thetascope_schemas.experiment.base import MAX_TIME
from thetascope_schemas.experiment.diagnosis import InputProposal
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment
from thetascope_schemas.service.answers import SessionOpened, SessionState
from thetascope_schemas.service.comparison import WindowComparison, WindowTable
from thetascope_schemas.service.facts import Facts
from thetascope_schemas.service.run import Progress, Run
from thetascope_schemas.texts.local_text import ALL
from thetascope_schemas.texts.refusal import suggestion

router = APIRouter(prefix="/sessions", tags=["sessions"])
router.routes.append(WebSocketRoute("/sessions/{id}/stream", Stream()))  # appended directly: no prefix is added

_FORBIDDEN = {403: {"description": "The control token is not this session's.", "content": PROBLEM}}
ControlToken = Annotated[str, Header(alias="X-Control-Token", description="The token that the session's opener got.")]


def links(id: str) -> dict[str, str]:
    """Return the addresses of a session's parts."""
    base = f"/api/sessions/{id}"
    return {
        "self": base,
        **{part: f"{base}/{part}" for part in ("stream", "fork", "save", "data", "comparison", "facts")},
    }


@router.post(
    "",
    status_code=201,
    response_model=SessionOpened,
    openapi_extra=body_schema("SessionRequest"),
    responses=documented(404, 413, 415, 422, 429, 503),
)
async def create_session(request: Request, services: Use, language: Language) -> Response:
    """Open a session. The token grants control; the address without it permits viewing only."""
    body = await parsed_as(request, services, SessionRequest)

    async def rehearse(spec: ResolvedExperiment) -> None:
        from thetascope.live.scheduling.rehearsal import rehearse_opening  # imports SymPy

        compute = computed_for_library if body.is_library else computed
        await compute(request, services, rehearse_opening, spec, services.settings.session_rows)

    client, most = client_of(request), limits_for(request, services).sessions
    read = await _reader(request, services, body)
    opening = services.live.create(read, body.t, body.play, body.speed, rehearse, client, most)
    try:
        return _opened(await while_connected(request, opening))
    except TooManySessions:
        return _full(services, language)


async def _reader(request: Request, services: Services, body: SessionRequest) -> Callable[[], ResolvedExperiment]:
    """Return the function that gives a session's experiment; of a record its rows are read in a worker process."""
    if body.spec is None or body.spec.truth.record is None:
        return body.resolved
    from thetascope.assembly import with_rows_and_diagnosis  # imports the engine

    spec = await run_in_threadpool(body.resolved)
    spec = await run_in_threadpool(services.with_record, spec)
    try:
        whole = await computed(request, services, with_rows_and_diagnosis, spec)
    except SpecError as error:
        raise from_engine(error) from None
    return lambda: whole


@router.get("/{id}", response_model=SessionState, responses=documented(404))
async def get_session(id: str, services: Use, language: Language) -> Response:
    """Return the status of a session, and its experiment with all commands so far."""
    room = _room(services, id)
    status = room.status()
    return json_response(
        {
            "id": room.id,
            "spec": room.session.spec.model_dump(mode="json", context={"language": language}),
            "row": status.row,
            "t": status.t,
            "playing": status.playing,
            "speed": status.speed,
            "viewers": status.viewers,
            "ended": status.ended,
            "parent": room.parent,
            "links": links(room.id),
        }
    )


@router.delete("/{id}", status_code=204, response_model=None, responses={**documented(404), **_FORBIDDEN})
async def end_session(
    request: Request, id: str, services: Use, language: Language, token: ControlToken = ""
) -> Response:
    """End a session for all its viewers."""
    room = _room(services, id)
    if not matches(token, room.token):
        return _wrong_token(language)
    services.live.close(room)
    audit(request, "session.ended", session=id)
    return Response(status_code=204)


@router.post(
    "/{id}/fork",
    status_code=201,
    response_model=SessionOpened,
    openapi_extra=body_schema("ForkRequest"),
    responses=documented(404, 413, 422, 429, 503),
)
async def fork_session(request: Request, id: str, services: Use, language: Language) -> Response:
    """Open a second session with the same past up to now, or up to `t`. It has its own token."""
    room = _room(services, id)
    body = await _optional(request, services)
    if body.t is not None and body.t > room.t + 0.5 * room.session.record:
        raise invalid("t", body.t, Message("session.fork.beyond-now", t=room.t))
    try:
        most = limits_for(request, services).sessions
        return _opened(await services.live.fork(room, body.t, client_of(request), most))
    except TooManySessions:
        return _full(services, language)


@router.post(
    "/{id}/save",
    status_code=201,
    response_model=Run,
    responses={
        200: {"model": Run, "description": "The same was saved before."},
        202: {"model": Progress, "description": "It takes longer: `Location` is the run."},
        **documented(404, 409, 422, 429, 503),
        **_FORBIDDEN,
    },
)
async def save_session(
    request: Request, id: str, services: Use, language: Language, token: ControlToken = ""
) -> Response:
    """Save the session up to now as an ordinary run with exactly the same numbers."""
    process = elsewhere(services.settings, id)
    if process is None:
        spec = _spec_to_save(services, id, token)
    else:
        path = f"/api/sessions/{quote(id)}/to-save"
        answer = await run_in_threadpool(get, services.settings, process, path, request)
        if answer.status != 200:
            return Response(answer.body, answer.status, media_type=answer.media_type)
        spec = await run_in_threadpool(ResolvedExperiment.model_validate_json, answer.body)
    if spec is None:
        return _wrong_token(language)
    check_cpu(request, services)
    most = limits_for(request, services).runs
    started = await run_in_threadpool(services.runs.submit, spec, principal_of(request.scope), most)
    if isinstance(started, Snapshot):
        await run_in_threadpool(services.notebook.saved_from_live, started.id)
        return run_response(started, language)
    snapshot = await ended(started, services.settings.wait)
    if snapshot is None:
        await run_in_threadpool(services.runs.announce, started)
    await run_in_threadpool(services.notebook.saved_from_live, started.id)
    if snapshot is not None:
        return run_response(snapshot, language, 201)
    return progress_response(started.snapshot(), language, 202)


@router.get("/{id}/to-save", include_in_schema=False)
def get_spec_to_save(id: str, services: Use, language: Language, token: ControlToken = "") -> Response:
    """Return the experiment that is run to save a session, for the process that owns the store."""
    spec = _spec_to_save(services, id, token)
    if spec is None:
        return _wrong_token(language)
    return Response(spec.model_dump_json(context={"language": ALL}), media_type="application/json")


@router.get("/{id}/facts", response_model=Facts, responses=documented(404, 422))
async def get_facts(
    id: str,
    services: Use,
    language: Language,
    t: Annotated[
        float | None, Query(ge=0, le=MAX_TIME, allow_inf_nan=False, description="Time in s; the present by default.")
    ] = None,
) -> Response:
    """Return the facts of the session at a time: alarms are those that had been raised by then, as they were then."""
    room = _room(services, id)
    row = room.shown if t is None else min(room.shown, round(t / room.session.record) + 1)
    return Response(encode(room.facts.past(row), language), media_type="application/json")


@router.post("/{id}/proposal", response_model=InputProposal, responses=documented(404, 409))
async def propose_input(id: str, services: Use, language: Language) -> Response:
    """Propose an input that separates the faults, tested on the plant from the session's present state.

    The request takes about a second.
    """
    room = _room(services, id)
    try:
        proposed = await propose_input_for(room)
    except Unwatchable as error:
        raise NotReady(Message("session.no-proposal", reason=error.args[0])) from None
    return Response(encode(proposed, language), media_type="application/json")


@router.get("/{id}/comparison", response_model=WindowComparison, responses=documented(404, 422))
async def compare_observers(
    id: str,
    services: Use,
    start: table_query.First = None,
    end: table_query.Last = None,
    state: Annotated[str | None, Query(max_length=32, description="The state whose error is measured.")] = None,
    channel: Annotated[str | None, Query(max_length=32, description="The fault channel.")] = None,
) -> WindowComparison:
    """Return error, noise and time to settle of every observer over a window, and whether the newest fault is found."""
    room = _room(services, id)
    table_query.check(start, end)
    plant = room.session.spec.plant
    for field, name, known in (("state", state, plant.names("states")), ("channel", channel, plant.names("channels"))):
        if name is not None and name not in known:
            raise invalid(
                field, name, Message(f"plant.{field}.unknown", name=name), Message.from_data(suggestion(name, known))
            )
    return await window_comparison(room, start, end, state, channel)


@router.get("/{id}/comparison/table", response_model=WindowTable, responses=documented(404, 422))
async def tabulate_observers(
    id: str, services: Use, start: table_query.First = None, end: table_query.Last = None
) -> WindowTable:
    """Return error, noise and time to settle of every estimate of every observer over a window."""
    room = _room(services, id)
    table_query.check(start, end)
    return await window_table(room, start, end)


@router.get(
    "/{id}/data",
    response_class=Response,
    responses={200: table_query.tables("json", "csv", "mat"), **documented(404, 422)},
)
async def get_session_data(
    request: Request,
    id: str,
    services: Use,
    start: table_query.First = None,
    end: table_query.Last = None,
    every: Annotated[int, Query(ge=1, description="Return every n-th row.")] = 1,
    columns: table_query.Names = None,
    format: Annotated[
        Literal["json", "bdata", "csv", "mat"], Query(description="bdata: JSON with base64 of float64.")
    ] = "json",
) -> Response:
    """Return the past as it was displayed: float32, in the present columns. Save the session to get all digits."""
    room = _room(services, id)
    table_query.check(start, end)
    record, shown, present = room.session.record, room.shown, room.broadcast.columns
    chosen = present if columns is None else tuple(present[i] for i in indices(present, columns.split(",")))
    first = min(shown, max(room.oldest, 0 if start is None else ceil(start / record - 1e-6)))
    last = shown if end is None else max(first, min(shown, floor(end / record + 1e-6) + 1))
    rows = await room.past_rows(chosen, first, last)
    table = await in_turn(request, lambda: Table(chosen, rows[:, ::every].astype(float)))
    if format == "csv":
        chunks = pieces_in_turn(request, csv_chunks(table))
        return StreamingResponse(chunks, 200, _named(id, "csv"), MEDIA_TYPES["csv"])
    if format == "mat":

        def written() -> Response:
            return in_pieces(matlab_bytes(table), _named(id, "mat"), MEDIA_TYPES["mat"])

        return await kept_until_sent(request, lambda: in_turn(request, written))
    chunks = pieces_in_turn(request, json_chunks(table, "bdata" if format == "bdata" else "plain"))
    return StreamingResponse(chunks, 200, {}, MEDIA_TYPES["json"])


def _room(services: Services, id: str) -> Any:
    room = services.live.find(id)
    if room is None:
        raise Unknown(Message("session.unknown", id=id[:64]))
    return room


def _spec_to_save(services: Services, id: str, token: str) -> Experiment | None:
    """Return the experiment of a session up to now; None for a wrong token. Raises Unknown, NotReady."""
    room = _room(services, id)
    if not matches(token, room.token):
        return None
    if room.shown < 2:
        raise NotReady(Message("session.not-begun"))
    return room.spec()


def _opened(room: Any) -> Response:
    answer = {"id": room.id, "token": room.token, "parent": room.parent, "links": links(room.id)}
    return json_response(answer, 201, {"Location": links(room.id)["self"], "Cache-Control": "no-store"})


def _wrong_token(language: str) -> Response:
    return problem_response(problem(403, Message("session.token.wrong"), language=language))


def _full(services: Services, language: str) -> Response:
    why = Message("session.too-many", n=services.settings.sessions)
    return problem_response(problem(503, why, language=language), {"Retry-After": "10"})


def _named(id: str, suffix: str) -> dict[str, str]:
    return {"Content-Disposition": f'attachment; filename="session-{id[:8]}.{suffix}"'}


async def _optional(request: Request, services: Services) -> ForkRequest:
    """Return the body of a fork, which may be left out."""
    if request.headers.get("content-length", "0") == "0" and "transfer-encoding" not in request.headers:
        return ForkRequest()
    return await parsed_as(request, services, ForkRequest)
