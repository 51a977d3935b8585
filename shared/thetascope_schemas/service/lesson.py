"""Questions that turn the live page into a lesson, each with what to do to see the answer."""

from pydantic import Field

from thetascope_schemas.experiment.base import Identifier, Prose, Strict, example
from thetascope_schemas.service.session import BatchMember


class Words(Strict):
    """A text in the languages of the page."""

    model_config = example(en="Why does θ̂2 jump first?", zh="为什么 θ̂2 先跳变?")

    en: Prose
    zh: Prose


class Step(Strict):
    """One question about an experiment."""

    model_config = example(
        question={
            "en": "Lower λ to 0.6: calm, and slow. What do you trade?",
            "zh": "把 λ 降到 0.6:平静了,也慢了。换来了什么?",
        },
        do=[{"type": "set-gain", "observer": "adaptive", "gain": "lambda", "value": 0.6}],
    )

    question: Words
    do: tuple[BatchMember, ...] = Field(
        default=(), max_length=10, description="Commands of a live session that carry it out, as a batch."
    )


class Lesson(Strict):
    """What to try with one experiment of the library; its id is the experiment's."""

    model_config = example(
        id="zhao-2012", questions=[{"question": {"en": "Why does θ̂2 jump first?", "zh": "为什么 θ̂2 先跳变?"}, "do": []}]
    )

    id: Identifier
    questions: tuple[Step, ...] = Field(min_length=1, max_length=6)
