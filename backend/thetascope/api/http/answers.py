"""Answers about runs: the resource, its progress, its links; wait for a result without blocking the event loop."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping
from datetime import UTC, datetime
from functools import partial
from typing import TypeVar
from weakref import WeakValueDictionary

import orjson
from fastapi import Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from thetascope.api.http.computed import check_cpu, client_of, while_connected
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

_UNSENT = 2
"""Answers of one client that are kept in memory until they are sent."""
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


class InPieces(StreamingResponse):
    """An answer in pieces; `sent` is called once when it is sent, or cannot be."""

    sent: Callable[[], None] = staticmethod(lambda: None)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the answer."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self.sent()


def in_pieces(content: bytes, headers: Mapping[str, str], kind: str) -> InPieces:
    """Return a large answer that is sent in pieces, the next one when the last has left.

    In one piece, the event loop would copy it twice before anybody else is answered.
    """
    pieces = (content[start : start + _PIECE] for start in range(0, len(content), _PIECE))
    return InPieces(pieces, 200, {**headers, "Content-Length": str(len(content))}, kind)


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


class _Turns:
    """What one client may have: one answer at a time is made, as two need Python's lock alternately, and few wait."""

    def __init__(self) -> None:
        self.making, self.unsent = asyncio.Semaphore(1), asyncio.Semaphore(_UNSENT)


_turns: WeakValueDictionary[str, _Turns] = WeakValueDictionary()


def _turns_of(request: Request) -> _Turns:
    client = client_of(request)
    turns = _turns.get(client)
    if turns is None:
        turns = _turns[client] = _Turns()
    return turns


async def in_turn(request: Request, work: Callable[[], Value]) -> Value:
    """Return what `work` returns in a thread, one after the other for each client, so that none takes all threads.

    Raises ClientDisconnect if the client goes away; work that has not begun is then never done.
    """
    return await while_connected(request, _made(_turns_of(request), work))


async def _made(turns: _Turns, work: Callable[[], Value]) -> Value:
    async with turns.making:
        return await run_in_threadpool(work)


async def pieces_in_turn(request: Request, pieces: Iterator[bytes]) -> AsyncIterator[bytes]:
    """Yield pieces that are made as they are sent, each in a turn of the client's: its downloads share one thread."""
    turns = _turns_of(request)
    while (piece := await _made(turns, partial(next, pieces, None))) is not None:
        yield piece


def _release(turns: _Turns) -> None:
    turns.unsent.release()


async def kept_until_sent(request: Request, answer: Callable[[], Awaitable[Response]]) -> Response:
    """Return an answer that is in memory in full until it is sent; a client has few of them, also if it reads slowly.

    Raises what `answer` raises, or ClientDisconnect.
    """
    turns = _turns_of(request)
    await while_connected(request, turns.unsent.acquire())
    try:
        made = await answer()
    except BaseException:
        turns.unsent.release()
        raise
    if isinstance(made, InPieces):
        made.sent = partial(_release, turns)  # which keeps the turns of the client
    else:
        turns.unsent.release()
    return made


def _time(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)
