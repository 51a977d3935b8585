"""/api/sessions/{id}/stream: the websocket of a live session; thetascope_schemas.service.session has its messages."""

import asyncio
import secrets
from contextlib import suppress

from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket

from thetascope.api.http.computed import client_of
from thetascope.api.http.language import language_of
from thetascope.api.http.services import Services
from thetascope.messages import Message
from thetascope_schemas.service.session import (
    CLOSE_FULL,
    CLOSE_NO_SESSION,
    CLOSE_TOKEN,
    SUBPROTOCOL,
    TOKEN,
)
from thetascope_schemas.texts.local_text import ALL

_PATIENCE = 2.0
"""Seconds within which a connection must accept its close frame."""


class Stream:
    """The route's ASGI application: frames go directly to the server, without a layer that inspects them."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one websocket until it closes."""
        await _stream(WebSocket(scope, receive, send), send)


async def _stream(websocket: WebSocket, send: Send) -> None:
    """Serve one viewer.

    The token in the offered subprotocols grants control. `?after=` is the last frame received, `?lang=` the viewer's
    language; with `?lang=*` prose comes in all languages, as maps.
    """
    services: Services = websocket.app.state.services
    # Accepted before any check: otherwise browsers do not pass the close code to the page.
    offered: list[str] = websocket.scope.get("subprotocols", [])
    await websocket.accept(SUBPROTOCOL if SUBPROTOCOL in offered else None)
    room = services.live.find(websocket.path_params["id"])
    if room is None:
        await _close(websocket, CLOSE_NO_SESSION, Message("session.close.no-session"))
        return
    token = next((name.removeprefix(TOKEN) for name in offered if name.startswith(TOKEN)), None)
    if token is not None and not matches(token, room.token):
        await _close(websocket, CLOSE_TOKEN, Message("session.close.token"))
        return
    from thetascope.live.room.room import RoomFull
    from thetascope.live.wire.viewer import Viewer

    async def send_text(text: str) -> None:
        await send({"type": "websocket.send", "text": text})

    async def send_samples(data: bytes) -> None:
        await send({"type": "websocket.send", "bytes": data})

    loop = asyncio.get_running_loop()
    language = ALL if websocket.query_params.get("lang") == ALL else language_of(websocket)
    viewer = Viewer(send_text, send_samples, token is not None, loop, language, client_of(websocket))
    await services.live.viewer_slot()
    try:
        room.join(viewer, _number(websocket.query_params.get("after")))
    except RoomFull:
        await _close(websocket, CLOSE_FULL, Message("session.close.full"))
        return
    try:
        await _serve(websocket, room, viewer, services)
    finally:
        room.leave(viewer)
    if viewer.closing is not None:
        with suppress(Exception):  # the connection may be lost or blocked
            await asyncio.wait_for(_close(websocket, *viewer.closing), _PATIENCE)


async def _close(websocket: WebSocket, code: int, reason: Message) -> None:
    """Close a connection with a code and the reason in the viewer's language."""
    await websocket.close(code, reason.text(language_of(websocket)))


async def _serve(websocket: WebSocket, room, viewer, services: Services) -> None:
    """Read and write until either ends."""
    tasks = {
        asyncio.create_task(_read(websocket, room, viewer, services.settings)),
        asyncio.create_task(viewer.run(room)),
    }
    closing = asyncio.create_task(viewer.closed.wait())
    try:
        await asyncio.wait({*tasks, closing}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (*tasks, closing):
            task.cancel()
        await asyncio.gather(*tasks, closing, return_exceptions=True)


async def _read(websocket: WebSocket, room, viewer, settings) -> None:
    """Handle the viewer's messages, at most at the rate that it may send them."""
    from thetascope.live.wire.messages import Allowance

    clock = asyncio.get_running_loop().time
    allowance = Allowance(settings.message_rate, clock())
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect":
            return
        text = message.get("text")
        if (wait := allowance.wait(clock(), min(len(text or ""), settings.max_message))) > 0:
            await asyncio.sleep(wait)
        room.commands.receive(viewer, text, settings.max_message)


def matches(given: str, token: str) -> bool:
    """Compare in a time that does not depend on the position of the first difference."""
    return secrets.compare_digest(given.encode(), token.encode())


def _number(text: str | None) -> int | None:
    """Return the number of a frame; None for a text that is not a number."""
    return int(text) if text is not None and text.isascii() and text.isdigit() and len(text) < 20 else None
