"""Numbers that a step of a lesson measures in a session, and what they make right."""

from collections.abc import Mapping, Sequence

from thetascope.runs.results.measures import Readings, columns_read, value_of
from thetascope_schemas.service.learning.course import CourseStep
from thetascope_schemas.service.learning.judged import Judged
from thetascope_schemas.service.learning.measures import Condition


def columns_of(step: CourseStep) -> tuple[str, ...]:
    """Return the columns of a session that the measures of a step read."""
    return tuple(dict.fromkeys(name for one in step.measures.values() for name in columns_read(one)))


def earliest(step: CourseStep) -> float:
    """Return the time in s after the mark from which the measures of a step read rows: 0, or before the mark."""
    starts = [getattr(one, "start", getattr(one, "since", 0.0)) for one in step.measures.values()]
    return min([0.0, *starts])


def measured(step: CourseStep, readings: Readings) -> dict[str, float | None]:
    """Return the number of every measure of a step; None: nothing was measured."""
    return {name: value_of(measure, readings) for name, measure in step.measures.items()}


def judge(step: CourseStep, readings: Readings) -> Judged:
    """Return what readings of a session show about a step."""
    values = measured(step, readings)
    return Judged(
        values=values,
        right=tuple(holds(answer.right_if, values) for answer in step.answers),
        met=holds(step.right_if, values),
        saw=next((place for place, saw in enumerate(step.saw) if holds(saw.when, values)), None),
    )


def holds(conditions: Sequence[Condition], values: Mapping[str, float | None]) -> bool:
    """Return whether all conditions hold for the measured numbers."""
    return all(condition.holds(values[condition.measure]) for condition in conditions)
