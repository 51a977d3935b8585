"""The lessons that clients have saved: versions of a text under the lesson's id.

Who may read and delete them: thetascope.runs.saved_texts. Ids of the library are refused.
"""

import json
import time
from contextlib import suppress
from typing import Any

import yaml
from pydantic import ValidationError

from thetascope import library
from thetascope.access.principal import Principal
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.saved_texts import SavedTexts
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, from_pydantic, invalid, validated
from thetascope.store import TextVersion
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.saved import MyLessonLine
from thetascope_schemas.texts.local_text import ALL

_SHOWN = {"title", "outcome", "minutes"}  # kept as JSON beside the text, so that a list reads no texts
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class MyLessons(SavedTexts):
    """Stores, finds and deletes the lessons of clients."""

    unknown, version_unknown = "lesson.unknown", "lesson.version-unknown"
    not_owner, no_room = "lesson.not-owner", "lesson.no-room"

    def save(self, lesson: CourseLesson, by: Principal) -> TextVersion:
        """Store a lesson as the next version under its id. Raises InvalidSpec, NoRoomForTexts, StoreError."""
        if lesson.id in library.course():
            raise invalid("id", lesson.id, Message("lesson.of-library", id=lesson.id))
        shown = json.dumps(lesson.model_dump(mode="json", include=_SHOWN, context={"language": ALL}))
        steps, text = len(lesson.steps), lesson_text(lesson)
        saved, _ = self.put(TextVersion(by.owner, lesson.id, 0, shown, "yaml", steps, True, text, time.time()), by)
        return saved


def lesson_line(version: TextVersion, by: Principal) -> dict[str, Any]:
    """Return what a list shows of a saved lesson, also of a damaged one: then its id in place of its words."""
    known = {"id": version.id, "version": version.version, "steps": version.faults, "saved": version.saved}
    known["mine"] = by.acts_for(version.owner)
    with suppress(ValueError, TypeError, RecursionError):
        return MyLessonLine.model_validate({**json.loads(version.title), **known}).model_dump(
            mode="json", context={"language": ALL}
        )
    words = {"en": version.id, "zh": version.id}
    return {**known, "title": words, "outcome": words, "minutes": 0}


def lesson_text(lesson: CourseLesson) -> str:
    """Return a lesson as the YAML of its file: what its author has written."""
    data = lesson.model_dump(mode="json", exclude_unset=True, exclude_none=True, context={"language": ALL})
    return yaml.safe_dump(data, allow_unicode=True, sort_keys=False, width=110)


def lesson_of(version: TextVersion) -> CourseLesson:
    """Return the lesson of a saved text. Raises InvalidSpec where another version of the program wrote it."""
    return validated(CourseLesson, yaml.load(version.text, Loader=_LOADER))


def check_lesson(lesson: CourseLesson) -> None:
    """Check the experiments of a lesson against their plants. Raises InvalidSpec, naming the field."""
    for name, experiment in lesson.experiments.items():
        try:
            library.resolve(experiment)
        except ValidationError as error:
            refused = from_pydantic(error)
        except SpecError as error:
            refused = from_engine(error)
        else:
            continue
        path = f"experiments.{name}."
        raise InvalidSpec([one.model_copy(update={"field": path + one.field}) for one in refused.errors])
