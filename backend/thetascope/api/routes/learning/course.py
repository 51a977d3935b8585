"""/api/course: the lessons. A step is judged in the student's own session, by what that session shows."""

import asyncio
from math import ceil, floor
from typing import Any

import numpy as np
from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope import library
from thetascope.access.principal import Principal, principal_of
from thetascope.api.http.answers import json_response
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.live.facts.step_measures import columns_of, earliest, judge
from thetascope.messages import Message
from thetascope.runs.lessons.my_lessons import lesson_of
from thetascope.runs.results.measures import Readings
from thetascope.runs.specs.refusals import Unknown, invalid
from thetascope_schemas.service.answers import CourseList
from thetascope_schemas.service.learning.course import CourseLesson, CourseStep
from thetascope_schemas.service.learning.judged import Judged, JudgeRequest

router = APIRouter(tags=["lessons"])
_PATIENCE = 10.0
"""Seconds that are waited for the detector where it is behind the rows."""
_MOST_ROWS = 400_000
"""Rows of a step that are looked at."""


@router.get("/course", response_model=CourseList)
def list_course() -> Response:
    """Return the lessons of the course in their order, without their steps."""
    lessons = sorted(library.course().values(), key=lambda lesson: lesson.number)
    return json_response(
        {
            "lessons": [
                {
                    **lesson.model_dump(include={"id", "number", "minutes", "title", "outcome"}),
                    "steps": len(lesson.steps),
                }
                for lesson in lessons
            ]
        }
    )


@router.get("/course/{id}", response_model=CourseLesson, responses=documented(404))
def get_course_lesson(request: Request, id: str, services: Use) -> Response:
    """Return a lesson, one of the library or a saved one, with its experiments and steps, in all languages."""
    lesson = find_lesson(services, id, principal_of(request.scope))
    return json_response(lesson.model_dump(mode="json", exclude_none=True, context={"language": "*"}))


@router.post(
    "/sessions/{id}/judge",
    response_model=Judged,
    openapi_extra=body_schema("JudgeRequest"),
    responses=documented(404, 413, 415, 422),
)
async def judge_step(request: Request, id: str, services: Use) -> Response:
    """Measure in a session what a step of a lesson asks for, and tell which answers are right there."""
    body = await parsed_as(request, services, JudgeRequest)
    lesson = await run_in_threadpool(find_lesson, services, body.lesson, principal_of(request.scope))
    if body.step >= len(lesson.steps):
        raise invalid("step", body.step, Message("course.step.unknown", n=len(lesson.steps)))
    step = lesson.steps[body.step]
    readings = await _readings(_room(services, id), step, body)
    judged = await run_in_threadpool(judge, step, readings)
    return json_response(judged.model_dump(mode="json"))


async def _readings(room: Any, step: CourseStep, body: JudgeRequest) -> Readings:
    mark = body.mark
    record, shown, present = room.session.record, room.shown, room.broadcast.columns
    missing = [name for name in columns_of(step) if name not in present]
    if missing:
        raise invalid("step", missing[0], Message("course.step.other-session", column=missing[0]))
    await _caught_up(room)
    seconds = step.run.seconds if step.run else 0.0
    begin = max(0.0, mark + earliest(step))
    first = min(shown, max(room.oldest, ceil(begin / record - 1e-6)))
    last = max(first, min(shown, floor((mark + seconds) / record + 1e-6) + 1, first + _MOST_ROWS))
    names = columns_of(step)
    rows = await room.past_rows(names, first, last) if names else np.empty((0, last - first))
    facts = room.facts.current
    until = mark + seconds + record
    return Readings(
        t=np.arange(first, last) * record,
        read=lambda name: rows[names.index(name)].astype(float),
        mark=mark,
        alarms=tuple(alarm for alarm in facts.alarms if alarm.t <= until),
        diverged={event.subject: event.t for event in room.session.log if event.kind == "diverged" and event.subject},
        gains={one.label: dict(one.gains) for one in facts.observers},
        dial=body.dial,
        sketch=body.sketch,
        seconds=seconds,
    )


async def _caught_up(room: Any) -> None:
    """Wait until the detector has judged all rows that are shown; alarms may come late on a busy machine."""
    end = asyncio.get_running_loop().time() + _PATIENCE
    while room.session.pending_detection() is not None and asyncio.get_running_loop().time() < end:
        await asyncio.sleep(0.02)


def find_lesson(services: Services, id: str, by: Principal) -> CourseLesson:
    """Return a lesson of the library, or one that was saved: the client's own, else anybody's. Raises Unknown."""
    lesson = library.course().get(id)
    if lesson is not None:
        return lesson
    saved = services.my_lessons.find(id, None, by)
    if saved is None:
        raise Unknown(Message("course.unknown", id=id[:80]))
    return lesson_of(saved)


def _room(services: Services, id: str) -> Any:
    room = services.live.find(id)
    if room is None:
        raise Unknown(Message("session.unknown", id=id[:64]))
    return room
