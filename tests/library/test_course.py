"""The lessons of the course: each step is played in a session, with right and with wrong answers."""

from functools import cache

import pytest

from thetascope import library
from thetascope.live.facts.play_step import judged_deeds
from thetascope_schemas.service.learning.judged import Judged

STEPS = [(lesson.id, place) for lesson in library.course().values() for place in range(len(lesson.steps))]


@cache
def played(lesson: str, place: int) -> tuple[Judged, ...]:
    """Return the judgements of a step: one for each choice, or for two values of a dial, or two sketches, or one."""
    return judged_deeds(library.course()[lesson], place)


@pytest.mark.parametrize(("lesson", "place"), STEPS)
def test_a_step_judges_what_its_session_shows(lesson: str, place: int):
    """One answer is right and the others are wrong; a dial and choices can be set right and wrong; it says why."""
    step = library.course()[lesson].steps[place]
    found = played(lesson, place)
    assert found or not step.measures
    if step.answers:
        assert sum(found[0].right) == 1, found[0].values
    if step.right_if:
        assert {one.met for one in found} == {True, False}, [one.values for one in found]
    if step.dial is not None or step.sketch is not None:
        assert [one.met for one in found] == [False, True]
    for one in found:
        assert not step.saw or one.saw is not None, one.values


def placeholders(text: str) -> set[str]:
    return {part.split("}")[0] for part in text.split("{")[1:]}


@pytest.mark.parametrize("lesson", library.course())
def test_sentences_name_what_is_measured(lesson: str):
    """Every {name} in a sentence is a measure of its step, in both languages the same ones; Chinese is Chinese."""
    for step in library.course()[lesson].steps:
        texts = [step.title, *step.say, *step.why, *(saw.text for saw in step.saw)]
        texts += [words for words in (step.ask, step.look, step.short, step.cause) if words]
        texts += [answer.text for answer in (*step.answers, *step.choices)]
        for words in texts:
            assert placeholders(words.en) == placeholders(words.zh) <= set(step.measures)
            assert any("\u4e00" <= c <= "\u9fff" for c in words.zh) and words.en != words.zh


def test_the_course_is_numbered():
    """Each lesson has a number of its own, the first one 1; lessons can be added in any order."""
    numbers = sorted(lesson.number for lesson in library.course().values())
    assert numbers[0] == 1 and len(set(numbers)) == len(numbers)
