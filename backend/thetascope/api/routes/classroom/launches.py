"""/api/classroom/lti: a class is opened and joined from a learning platform (LTI 1.3).

The platform's page sends a form to `login`, then one to `launch`; both come from another site, and are refused unless
state, cookie and signature agree. The page to which `launch` leads claims the room or the seat with a secret that the
same browser can use once, so that no token stands in an address.
"""

import re
import secrets
from typing import Any
from urllib.parse import parse_qsl, urlencode

from fastapi import APIRouter, Request
from starlette.responses import RedirectResponse, Response

from thetascope.api.http.computed import client_of
from thetascope.api.http.problems import BodyProblem, documented
from thetascope.api.http.read_body import body_schema, parsed_as, read_bytes
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.api.routes.classroom.teacher import room_opened
from thetascope.api.sign_in.presented import is_https
from thetascope.classroom.lti.one_use import LASTS
from thetascope.classroom.lti.tool import Tool
from thetascope.classroom.room_views import seat_view
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Unknown
from thetascope_schemas.service.classroom.requests import LaunchedRequest
from thetascope_schemas.service.classroom.views import JoinedRoom, RoomOpened

_PATH = "/api/classroom/lti"
_LOGIN, _LAUNCH = f"{_PATH}/login", f"{_PATH}/launch"
CROSS_SITE = frozenset({_LOGIN, _LAUNCH})
"""Addresses to which the page of a platform sends a form."""
COOKIE = "thetascope-launch"
_SECRET = re.compile(r"[A-Za-z0-9_-]{32}", re.ASCII)
_FORM = 64 * 1024
"""Bytes of the largest form."""
_KIND = "application/x-www-form-urlencoded"
_NONE = {"Cache-Control": "no-store"}

router = APIRouter(prefix="/classroom/lti", tags=["classroom"])


@router.api_route("/login", methods=["GET", "POST"], include_in_schema=False)
async def begin_login(request: Request, services: Use) -> Response:
    """Begin the login of somebody whom a platform sends: back to the platform, with a state and a nonce."""
    tool = _tool(services)
    asked = await _form(request) if request.method == "POST" else dict(request.query_params)
    cookie = _browser(request)
    browser = cookie if _SECRET.fullmatch(cookie) else secrets.token_urlsafe(24)
    answer = _to(tool.begin(asked, browser, _launch_address(request)), 302)
    # The platform's form comes from another site: the cookie has to come along, which browsers allow over TLS, and on
    # this machine itself.
    answer.set_cookie(COOKIE, browser, max_age=int(LASTS), path=_PATH, secure=True, httponly=True, samesite="none")
    return answer


@router.post("/launch", include_in_schema=False)
async def launch(request: Request, services: Use) -> Response:
    """Check who comes; a teacher is led to the room, a student to the place in it."""
    tool = _tool(services)
    form = await _form(request)
    came, secret = await tool.launch(form.get("state", ""), form.get("id_token", ""), _browser(request))
    audit(request, "classroom.launched")
    return _to(f"{'/classroom/' if came.teaches else '/join/'}?{urlencode({'launch': secret})}", 303)


@router.get(
    "/keys",
    responses=documented(404),
)
def get_keys(services: Use) -> dict[str, Any]:
    """Return the keys with which platforms verify what this service signs (JWKS)."""
    return _tool(services).public_keys()


@router.post(
    "/room",
    status_code=201,
    response_model=RoomOpened,
    openapi_extra=body_schema("LaunchedRequest"),
    responses=documented(404, 413, 415, 422, 429),
)
async def open_launched(request: Request, services: Use) -> Response:
    """Open the room of an activity, or return to it."""
    body = await parsed_as(request, services, LaunchedRequest)
    tool = _tool(services)
    room, token = tool.rooms.open(tool.claimed(body.launch, _browser(request), teaches=True), client_of(request))
    audit(request, "classroom.opened")
    opened = room_opened(request, services, room, token)
    return Response(opened.model_dump_json(), 201, _NONE, "application/json")


@router.post(
    "/seat",
    status_code=201,
    response_model=JoinedRoom,
    openapi_extra=body_schema("LaunchedRequest"),
    responses=documented(404, 409, 413, 415, 422, 429),
)
async def sit_launched(request: Request, services: Use) -> Response:
    """Take one's place in the room of an activity; whoever comes again has the same."""
    body = await parsed_as(request, services, LaunchedRequest)
    tool = _tool(services)
    room, student, token = tool.rooms.seat(tool.claimed(body.launch, _browser(request), teaches=False))
    joined = JoinedRoom(token=token, seat=seat_view(room, student))
    return Response(joined.model_dump_json(), 201, _NONE, "application/json")


def _tool(services: Services) -> Tool:
    """Return the tool. Raises Unknown where no platform is registered."""
    if services.lti is None:
        raise Unknown(Message("lti.off"))
    return services.lti


def _browser(request: Request) -> str:
    """Return the secret in the cookie of a browser with which a login was begun."""
    return request.cookies.get(COOKIE, "")


def _launch_address(request: Request) -> str:
    """Return the address of the launch under the name by which the browser addresses the service.

    The name was checked before, and the platform sends its user to registered addresses only.
    """
    return f"{'https' if is_https(request) else 'http'}://{request.headers.get('host', '')}{_LAUNCH}"


async def _form(request: Request) -> dict[str, str]:
    """Return the fields of a form; the first of each name. Raises BodyProblem."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != _KIND:
        raise BodyProblem(415, Message("lti.form", type=kind[:80]))
    body = await read_bytes(request, _FORM)
    try:
        fields = parse_qsl(body.decode("ascii"), keep_blank_values=True, max_num_fields=50)
    except ValueError:
        raise BodyProblem(400, Message("lti.form", type=kind)) from None
    return dict(reversed(fields))


def _to(address: str, status: int) -> Response:
    return RedirectResponse(address, status, _NONE)
