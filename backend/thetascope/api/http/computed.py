"""Answers that are computed in a worker process, and end there when the client goes away."""

import asyncio
from collections.abc import Callable, Coroutine
from functools import partial
from typing import Any, ParamSpec, TypeVar

from fastapi import Request
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, HTTPConnection

from thetascope.access.client_limits import ClientLimits, limits_of
from thetascope.access.principal import principal_of
from thetascope.api.http.services import Services
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy, OverLimit
from thetascope.runs.workers.computation import Computation

Value = TypeVar("Value")
Given = ParamSpec("Given")

_GRACE = 0.5
"""Seconds after its deadline at which a computation is given up that has not had its turn."""


def client_of(request: HTTPConnection) -> str:
    """Return the client of a request, who takes turns with others: its browser or script, or its address."""
    return principal_of(request.scope).client


def limits_for(request: HTTPConnection, services: Services) -> ClientLimits:
    """Return the limits of the client of a request."""
    return limits_of(services.settings, principal_of(request.scope))


def check_cpu(request: HTTPConnection, services: Services) -> None:
    """Raise OverLimit for a client whose computations have used as much processor time within a minute as they may."""
    most = limits_for(request, services).cpu
    if most is not None:
        used, wait = services.workers.over(client_of(request), most)
        if wait > 0:
            raise OverLimit(Message("client.cpu", used=used, limit=most), wait)


async def computed(
    request: Request, services: Services, function: Callable[Given, Value], *args: Given.args, **kwargs: Given.kwargs
) -> Value:
    """Return the value of a module's function in a worker process; the body of the request was read before.

    Raises the function's exception, Busy, OverLimit, LimitReached, or ClientDisconnect.
    """
    return await _computed(request, services, partial(services.workers.call, function, *args, **kwargs))


async def computed_for_library(
    request: Request, services: Services, function: Callable[Given, Value], *args: Given.args, **kwargs: Given.kwargs
) -> Value:
    """Return the same for something of the library, which is known to end: it may take longer on a busy machine."""
    return await _computed(request, services, partial(services.workers.call, function, *args, **kwargs, trusted=True))


async def _computed(request: Request, services: Services, submit: Callable[..., Computation]) -> Any:
    check_cpu(request, services)
    client = client_of(request)
    computation = await run_in_threadpool(lambda: submit(client=client))
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
