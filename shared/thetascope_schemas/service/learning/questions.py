"""Lessons on the live page: questions, and the commands that show their answers."""

from typing import Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Identifier, Prose, Strict, example
from thetascope_schemas.service.session import BatchMember
from thetascope_schemas.texts.refusal import refuse


class Words(Strict):
    """A text in the languages of the page, at least in one; readers of the other one get that."""

    model_config = example(en="Why does θ̂2 jump first?", zh="为什么 θ̂2 先跳变?")

    en: Prose = ""
    zh: Prose = ""

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if not (self.en.strip() or self.zh.strip()):
            raise refuse("course.words.empty", field="en", value="")
        return self


class Step(Strict):
    """One question about an experiment."""

    model_config = example(
        question={
            "en": "Lower λ to 0.6: θ̂ becomes smoother but slower. What do you gain, and what do you lose?",
            "zh": "把 λ 降到 0.6：θ̂ 更平滑，但响应更慢。得到了什么，又失去了什么？",
        },
        do=[{"type": "set-gain", "observer": "adaptive", "gain": "lambda", "value": 0.6}],
    )

    question: Words
    do: tuple[BatchMember, ...] = Field(
        default=(), max_length=10, description="Commands of a live session that show the answer, sent as a batch."
    )


class Lesson(Strict):
    """Questions about one experiment of the library; the id is that of the experiment."""

    model_config = example(
        id="zhao-2012", questions=[{"question": {"en": "Why does θ̂2 jump first?", "zh": "为什么 θ̂2 先跳变?"}, "do": []}]
    )

    id: Identifier
    questions: tuple[Step, ...] = Field(min_length=1, max_length=6)
