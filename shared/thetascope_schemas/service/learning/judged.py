"""A step of a lesson as it is judged in a student's session."""

from pydantic import Field

from thetascope_schemas.experiment.base import Identifier, Instant, Number, Strict, example
from thetascope_schemas.service.learning.measures import Drawn


class JudgeRequest(Strict):
    """Which step to judge, and when it was started."""

    model_config = example(lesson="what-you-cannot-see", step=3, mark=60.0)

    lesson: Identifier
    step: int = Field(ge=0, le=99, strict=True, description="Place of the step in its lesson, counted from 0.")
    mark: Instant = Field(default=0, description="Time of the session in s at which the step was started.")
    dial: Number | None = Field(default=None, description="The value of the step's dial; null: it has none.")
    sketch: Drawn | None = Field(default=None, description="What was drawn; null: the step has no sketch.")


class Judged(Strict):
    """What the session shows: measured numbers, and which answers they make right."""

    model_config = example(values={"settled": 23.2}, right=[False, False, True, False], met=True, saw=0)

    values: dict[str, Number | None] = Field(description="The measured numbers by name; null: nothing was measured.")
    right: tuple[bool, ...] = Field(description="Whether each answer is right.")
    met: bool = Field(description="Whether the conditions of the step itself hold.")
    saw: int | None = Field(description="Place of the first sentence whose conditions hold; null: none does.")
