"""/api/my-lessons: lessons that clients have made; /api/course/play: how a step of any lesson goes."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope.access.principal import Principal, principal_of
from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import computed
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Use
from thetascope.api.operation.request_log import audit
from thetascope.api.routes.learning.course import find_lesson
from thetascope.engine.errors import SpecError
from thetascope.live.facts.play_step import play_step
from thetascope.runs.lessons.my_lessons import check_lesson, lesson_line, lesson_of, lesson_text
from thetascope.runs.specs.refusals import from_engine
from thetascope.store import TextVersion
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.played import Played, PlayRequest
from thetascope_schemas.service.learning.saved import MyLesson, MyLessonList

router = APIRouter(tags=["lessons"])
_FILE = {200: {"content": {"application/yaml": {}}, "description": "The lesson's file."}}


@router.get("/my-lessons", response_model=MyLessonList)
def list_my_lessons(request: Request, services: Use) -> Response:
    """Return the latest version of each lesson that this client or another has saved, the last saved first."""
    by = principal_of(request.scope)
    return json_response({"lessons": [lesson_line(one, by) for one in services.my_lessons.latest(by)]})


@router.post(
    "/my-lessons",
    response_model=MyLesson,
    status_code=201,
    openapi_extra=body_schema("CourseLesson"),
    responses=documented(413, 415, 422, 429),
)
async def save_my_lesson(request: Request, services: Use) -> Response:
    """Save a lesson, JSON or the YAML of its file, as the next version under its id."""
    lesson = await parsed_as(request, services, CourseLesson)
    await computed(request, services, check_lesson, lesson)
    by = principal_of(request.scope)
    saved = await run_in_threadpool(services.my_lessons.save, lesson, by)
    audit(request, "lesson.saved", lesson=saved.id, version=saved.version)
    return json_response(_whole(saved, by), 201, {"Location": f"/api/my-lessons/{saved.id}"})


@router.get("/my-lessons/{id}", response_model=MyLesson, responses=documented(404))
def get_my_lesson(request: Request, id: str, services: Use) -> Response:
    """Return the latest version of a lesson, in all languages."""
    by = principal_of(request.scope)
    return json_response(_whole(services.my_lessons.get(id, None, by), by))


@router.delete("/my-lessons/{id}", status_code=204, responses=documented(403, 404))
def delete_my_lesson(request: Request, id: str, services: Use) -> Response:
    """Delete a lesson with all its versions. POST …/restore brings it back within 30 days."""
    services.my_lessons.remove(id, principal_of(request.scope))
    audit(request, "lesson.removed", lesson=id)
    return Response(status_code=204)


@router.post("/my-lessons/{id}/restore", response_model=MyLesson, responses=documented(404))
def restore_my_lesson(request: Request, id: str, services: Use) -> Response:
    """Bring back a lesson that was deleted, with all its versions."""
    by = principal_of(request.scope)
    return json_response(_whole(services.my_lessons.restore(id, by), by))


@router.get("/course/{id}/file", response_class=Response, responses={**_FILE, **documented(404)})
def get_lesson_file(request: Request, id: str, services: Use) -> Response:
    """Return a lesson of the library, or a saved one, as one YAML file, which can be edited and saved again."""
    lesson = find_lesson(services, id, principal_of(request.scope))
    named = {"Content-Disposition": f'attachment; filename="{lesson.id}.yaml"'}
    return Response(lesson_text(lesson), media_type="application/yaml", headers=named)


@router.post(
    "/course/play",
    response_model=Played,
    openapi_extra=body_schema("PlayRequest"),
    responses=documented(413, 415, 422, 429),
)
async def play_lesson_step(request: Request, services: Use) -> Response:
    """Play a step once for each thing that a student can do: what is right there and since when, and its curves."""
    body = await parsed_as(request, services, PlayRequest)
    await computed(request, services, check_lesson, body.lesson)
    try:
        played = await computed(request, services, play_step, body.lesson, body.step)
    except SpecError as error:
        raise from_engine(error) from None
    return json_response(played.model_dump(mode="json"))


def _whole(saved: TextVersion, by: Principal) -> dict[str, Any]:
    lesson = lesson_of(saved)
    data = lesson.model_dump(mode="json", exclude_none=True, context={"language": "*"})
    return lesson_line(saved, by) | {"lesson": data}
