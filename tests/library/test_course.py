"""The lessons of the course: each step is played in a session, with right and with wrong answers."""

from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest

from thetascope import library
from thetascope.live.facts.session_facts import FactsMemory, facts_of
from thetascope.live.facts.step_measures import Readings, judge
from thetascope.live.session.session import Session
from thetascope_schemas.service.learning.course import CourseStep
from thetascope_schemas.service.learning.judged import Judged
from thetascope_schemas.service.session import Batch, SetGainNow

STEPS = [(lesson.id, place) for lesson in library.course().values() for place in range(len(lesson.steps))]


class Seat:
    """A session of a student, and all rows that it has shown."""

    def __init__(self, lesson: str, step: CourseStep):
        assert step.start is not None
        self.session = Session(library.resolve(library.course()[lesson].experiments[step.start.experiment]), 100_000)
        self.pieces: list[tuple[tuple[str, ...], np.ndarray]] = []
        self.run(step.start.t)

    def run(self, seconds: float) -> None:
        """Let time pass."""
        rows = round(seconds / self.session.record)
        while rows > 0:
            data = self.session.advance(rows)
            assert data.shape[1] > 0
            self.pieces.append((self.session.columns, data))
            rows -= data.shape[1]

    def column(self, name: str) -> np.ndarray:
        return np.concatenate([data[columns.index(name)] for columns, data in self.pieces])

    def judged(self, step: CourseStep, commands: tuple, dial=None, sketch=None) -> Judged:
        """Carry out what the student chose, set or drew, run the step, and judge it."""
        mark = max(0, self.session.row - 1) * self.session.record
        commands = (*commands, *(step.run.do if step.run else ()))
        if commands:
            self.session.handle(Batch(id=0, commands=commands))
        self.run(step.run.seconds if step.run else 0)
        facts = facts_of(self.session, self.session.row, FactsMemory(self.session.record))
        t = self.column("t") if "t" in self.session.columns else np.arange(self.session.row) * self.session.record
        readings = Readings(
            t=t,
            read=self.column,
            mark=mark,
            alarms=facts.alarms,
            diverged={e.subject: e.t for e in self.session.log if e.kind == "diverged" and e.subject},
            gains={one.label: dict(one.gains) for one in facts.observers},
            dial=dial,
            sketch=sketch,
            seconds=step.run.seconds if step.run else 0.0,
        )
        return judge(step, readings)


@cache
def played(lesson: str, place: int) -> tuple[Judged, ...]:
    """Return the judgements of a step: one for each choice, or for two values of a dial, or two sketches, or one."""
    step = library.course()[lesson].steps[place]
    return tuple(Seat(lesson, step).judged(step, *deed) for deed in deeds(step)) if step.run else ()


def deeds(step: CourseStep) -> Iterator[tuple]:
    """Yield what students do: commands, the value of a dial, and a sketch."""
    if step.dial is not None:
        for value in (step.dial.value, step.dial.solution):
            gain = step.dial.observer and SetGainNow(
                id=0, observer=step.dial.observer, gain=step.dial.gain, value=value
            )
            yield (gain,) if gain else (), value
    elif step.sketch is not None:
        yield (), None, (step.sketch.value,) * len(step.sketch.solution)
        yield (), None, step.sketch.solution
    elif step.choices:
        yield from ((choice.do, None) for choice in step.choices)
    else:
        yield (), None


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
