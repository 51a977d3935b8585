"""/api/classroom/room: a teacher opens a room, shows a session in it, and ends it. The token is the teacher's."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Request
from starlette.responses import Response
from starlette.routing import WebSocketRoute

from thetascope import library
from thetascope.api.http.computed import client_of
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.api.processes.others import elsewhere, stream
from thetascope.api.routes.classroom.join_address import join_address, qr_rows
from thetascope.api.routes.classroom.streams import WallStream
from thetascope.classroom.curves import Shown
from thetascope.classroom.result_table import csv_of
from thetascope.classroom.room import Room
from thetascope.classroom.room_views import replay_of, wall_view
from thetascope.export import MEDIA_TYPES
from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.service.classroom.requests import LeadRequest, RoundRequest
from thetascope_schemas.service.classroom.views import ClassSetup, ClassSetups, Replay, RoomOpened, WallView

router = APIRouter(prefix="/classroom", tags=["classroom"])
router.routes.append(WebSocketRoute("/classroom/room/stream", WallStream()))

TeacherToken = Annotated[str, Header(alias="X-Teacher-Token", description="The token of the room's teacher.")]
_NONE = {"Cache-Control": "no-store"}


@router.post("", status_code=201, response_model=RoomOpened, responses=documented(429))
async def open_room(request: Request, services: Use) -> Response:
    """Open a room. Nothing of it is stored: it ends with the service, or when nobody uses it."""
    room, token = services.rooms.open(client_of(request))
    audit(request, "classroom.opened")
    return _answer(room_opened(request, services, room, token), 201)


@router.get("/setups", response_model=ClassSetups)
def list_setups() -> Response:
    """Return the plants of the library in which faults can be hidden."""
    setups = tuple(ClassSetup(id=setup.id, title=setup.title) for setup in library.mysteries().values())
    return _answer(ClassSetups(setups=setups))


@router.get("/room", response_model=RoomOpened, responses=documented(404))
async def get_room(request: Request, services: Use, token: TeacherToken = "") -> Response:
    """Return code, address and QR code of the teacher's room."""
    return _answer(room_opened(request, services, services.rooms.of_teacher(token), token))


@router.get("/room/wall", response_model=WallView, responses=documented(404))
async def get_wall(services: Use, token: TeacherToken = "") -> Response:
    """Return what the wall shows; the stream sends the same after every change."""
    return _answer(wall_view(services.rooms.of_teacher(token)))


@router.delete("/room", status_code=204, response_model=None, responses=documented(404))
async def close_room(request: Request, services: Use, token: TeacherToken = "") -> Response:
    """End the room, and forget its students, votes and answers."""
    room = services.rooms.of_teacher(token)
    services.rooms.close(room)
    audit(request, "classroom.closed")
    return Response(status_code=204)


@router.post(
    "/room/rounds",
    status_code=201,
    response_model=WallView,
    openapi_extra=body_schema("RoundRequest"),
    responses=documented(404, 413, 415, 422),
)
async def begin_round(request: Request, services: Use, token: TeacherToken = "") -> Response:
    """Begin a round; it ends the one before."""
    room = services.rooms.of_teacher(token)
    body = await parsed_as(request, services, RoundRequest)
    if body.kind == "follow":
        room.begin(services.rooms.now())
    else:
        setups = library.mysteries()
        setup = setups.get(body.setup or next(iter(setups)))
        if setup is None:
            raise invalid("setup", body.setup, Message("classroom.no-setup"), Message("suggest.all", names=[*setups]))
        services.rooms.begin_own(room, setup, float(body.seconds))
    return _answer(wall_view(room), 201)


@router.post("/room/reveal", response_model=WallView, responses=documented(404, 409))
async def reveal(services: Use, token: TeacherToken = "") -> Response:
    """Show the hidden faults now; otherwise they are shown when the time is up."""
    room = services.rooms.of_teacher(token)
    room.reveal(services.rooms.now())
    return _answer(wall_view(room))


@router.get("/room/students/{id}/replay", response_model=Replay, responses=documented(404, 409))
async def get_replay(id: str, services: Use, token: TeacherToken = "") -> Response:
    """Return a student's record as far as it was played, with answer and outcome."""
    return _answer(replay_of(services.rooms.of_teacher(token), id))


@router.post(
    "/room/lead",
    status_code=204,
    response_model=None,
    openapi_extra=body_schema("LeadRequest"),
    responses=documented(404, 409, 413, 415, 422),
)
async def show_session(request: Request, services: Use, token: TeacherToken = "") -> Response:
    """Show a session, and perhaps a step of a lesson, to all who follow. After `phase: after` the votes are marked."""
    room = services.rooms.of_teacher(token)
    body = await parsed_as(request, services, LeadRequest)
    room.show(body, services.rooms.now(), _session(request, services, body.session))
    return Response(status_code=204)


@router.delete("/room/students/{id}", status_code=204, response_model=None, responses=documented(404))
async def remove_student(id: str, services: Use, token: TeacherToken = "") -> Response:
    """Remove a student from the room."""
    services.rooms.remove(services.rooms.of_teacher(token), id)
    return Response(status_code=204)


@router.get(
    "/room/results",
    response_class=Response,
    responses={200: {"description": "A row for each student and question.", "content": {"text/csv": {}}}}
    | documented(404),
)
async def get_results(services: Use, token: TeacherToken = "") -> Response:
    """Return the votes and answers of all rounds as CSV, for a gradebook."""
    room = services.rooms.of_teacher(token)
    named = {"Content-Disposition": f'attachment; filename="room-{room.code}.csv"'}
    return Response(csv_of(room), 200, named | _NONE, MEDIA_TYPES["csv"])


def _session(request: Request, services: Services, id: str) -> Shown | None:
    """Return a session of this or another process; None if there is none such."""
    process = elsewhere(services.settings, id)
    if process is None:
        return services.live.find(id) if id else None
    return services.rooms.elsewhere.get(id, lambda: stream(services.settings, process, id, request))


def room_opened(request: Request, services: Services, room: Room, token: str) -> RoomOpened:
    """Return a room as its teacher gets it."""
    address, reachable = join_address(request, services.settings, room.code)
    return RoomOpened(token=token, code=room.code, address=address, reachable=reachable, qr=qr_rows(address))


def _answer(model: Any, status: int = 200) -> Response:
    return Response(model.model_dump_json(), status, _NONE, "application/json")
