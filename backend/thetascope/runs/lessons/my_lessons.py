"""The lessons that clients have saved: versions of a text under the lesson's id.

Everybody who may use the service may read and play them, as runs, so that a link is enough to share one; only its owner
deletes it, and what others save under its id is their own. An id means the latest version of the client's own lesson,
else of anybody's. Ids of the library are refused.
"""

import json
import time
from contextlib import suppress
from threading import Lock
from typing import Any

import yaml
from pydantic import ValidationError

from thetascope import library
from thetascope.access.principal import Principal
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.specs.refusals import (
    InvalidSpec,
    NotOwner,
    OverLimit,
    Unknown,
    from_engine,
    from_pydantic,
    invalid,
    validated,
)
from thetascope.store import LessonStore, PlantVersion
from thetascope.store.plant_store import ROW
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.saved import MyLessonLine
from thetascope_schemas.texts.local_text import ALL
from thetascope_schemas.texts.refusal import suggestion

_SHOWN = {"title", "outcome", "minutes"}  # kept as JSON beside the text, so that a list reads no texts
_OF_ONE = 4  # the part of the room that one client may fill, unless it is the machine's owner
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class MyLessons:
    """Stores, finds and deletes the lessons of clients. `limit`: bytes of all versions of all lessons together."""

    def __init__(self, store: LessonStore, limit: int) -> None:
        self._store, self._limit = store, limit
        self._saving = Lock()

    def save(self, lesson: CourseLesson, by: Principal) -> PlantVersion:
        """Store a lesson as the next version under its id. Raises InvalidSpec, OverLimit where there is no room."""
        if lesson.id in library.course():
            raise invalid("id", lesson.id, Message("lesson.of-library", id=lesson.id))
        text = lesson_text(lesson)
        shown = lesson.model_dump(mode="json", include=_SHOWN, context={"language": ALL})
        with self._saving:
            used = self._store.usage()
            most = self._limit if by.is_machine else self._limit // _OF_ONE
            if used.get(by.owner, 0) + len(text.encode()) + ROW > most or sum(used.values()) > self._limit:
                raise OverLimit(Message("lesson.no-room", limit=most // 1024**2), 3600.0)
            steps = len(lesson.steps)
            return self._store.put(
                PlantVersion(by.owner, lesson.id, 0, json.dumps(shown), "yaml", steps, True, text, time.time())
            )

    def find(self, id: str, by: Principal) -> PlantVersion | None:
        """Return the latest version of a lesson: the client's own, else anybody's."""
        own = (self._store.get(owner, id) for owner in _owners(by))
        return next((lesson for lesson in own if lesson is not None), None) or self._store.get(None, id)

    def get(self, id: str, by: Principal) -> PlantVersion:
        """Return the same. Raises Unknown with the nearest id."""
        found = self.find(id, by)
        if found is None:
            known = [lesson.id for lesson in self.latest(by)]
            remedy = Message.from_data(suggestion(id, known)) if known else None
            raise Unknown(Message("lesson.unknown", id=id[:64]), remedy)
        return found

    def latest(self, by: Principal) -> list[PlantVersion]:
        """Return the latest version of each lesson without texts, the last saved first."""
        found: dict[str, PlantVersion] = {}
        for lesson in sorted(self._store.latest(), key=lambda one: not by.acts_for(one.owner)):
            found.setdefault(lesson.id, lesson)
        return sorted(found.values(), key=lambda one: -one.saved)

    def remove(self, id: str, by: Principal) -> None:
        """Delete a lesson with all its versions; it can be restored for 30 days. Raises Unknown, NotOwner."""
        owners = self._store.owners(id)  # of damaged versions, too
        if not owners:
            self.get(id, by)  # names the nearest id
        owner = next((one for one in _owners(by) if one in owners), None)
        if owner is None:
            raise NotOwner(Message("lesson.not-owner", id=id))
        self._store.remove(owner, id)

    def restore(self, id: str, by: Principal) -> PlantVersion:
        """Bring a client's deleted lesson back with all its versions. Raises Unknown."""
        for owner in _owners(by):
            if self._store.restore(owner, id):
                break
        return self.get(id, by)


def lesson_line(version: PlantVersion, by: Principal) -> dict[str, Any]:
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


def lesson_of(version: PlantVersion) -> CourseLesson:
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


def _owners(by: Principal) -> tuple[str, ...]:
    return tuple(owner for owner in (by.owner, by.also) if owner)
