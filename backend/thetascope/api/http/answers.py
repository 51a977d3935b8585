"""Answers about runs: the resource, its progress, its links; wait for a result without blocking the event loop."""

import asyncio
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import TypeVar
from weakref import WeakValueDictionary

import orjson
from fastapi import Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from thetascope.api.http.computed import check_cpu, client_of
from thetascope.api.http.services import Services
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished, Job, Snapshot
from thetascope.runs.jobs.store_rows import title_of
from thetascope.runs.specs.problem_documents import in_language
from thetascope.runs.specs.refusals import NotReady
from thetascope.store import Record
from thetascope_schemas.service.run import Progress, Run

Value = TypeVar("Value")

_AT_ONCE = 2
"""Values from results that are built at a time for one client."""
_PIECE = 256 * 1024
"""Bytes of a large answer that are sent together."""


def run_links(id: str) -> dict[str, str]:
    """Return the addresses of a run's parts."""
    base = f"/api/runs/{id}"
    parts = ("progress", "data", "comparison", "figures", "report", "cancel", "pin")
    return {"self": base, **{part: f"{base}/{part}" for part in parts}}


def json_response(data: object, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    """Return plain data (NumPy arrays included) as JSON."""
    return Response(orjson.dumps(data, option=orjson.OPT_SERIALIZE_NUMPY), status, headers, "application/json")


def run_response(snapshot: Snapshot, language: str, status: int = 200) -> Response:
    """Return the answer that carries a run, its sentences in a language."""
    links = run_links(snapshot.id)
    run = Run(
        id=snapshot.id,
        status=snapshot.status,
        progress=snapshot.progress,
        spec=snapshot.spec,
        summary=snapshot.summary,
        problem=snapshot.problem and in_language(snapshot.problem, language),
        created=_time(snapshot.created),
        pinned=snapshot.pinned,
        warning=snapshot.not_stored and Message("run.not-stored", reason=snapshot.not_stored).text(language),
        links=links,
    )
    return Response(encode(run, language), status, {"Location": links["self"]}, "application/json")


def progress_response(snapshot: Snapshot, language: str, status: int = 200) -> Response:
    """Return the answer with a run's progress; Retry-After tells an active run's client when to ask again."""
    links = run_links(snapshot.id)
    detail = ""
    if snapshot.active:
        detail = Message(f"run.progress.{snapshot.status}", share=snapshot.progress).text(language)
    progress = Progress(
        id=snapshot.id,
        status=snapshot.status,
        progress=snapshot.progress,
        detail=detail,
        problem=snapshot.problem and in_language(snapshot.problem, language),
        links=links,
    )
    headers = {"Retry-After": "1"} if snapshot.active else {}
    if status == 202:
        headers["Location"] = links["self"]
    return Response(progress.model_dump_json(), status, headers, "application/json")


def listed(run: Snapshot | Record, language: str) -> dict[str, object]:
    """Return an entry of the list of runs: the run without its spec and summary."""
    created = _time(run.created).isoformat().replace("+00:00", "Z")
    return {
        "id": run.id,
        "title": title_of(run, language),
        "status": "damaged" if isinstance(run, Record) and run.damaged else run.status,
        "created": created,
        "pinned": run.pinned,
        "links": run_links(run.id),
    }


def in_pieces(content: bytes, headers: Mapping[str, str], kind: str) -> StreamingResponse:
    """Return a large answer that is sent in pieces, the next one when the last has left.

    In one piece, the event loop would copy it twice before anybody else is answered.
    """
    pieces = (content[start : start + _PIECE] for start in range(0, len(content), _PIECE))
    return StreamingResponse(pieces, 200, {**headers, "Content-Length": str(len(content))}, kind)


async def ended(job: Job, seconds: float) -> Snapshot | None:
    """Return the job's last snapshot, or None if it does not end in time. Raises InvalidSpec for a refused spec."""
    future = asyncio.wrap_future(job.done)
    done, _ = await asyncio.wait({future}, timeout=seconds)
    return future.result() if done else None


async def from_result(request: Request, services: Services, id: str, make: Callable[[Finished], Value]) -> Value:
    """Return the value that `make` builds from a run and its result in a worker thread; recompute a dropped result.

    Raises Unknown, OverLimit if it must be recomputed for a client that has used too much processor time, or NotReady
    if the run failed or does not end within the time that a request may wait.
    """

    def client() -> str:
        check_cpu(request, services)
        return client_of(request)

    def attempt() -> Value | Job:
        run = services.runs.finished(id, client)
        return run if isinstance(run, Job) else make(run)

    answer = await in_turn(request, attempt)
    if not isinstance(answer, Job):
        return answer
    job = answer
    await ended(job, services.settings.wait)
    answer = await in_turn(request, attempt)
    if isinstance(answer, Job):
        raise NotReady(Message("run.not-done", share=answer.progress, href=run_links(id)["progress"]))
    return answer


_turns: WeakValueDictionary[str, asyncio.Semaphore] = WeakValueDictionary()


async def in_turn(request: Request, work: Callable[[], Value]) -> Value:
    """Return what `work` returns in a thread; a client has few at a time, so that it never takes all."""
    client = client_of(request)
    turn = _turns.get(client)
    if turn is None:
        turn = _turns[client] = asyncio.Semaphore(_AT_ONCE)
    async with turn:
        return await run_in_threadpool(work)


def _time(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)
