"""The lessons: three questions per experiment, with commands that the live session accepts."""

import pytest

from thetascope import library
from thetascope.live.session.session import Session


@pytest.mark.parametrize("id", library.experiments())
def test_every_question_can_be_carried_out(id):
    """In a session of the experiment that has run for a while every command is accepted."""
    lesson = library.lessons()[id]
    assert len(lesson.questions) == 3
    spec = library.experiment(id)
    spec = library.resolve(spec)
    session = Session(spec, 100_000)
    session.advance(20)
    for step in lesson.questions:
        other = session.fork()
        for command in step.do:
            other.handle(command)
        before = other.row
        other.advance(5)
        assert other.row > before


def test_questions_are_written_in_both_languages():
    """The Chinese text is Chinese, the English one English, and they differ."""
    for lesson in library.lessons().values():
        for step in lesson.questions:
            assert step.question.en.isprintable() and any("\u4e00" <= c <= "\u9fff" for c in step.question.zh)
            assert not any("\u4e00" <= c <= "\u9fff" for c in step.question.en)
