"""/api/classroom/seat: a student joins a room by its code, votes and answers. No access key is needed.

The student's token opens the student's own seat and nothing else: no other student, no answer of others, no truth.
"""

import asyncio
import math
from typing import Annotated

from fastapi import APIRouter, Header, Request
from starlette.responses import Response
from starlette.routing import WebSocketRoute

from thetascope.access.wrong_keys import WrongKeys
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.api.routes.classroom.streams import CurveStream, SeatStream
from thetascope.api.sign_in.presented import presented
from thetascope.classroom.room import Room
from thetascope.classroom.room_views import seat_view
from thetascope.messages import Message
from thetascope.runs.specs.refusals import OverLimit, Unknown
from thetascope_schemas.service.classroom.requests import AnswerRequest, JoinRequest, NameRequest, VoteRequest
from thetascope_schemas.service.classroom.views import JoinedRoom, SeatView

router = APIRouter(prefix="/classroom", tags=["classroom"])
router.routes.append(WebSocketRoute("/classroom/seat/stream", SeatStream()))
router.routes.append(WebSocketRoute("/classroom/seat/curves", CurveStream()))

SeatToken = Annotated[str, Header(alias="X-Seat-Token", description="The student's token.")]
_NONE = {"Cache-Control": "no-store"}
_wrong_codes = WrongKeys()
"""Wrong codes of each address: they are answered later the more of them have come. A right one is never delayed."""


@router.post(
    "/join",
    status_code=201,
    response_model=JoinedRoom,
    openapi_extra=body_schema("JoinRequest"),
    responses=documented(404, 413, 415, 422, 429),
)
async def join_room(request: Request, services: Use) -> Response:
    """Join a room by its code. The token keeps the place: a page that is loaded again shows it with it."""
    body = await parsed_as(request, services, JoinRequest)
    room = await _room(request, services, body.code)
    student, token = services.rooms.join(room)
    joined = JoinedRoom(token=token, seat=seat_view(room, student))
    return Response(joined.model_dump_json(), 201, _NONE, "application/json")


@router.get("/seat", response_model=SeatView, responses=documented(404))
async def get_seat(services: Use, token: SeatToken = "") -> Response:
    """Return what the student's phone shows; the stream sends the same after every change."""
    return _seat(services, token)


@router.delete("/seat", status_code=204, response_model=None, responses=documented(404))
async def leave_room(services: Use, token: SeatToken = "") -> Response:
    """Leave the room. Its votes and answers are kept for the class's counts, without a name."""
    room, student = services.rooms.seat(token)
    services.rooms.remove(room, student.id)
    return Response(status_code=204)


@router.put(
    "/seat/name",
    response_model=SeatView,
    openapi_extra=body_schema("NameRequest"),
    responses=documented(404, 413, 415, 422),
)
async def choose_name(request: Request, services: Use, token: SeatToken = "") -> Response:
    """Choose a name, or another animal."""
    room, student = services.rooms.seat(token)
    body = await parsed_as(request, services, NameRequest)
    room.rename(student, body.name, services.rooms.now())
    return _seat(services, token)


@router.put(
    "/seat/vote",
    response_model=SeatView,
    openapi_extra=body_schema("VoteRequest"),
    responses=documented(404, 409, 413, 415, 422),
)
async def vote(request: Request, services: Use, token: SeatToken = "") -> Response:
    """Vote for an answer of the step that the teacher shows, or change the vote, until the step is run."""
    room, student = services.rooms.seat(token)
    body = await parsed_as(request, services, VoteRequest)
    room.vote(student, body.step, body.choice, services.rooms.now())
    return _seat(services, token)


@router.put(
    "/seat/answer",
    response_model=SeatView,
    openapi_extra=body_schema("AnswerRequest"),
    responses=documented(404, 409, 413, 415, 422),
)
async def answer(request: Request, services: Use, token: SeatToken = "") -> Response:
    """Say what the hidden fault is, or that it cannot be told, or change that, until the time is up."""
    room, student = services.rooms.seat(token)
    body = await parsed_as(request, services, AnswerRequest)
    room.answer(student, body, services.rooms.now())
    return _seat(services, token)


async def _room(request: Request, services: Services, code: str) -> Room:
    """Return the room with a code; a wrong one is answered late. Raises Unknown, OverLimit."""
    room = services.rooms.with_code(code)
    if room is not None:
        return room
    address = presented(request).address
    seconds = _wrong_codes.count(address)
    if not _wrong_codes.wait(address):
        raise OverLimit(Message("classroom.guesses"), max(1, math.ceil(seconds)))
    try:
        await asyncio.sleep(seconds)
    finally:
        _wrong_codes.answered(address)
    raise Unknown(Message("classroom.no-code", code=code[:20]))


def _seat(services: Services, token: str) -> Response:
    room, student = services.rooms.seat(token)
    return Response(seat_view(room, student).model_dump_json(), 200, _NONE, "application/json")
