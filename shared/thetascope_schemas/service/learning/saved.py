"""Lessons that clients have made and saved on the server."""

from typing import Any

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, example
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.questions import Words

_LINE: dict[str, Any] = {
    "id": "leak-or-weak-pump",
    "version": 3,
    "title": {"en": "Leak or weak pump?", "zh": "泄漏，还是泵变弱？"},
    "outcome": {"en": "Say when nobody can tell.", "zh": "说出什么时候谁也分不清。"},
    "minutes": 8,
    "steps": 5,
    "saved": 1795960920.0,
    "mine": True,
}
_LESSON: dict[str, Any] = {
    **{name: _LINE[name] for name in ("id", "title", "outcome", "minutes")},
    "experiments": {"leak": {"plant": "two-tanks", "horizon": 60.0, "step": 0.1}},
    "steps": [{"title": _LINE["title"], "say": [_LINE["outcome"]], "start": {"experiment": "leak"}}],
}


class MyLessonLine(Strict):
    """The latest version of a saved lesson, without its steps."""

    model_config = example(**_LINE)

    id: str = Field(description="Its id, by which the address of a lesson names it.")
    version: int = Field(description="Number of the version, from 1.")
    title: Words
    outcome: Words
    minutes: int = Field(description="Time in minutes that it takes.")
    steps: int = Field(description="Number of steps.")
    saved: Number = Field(description="Time in seconds since 1970.")
    mine: bool = Field(description="Whether this client may change and delete it; others may read, play and copy it.")


class MyLessonList(Strict):
    """Saved lessons, the last one that was saved first."""

    model_config = example(lessons=[_LINE])

    lessons: tuple[MyLessonLine, ...]


class MyLesson(MyLessonLine):
    """A saved lesson with its steps."""

    model_config = example(**_LINE, lesson=_LESSON)

    lesson: CourseLesson
