"""The websockets of classrooms: the state of wall and seats, and curves. A state replaces the one before it.

A page offers the subprotocols SUBPROTOCOL and TOKEN + its token, and sends anything every few seconds while it is
awake. One that has said nothing for a while is taken for a laptop that sleeps: it keeps its place, and gets the whole
state again when it returns.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from contextlib import suppress

from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from thetascope.api.http.language import language_of
from thetascope.api.http.services import Services
from thetascope.classroom.curves import CurveSocket, OwnRecord
from thetascope.classroom.faults.own_round import OwnRound
from thetascope.classroom.people.listeners import Listener
from thetascope.classroom.room_views import seat_view, wall_view
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Unknown
from thetascope_schemas.service.classroom.requests import CLOSE_TOKEN
from thetascope_schemas.service.session import SUBPROTOCOL, TOKEN

log = logging.getLogger(__name__)

_LOST = (WebSocketDisconnect, RuntimeError, OSError)
"""Errors of a connection that is lost."""
SILENCE = 25.0
"""Seconds without a word from a page after which its connection is closed."""
_BETWEEN = 0.05
"""Seconds between two words of a page that are read: more are read more slowly."""
_PATIENCE = 2.0


class WallStream:
    """The route of the wall."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one wall until it closes."""
        websocket, services, token = await _accepted(scope, receive, send)
        try:
            room = services.rooms.of_teacher(token)
        except Unknown as error:
            await _close(websocket, CLOSE_TOKEN, error.problem)
            return
        listener = Listener(lambda: wall_view(room))
        room.watch(listener)
        try:
            await _serve(websocket, lambda: _states(websocket, listener))
        finally:
            room.unwatch(listener)
        await _ended(websocket, listener)


class SeatStream:
    """The route of a student's seat."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one phone until it closes."""
        websocket, services, token = await _accepted(scope, receive, send)
        try:
            room, student = services.rooms.seat(token)
        except Unknown as error:
            await _close(websocket, CLOSE_TOKEN, error.problem)
            return
        listener = Listener(lambda: seat_view(room, student))
        room.arrive(student, listener)
        try:
            await _serve(websocket, lambda: _states(websocket, listener))
        finally:
            room.depart(student, listener, services.rooms.now())
        await _ended(websocket, listener)


class CurveStream:
    """The route of the curves of a student's seat."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send curves to one phone until it closes."""
        websocket, services, token = await _accepted(scope, receive, send)
        try:
            room, student = services.rooms.seat(token)
        except Unknown as error:
            await _close(websocket, CLOSE_TOKEN, error.problem)
            return
        socket = CurveSocket()
        curves = room.curves
        curves.connect(socket)
        student.sockets.add(socket)

        def own() -> OwnRecord | None:
            now = services.rooms.now
            return OwnRecord(room.round, student.id, now) if isinstance(room.round, OwnRound) else None

        async def frames() -> None:
            while True:
                for data in await socket.next(curves, own()):
                    if isinstance(data, str):
                        await send({"type": "websocket.send", "text": data})
                    else:
                        await send({"type": "websocket.send", "bytes": data})

        try:
            await _serve(websocket, frames)
        finally:
            curves.disconnect(socket)
            student.sockets.discard(socket)


async def _accepted(scope: Scope, receive: Receive, send: Send) -> tuple[WebSocket, Services, str]:
    """Accept a connection before any check: otherwise browsers do not pass the close code to the page."""
    websocket = WebSocket(scope, receive, send)
    offered: list[str] = scope.get("subprotocols", [])
    await websocket.accept(SUBPROTOCOL if SUBPROTOCOL in offered else None)
    token = next((name.removeprefix(TOKEN) for name in offered if name.startswith(TOKEN)), "")
    return websocket, websocket.app.state.services, token


async def _states(websocket: WebSocket, listener: Listener) -> None:
    while (state := await listener.next()) is not None:
        await websocket.send_text(state)
        await listener.pause()


async def _serve(websocket: WebSocket, write: Callable[[], Awaitable[None]]) -> None:
    """Write, and read that the page is awake, until either ends."""
    tasks = {asyncio.ensure_future(write()), asyncio.create_task(_awake(websocket))}
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        for outcome in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(outcome, Exception) and not isinstance(outcome, _LOST):
                log.error("a stream of a classroom failed", exc_info=outcome)


async def _awake(websocket: WebSocket) -> None:
    """Return when the page has gone, or has said nothing for long."""
    with suppress(TimeoutError, WebSocketDisconnect):
        while True:
            async with asyncio.timeout(SILENCE):
                message = await websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            await asyncio.sleep(_BETWEEN)


async def _ended(websocket: WebSocket, listener: Listener) -> None:
    """Close a connection whose room has ended, or whose student was removed."""
    if listener.closing is not None:
        with suppress(Exception):  # the connection may be lost or blocked
            await asyncio.wait_for(_close(websocket, listener.closing, Message("classroom.ended")), _PATIENCE)


async def _close(websocket: WebSocket, code: int, reason: Message) -> None:
    with suppress(RuntimeError):
        await websocket.close(code, reason.text(language_of(websocket)))
