"""Answers that are computed in a worker process, and end there when the client goes away."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, ParamSpec, TypeVar

from fastapi import Request
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, HTTPConnection

from thetascope.api.http.services import Services
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy

Value = TypeVar("Value")
Given = ParamSpec("Given")

_GRACE = 0.5
"""Seconds after its deadline at which a computation is given up that has not had its turn."""


def client_of(request: HTTPConnection) -> str:
    """Return the client of a request, who takes turns with others: its address."""
    return request.client.host if request.client else ""


async def computed(
    request: Request, services: Services, function: Callable[Given, Value], *args: Given.args, **kwargs: Given.kwargs
) -> Value:
    """Return the value of a module's function in a worker process; the body of the request was read before.

    Raises the function's exception, Busy, LimitReached, or ClientDisconnect.
    """
    workers, client = services.workers, client_of(request)
    computation = await run_in_threadpool(lambda: workers.call(function, *args, client=client, **kwargs))
    future = asyncio.wrap_future(computation.result)
    try:
        if await first_of(request, future, computation.limits.seconds + _GRACE):
            return future.result()
        raise Busy(Message("work.not-begun", seconds=computation.limits.seconds))
    finally:
        computation.leave()
        del computation, future  # they hold an exception that holds this frame, and with it all that it refers to


async def while_connected(request: Request, work: Coroutine[Any, Any, Value]) -> Value:
    """Return the value of work that is cancelled when the client goes away. Raises ClientDisconnect then."""
    task = asyncio.create_task(work)
    try:
        await first_of(request, task)
        return task.result()
    finally:
        task.cancel()
        del task  # it holds an exception that holds this frame


async def first_of(request: Request, future: "asyncio.Future[Any]", seconds: float | None = None) -> bool:
    """Wait for a future; return whether it is done within a time. Raises ClientDisconnect if the client goes away."""
    gone = asyncio.create_task(_gone(request))
    future.add_done_callback(_retrieved)
    try:
        done, _ = await asyncio.wait({future, gone}, timeout=seconds, return_when=asyncio.FIRST_COMPLETED)
    finally:
        gone.cancel()
    if gone in done and future not in done:
        raise ClientDisconnect
    return future in done


async def _gone(request: Request) -> None:
    """Return when the client has closed the connection."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _retrieved(future: "asyncio.Future[Any]") -> None:
    """Mark an exception as seen: the client that would get it may have gone."""
    if not future.cancelled():
        future.exception()
