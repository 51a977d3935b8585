"""What steps of lessons measure: counts and crossings of a level, set or fixed, and rows before the step began."""

import numpy as np
import pytest
from pydantic import ValidationError

from thetascope.live.facts.step_measures import columns_of, earliest, measured
from thetascope.runs.results.measures import Readings
from thetascope_schemas.service.learning.course import CourseStep

T = np.arange(0.0, 10.0, 1.0)
RESIDUAL = np.array([0.0, 3.0, 3.5, 0.0, -2.0, 0.0, 1.0, -4.0, 4.0, 0.0])
WORDS = {"en": "Count.", "zh": "数一数。"}


def step(**measures: dict) -> CourseStep:
    fields = {"title": WORDS, "say": [WORDS], "start": {"experiment": "alone"}, "run": {"seconds": 6.0}}
    return CourseStep.model_validate({**fields, "measures": measures})


def readings(dial: float | None = None) -> Readings:
    """Return rows of y and of an estimate, the difference of which is RESIDUAL, from 3 s before the mark."""
    columns = {"y.y": RESIDUAL + 7.0, "copy.y.y": np.full(T.size, 7.0)}
    return Readings(t=T, read=columns.__getitem__, mark=3.0, dial=dial)


def test_a_stay_beyond_a_level_counts_once():
    """Above or below; two rows on opposite sides are one alarm; rows before the mark count if asked for."""
    counts = {"kind": "counts", "column": "y.y", "minus": "copy.y.y", "level": 1.5}
    found = measured(step(after=counts, all={**counts, "start": -3.0}, early={**counts, "end": 2.0}), readings())
    assert found == {"after": 2, "all": 3, "early": 1}


def test_the_first_time_beyond_a_level_is_on_either_side():
    """Above and below are one side each, and the first row may be there already."""
    crosses = {"kind": "crosses", "column": "y.y", "minus": "copy.y.y", "level": 1.5}
    sides = {side: {**crosses, "side": side} for side in ("above", "below", "beyond")}
    far = {**crosses, "side": "beyond", "level": 9}
    assert measured(step(**sides, never=far), readings()) == {"above": 5, "below": 0, "beyond": 1, "never": None}


def test_a_level_may_be_the_one_that_the_student_has_set():
    """Without a dial there is no number."""
    counts = {"kind": "counts", "column": "y.y", "minus": "copy.y.y", "level": "dial"}
    plan = step(alarms=counts, delay={**counts, "kind": "crosses", "side": "beyond"})
    assert measured(plan, readings(dial=3.2)) == {"alarms": 1, "delay": 4}
    assert measured(plan, readings()) == {"alarms": None, "delay": None}


def test_a_step_may_read_rows_before_its_mark():
    """The earliest time of all its measures counts, and never one after the mark."""
    level = {"kind": "level", "take": "mean", "column": "y.y"}
    assert earliest(step(before={**level, "start": -2.0, "end": 0.0}, late={**level, "start": 5.0})) == -2.0
    assert earliest(step(late={**level, "start": 5.0})) == earliest(step()) == 0.0
    assert earliest(step(found={"kind": "found", "since": -70.0})) == -70.0


def test_what_was_drawn_is_a_column():
    """It is straight between its values, which lie at equal times of the step; without a drawing there is no number."""
    level = {"kind": "level", "column": "sketch", "take": "mean"}
    plan = step(last={**level, "take": "last"}, gap={**level, "minus": "y.y", "end": 0.0})
    columns = {"y.y": RESIDUAL}
    drawn = Readings(t=T, read=columns.__getitem__, mark=3.0, sketch=(5.0, 6.0, 1.0), seconds=6.0)
    assert columns_of(plan) == ("y.y",)
    assert measured(plan, drawn) == {"last": 1.0, "gap": 5.0}
    assert measured(plan, Readings(t=T, read=columns.__getitem__, mark=3.0)) == {"last": None, "gap": None}


def refused(**fields) -> list[str]:
    """Return the codes of what is wrong with a step of these fields."""
    with pytest.raises(ValidationError) as caught:
        CourseStep.model_validate({"title": WORDS, "say": [WORDS], **fields})
    return [error["ctx"]["code"] for error in caught.value.errors()]


def test_a_sketch_lies_within_its_limits():
    """The line from which it begins and its solution can both be drawn."""
    sketch = {"strip": "y.y", "low": 0.0, "high": 1.0, "value": 0.5, "solution": [0.0, 1.0, 1.0]}
    assert refused(sketch={**sketch, "value": 2.0}) == ["course.sketch.beyond"]
    assert refused(sketch={**sketch, "solution": [0.0, -1.0, 1.0]}) == ["course.sketch.beyond"]
    assert refused(sketch=sketch) == ["course.step.runs-nothing"]


def test_places_to_point_at_are_in_the_picture():
    """All answers are places, each another one, and the picture that is shown has them."""
    holds = [{"measure": "none", "none": True}]
    answers = [{"text": WORDS, "site": site, "right_if": holds} for site in ("pump", "leak")]
    fields = {"measures": {"none": {"kind": "found"}}, "start": {"experiment": "alone"}, "run": {"seconds": 6.0}}
    CourseStep.model_validate({"title": WORDS, "say": [WORDS], "answers": answers, **fields})
    assert refused(answers=answers, show={"picture": "copy"}, **fields) == ["course.sites"]
    assert refused(answers=[answers[0], answers[0]], **fields) == ["course.sites"]
    assert refused(answers=[answers[0], {"text": WORDS, "right_if": holds}], **fields) == ["course.sites"]


@pytest.mark.parametrize("sets", [{}, {"strip": "residual.y", "observer": "copy", "gain": "rho"}, {"observer": "copy"}])
def test_a_dial_sets_a_gain_or_a_level(sets):
    """Neither, both, and half a gain are refused."""
    dial = {"text": WORDS, "low": 0.1, "high": 1.0, "value": 0.2, "solution": 0.5, **sets}
    with pytest.raises(ValidationError) as caught:
        CourseStep.model_validate({"title": WORDS, "say": [WORDS], "dial": dial})
    assert [error["ctx"]["code"] for error in caught.value.errors()] == ["course.dial.sets"]
