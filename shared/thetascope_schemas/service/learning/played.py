"""A step of a lesson, played on the server: what each answer gets, and the curves of its strips."""

from typing import Any, Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Number, Strict, example
from thetascope_schemas.service.learning.course import CourseLesson
from thetascope_schemas.service.learning.judged import Judged
from thetascope_schemas.texts.refusal import refuse

_WORDS = {"en": "Two tanks", "zh": "两个水箱"}
_LESSON: dict[str, Any] = {
    "id": "two-tanks-alone",
    "minutes": 3,
    "title": _WORDS,
    "outcome": _WORDS,
    "experiments": {"alone": {"plant": "two-tanks", "horizon": 60.0, "step": 0.1}},
    "steps": [{"title": _WORDS, "say": [_WORDS], "start": {"experiment": "alone"}}],
}
_DEED: dict[str, Any] = {
    "judged": {"values": {"settled": 23.2}, "right": [False, True], "met": True, "saw": 0},
    "since": [None, 23.5],
    "met_since": 0.0,
}
_CURVE: dict[str, Any] = {"strip": "x.h1", "label": "copy", "values": [1.0, 1.4]}


class PlayRequest(Strict):
    """A lesson, and which of its steps to play."""

    model_config = example(lesson=_LESSON, step=0)

    lesson: CourseLesson
    step: int = Field(ge=0, le=99, strict=True, description="Place of the step, counted from 0.")

    @model_validator(mode="after")
    def _has_the_step(self) -> Self:
        if self.step >= len(self.lesson.steps):
            raise refuse("course.step.unknown", field="step", value=self.step, n=len(self.lesson.steps))
        return self


class PlayedDeed(Strict):
    """What the session shows after one of the things that a student can do: a choice, a value of the dial, a sketch."""

    model_config = example(**_DEED)

    judged: Judged
    since: tuple[Number | None, ...] = Field(
        description="Time in s of the session from which each answer is right until the end; null: it is wrong there."
    )
    met_since: Number | None = Field(description="The same for the conditions of the step itself.")


class PlayedCurve(Strict):
    """A curve on a strip: the truth, a reading, or what an observer estimates."""

    model_config = example(**_CURVE)

    strip: str = Field(description="Name of the strip.")
    label: str = Field(description="Label of the observer; empty: the true value or a signal.")
    values: tuple[Number | None, ...] = Field(description="Its values at the times `t`, in the unit of the strip.")


class Played(Strict):
    """A step as it goes in the lesson's own experiment."""

    model_config = example(mark=0.0, deeds=[_DEED], t=[0.0, 0.5], curves=[_CURVE], columns=["y.y", "copy.x.h1"])

    mark: Number = Field(description="Time in s of the session at which the step begins.")
    deeds: tuple[PlayedDeed, ...] = Field(description="By choice; of a dial and a sketch first wrong, then right.")
    t: tuple[Number, ...] = Field(description="Times in s of the curves.")
    curves: tuple[PlayedCurve, ...]
    columns: tuple[str, ...] = Field(description="Names of all columns that a measure can read.")
