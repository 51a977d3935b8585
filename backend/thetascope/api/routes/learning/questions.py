"""/api/lessons: questions about each experiment of the library, and the commands that answer them."""

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from thetascope import library
from thetascope.api.http.answers import json_response
from thetascope.api.http.problems import documented
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Unknown
from thetascope_schemas.service.answers import LessonList, LessonPlan
from thetascope_schemas.service.learning.questions import Lesson

router = APIRouter(tags=["lessons"])


def plain(lesson: Lesson) -> dict[str, Any]:
    """Return a lesson as data. Its commands have no id, which the client chooses when it sends them."""
    return {
        "id": lesson.id,
        "questions": [
            {
                "question": step.question.model_dump(),
                "do": [command.model_dump(mode="json", exclude={"id"}, exclude_none=True) for command in step.do],
            }
            for step in lesson.questions
        ],
    }


@router.get("/lessons", response_model=LessonList)
def list_lessons() -> Response:
    """Return all lessons, with their questions in all languages."""
    return json_response({"lessons": [plain(lesson) for lesson in library.lessons().values()]})


@router.get("/lessons/{id}", response_model=LessonPlan, responses=documented(404))
def get_lesson(id: str) -> Response:
    """Return the questions about one experiment, in all languages."""
    lesson = library.lessons().get(id)
    if lesson is None:
        raise Unknown(Message("lesson.unknown", id=id[:80]))
    return json_response(plain(lesson))
