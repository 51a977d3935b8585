"""What teachers and students of a classroom send."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Flag, Identifier, Instant, Reference, Strict, example
from thetascope_schemas.service.learning.challenge import Size, Verdict
from thetascope_schemas.service.learning.measures import ColumnName
from thetascope_schemas.texts.refusal import refuse

CLOSE_NO_ROOM = 4404  # the room does not exist, or has ended
CLOSE_TOKEN = 4401  # the token is that of no teacher or student here
CLOSE_ELSEWHERE = 4409  # the same student has opened more pages than may be open

MOST_OPTIONS = 9
MOST_NAME = 24
"""Characters of a student's name."""


class Caption(Strict):
    """A short text in both languages of the page."""

    model_config = example(en="Otter", zh="水獭")

    en: str = Field(max_length=2000)
    zh: str = Field(max_length=2000)


class LaunchedRequest(Strict):
    """The secret of a launch from a learning platform, as it stands in the address of the page."""

    model_config = example(launch="Zb1s0vC7Jm3kqyT5uWnA9xRhLd2eGf8i")

    launch: str = Field(max_length=100, description="It can be used once.")


Place = Annotated[int, Field(ge=0, lt=MOST_OPTIONS, strict=True)]


class JoinRequest(Strict):
    """The code with which a student joins a room."""

    model_config = example(code="HWRTKM")

    code: str = Field(max_length=40, description="Six letters; case, blanks and dashes do not matter.")


class NameRequest(Strict):
    """The name that a student chooses; without one the student gets another animal."""

    model_config = example(name="Ada")

    name: str | None = Field(default=None, max_length=200, description="A name; null: another animal.")


class VoteRequest(Strict):
    """A student's prediction in a step that the teacher shows."""

    model_config = example(step="what-you-cannot-see 3", choice=2)

    step: str = Field(max_length=120, description="The step as the room names it.")
    choice: Place = Field(description="Place of the answer, counted from 0.")


class StepCard(Strict):
    """What students see of a step: its words, its question, and the curves that go with it."""

    model_config = example(
        place=4,
        of=7,
        title={"en": "Now let the copy listen", "zh": "现在，让副本听一听"},
        options=[{"en": "It stays wrong", "zh": "一直不对"}],
    )

    place: int = Field(ge=1, le=200, strict=True, description="Number of the step, counted from 1.")
    of: int = Field(ge=1, le=200, strict=True, description="Number of steps.")
    title: Caption
    say: tuple[Caption, ...] = Field(default=(), max_length=6)
    ask: Caption | None = None
    options: tuple[Caption, ...] = Field(default=(), max_length=MOST_OPTIONS)


class CurveLine(Strict):
    """A curve: a column of the session, or the difference of two."""

    model_config = example(column="y.y1", minus="ekf.y.y1")

    column: ColumnName
    minus: ColumnName | None = None
    place: int = Field(default=0, ge=0, le=20, strict=True, description="Of its observer, for the colour.")
    role: Literal["truth", "measured", "estimate"] = "estimate"


class CurveStrip(Strict):
    """The strip of curves that students see."""

    model_config = example(symbol="h1", unit="cm", lines=[{"column": "x.h1", "role": "truth"}])

    symbol: str = Field(max_length=64, description="Name of the quantity.")
    residual: Flag = Field(default=False, description="Whether it is measured minus predicted.")
    title: Caption | None = None
    unit: str = Field(default="", max_length=32)
    lines: tuple[CurveLine, ...] = Field(min_length=1, max_length=8)


class LeadRequest(Strict):
    """What the teacher shows now: a live session, and perhaps a step of a lesson."""

    model_config = example(session="", step="what-you-cannot-see 3", phase="before")

    session: str = Field(default="", max_length=64, description="Id of the teacher's session.")
    strip: CurveStrip | None = Field(default=None, description="The curves of the session that students see.")
    step: str = Field(default="", max_length=120, description="A name for the step; '': no lesson is shown.")
    card: StepCard | None = Field(default=None, description="The step's words.")
    since: Instant | None = Field(default=None, description="Where the axis of time begins, in s; null: it follows.")
    until: Instant | None = Field(
        default=None, description="Time in s until which the step will run; null: it has run."
    )
    phase: Literal["before", "running", "after"] = Field(
        default="before", description="before: students vote; after: the step was run, and is judged."
    )
    right: tuple[Flag, ...] = Field(
        default=(), max_length=MOST_OPTIONS, description="Whether each answer was right in the teacher's session."
    )


class RoundRequest(Strict):
    """A new round; it ends the one before."""

    model_config = example(kind="follow")

    kind: Literal["follow", "own"] = Field(
        description="follow: all see the teacher's session, and vote; own: each has a record with a hidden fault."
    )
    setup: Identifier | None = Field(default=None, description="The plant of hidden faults: a set-up of the library.")
    seconds: int = Field(default=240, ge=20, le=3600, strict=True, description="Time in s for finding a hidden fault.")


class AnswerRequest(Strict):
    """A student's answer about the hidden fault. It may be changed until the round is revealed."""

    model_config = example(round=2, verdict="channel", channel="leak1", onset=400.0, size=0.08)

    round: int = Field(ge=1, le=10_000, strict=True, description="Number of the round, counted from 1.")
    verdict: Verdict
    channel: Reference | None = None
    alike: tuple[Reference, ...] = Field(
        default=(), max_length=12, description="The channels that look alike, where it cannot be told."
    )
    onset: Instant | None = Field(default=None, description="Time in s at which it is thought to have begun.")
    size: Size = None

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.verdict == "channel") != (self.channel is not None):
            raise refuse("challenge.answer.channel", "channel", self.channel)
        if (self.verdict == "cannot-be-told") != (len(set(self.alike)) >= 2):
            raise refuse("challenge.answer.alike", "alike", list(self.alike))
        return self
