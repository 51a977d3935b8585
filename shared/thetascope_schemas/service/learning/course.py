"""The course: lessons of steps, each of which says, asks, runs and explains, and checks the student's own session."""

from typing import Annotated, Literal, Self

from pydantic import Field, WithJsonSchema, model_validator

from thetascope_schemas.experiment.base import Identifier, Instant, Number, Positive, Reference, Strict, example
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.learning.measures import ColumnName, Condition, Drawn, Measure
from thetascope_schemas.service.learning.questions import Words
from thetascope_schemas.service.session import BatchMember
from thetascope_schemas.texts.refusal import refuse, suggestion

_HEADING = {"en": "Now let the copy listen", "zh": "现在，让副本听一听"}
_ANSWER = {"text": {"en": "It stays wrong", "zh": "一直不对"}, "right_if": [{"measure": "settled", "none": True}]}
_SETTLED = {"kind": "settles", "column": "copy.x.h1", "to": "x.h1", "within": 1.0}
_SENT = {"type": "array", "items": {"type": "object"}, "description": "Commands of a live session, without ids."}
Commands = Annotated[tuple[BatchMember, ...], Field(max_length=10), WithJsonSchema(_SENT, mode="serialization")]


class StepStart(Strict):
    """The session with which a step begins: a new one of an experiment of the lesson, paused at a time."""

    model_config = example(experiment="alone", t=60.0)

    experiment: Identifier
    t: Instant = Field(default=0, description="Time in s at which it is paused.")


class LevelLine(Strict):
    """A level that is drawn on a strip, above zero and below."""

    model_config = example(strip="residual.y", at=0.075)

    strip: ColumnName
    at: Positive = Field(description="Its distance from zero, in the unit of the strip.")


class StepView(Strict):
    """What of the session a step shows."""

    model_config = example(strips=["x.h1", "residual.y"], picture="copy")

    strips: tuple[ColumnName, ...] = Field(default=(), max_length=4, description="Names of strips, from the top.")
    picture: Literal["plant", "copy", "hysteresis", "none"] = Field(
        default="plant",
        description="copy: the plant and the observer beside it, with their levels; hysteresis: its loop and gaps.",
    )
    truth: bool = Field(default=True, strict=True, description="Whether true states and faults are visible.")
    diagnosis: bool = Field(default=False, strict=True, description="Whether the detector's findings are visible.")
    line: LevelLine | None = Field(default=None, description="A level on one of the strips.")


class Answer(Strict):
    """One of the answers to a step's question. It is right where its conditions hold in the student's session."""

    model_config = example(**_ANSWER)

    text: Words
    site: Reference | None = Field(
        default=None,
        description="A channel or an output: the answer is given by pointing at its place in the plant's picture.",
    )
    right_if: tuple[Condition, ...] = Field(min_length=1, max_length=4)


class Choice(Strict):
    """A button that does something to the session, then runs it."""

    model_config = example(
        text={"en": "Break the sensor", "zh": "让传感器出错"},
        do=[{"type": "inject", "fault": {"channel": "bias", "shape": "step", "onset": 0, "size": 1}}],
    )

    text: Words
    do: Commands = ()


class Dial(Strict):
    """A slider for a gain of an observer, or for a level that is drawn on a strip and used by measures."""

    model_config = example(
        text={"en": "Gain", "zh": "增益"},
        observer="copy",
        gain="rho",
        low=0.02,
        high=2.0,
        value=0.1,
        solution=0.5,
        unit="1/s",
    )

    text: Words
    observer: Reference | None = Field(default=None, description="The observer whose gain it is; null: a level.")
    gain: Reference | None = None
    strip: ColumnName | None = Field(default=None, description="The strip on which the level is drawn.")
    low: Positive = Field(description="The least value.")
    high: Positive = Field(description="The greatest value.")
    value: Positive = Field(description="The value at the beginning, which does not meet the step's conditions.")
    solution: Positive = Field(description="A value that meets them.")
    unit: str = Field(default="", max_length=20)

    @model_validator(mode="after")
    def _sets_one_thing(self) -> Self:
        if (self.strip is None) == (self.observer is None) or (self.observer is None) != (self.gain is None):
            raise refuse("course.dial.sets", field="strip", value=self.strip)
        return self


class Sketch(Strict):
    """A curve that the student draws on a strip, from the beginning of the step to its end, before it runs.

    Measures read it as the column `sketch`.
    """

    model_config = example(strip="residual.y", low=-0.8, high=0.4, value=0.0, solution=[0.0, -0.5, -0.4, -0.3, -0.3])

    strip: ColumnName
    low: Number = Field(description="The least value that can be drawn, in the unit of the strip.")
    high: Number = Field(description="The greatest value that can be drawn.")
    value: Number = Field(
        default=0, description="The level line from which the drawing begins; it does not meet the step's conditions."
    )
    solution: Drawn = Field(description="A curve that meets them. The student draws as many values.")

    @model_validator(mode="after")
    def _lies_within(self) -> Self:
        for value in (self.value, *self.solution):
            if not self.low <= value <= self.high:
                raise refuse("course.sketch.beyond", field="value", value=value, low=self.low, high=self.high)
        return self


class StepRun(Strict):
    """What the button of a step does: commands, then time."""

    model_config = example(text={"en": "Run it and see", "zh": "运行看看"}, seconds=60.0)

    text: Words | None = None
    seconds: Positive = Field(description="Time of the session in s that passes.")
    do: Commands = ()


class Saw(Strict):
    """A sentence on what happened, shown where its conditions hold; {name} is a measured number."""

    model_config = example(
        text={"en": "It came within 1 cm in {settled} s.", "zh": "{settled} s 后误差小于 1 cm。"},
        when=[{"measure": "settled", "at_least": 0.0}],
    )

    text: Words
    when: tuple[Condition, ...] = Field(default=(), max_length=4)


class CourseStep(Strict):
    """One step of a lesson: one idea, one question."""

    model_config = example(
        title=_HEADING,
        say=[{"en": "The upper tank has no sensor.", "zh": "上水箱没有传感器。"}],
        start={"experiment": "alone", "t": 60.0},
        ask={"en": "What will its level do?", "zh": "它的水位会怎样？"},
        answers=[_ANSWER],
        run={"seconds": 60.0},
        measures={"settled": _SETTLED},
    )

    title: Words
    say: tuple[Words, ...] = Field(min_length=1, max_length=4, description="Paragraphs; **bold**.")
    short: Words | None = Field(default=None, description="Fewer words, for the projector.")
    start: StepStart | None = Field(
        default=None, description="None: the session of the step before stays; such a step runs nothing."
    )
    show: StepView = StepView()
    ask: Words | None = None
    answers: tuple[Answer, ...] = Field(default=(), max_length=8)
    choices: tuple[Choice, ...] = Field(default=(), max_length=4)
    dial: Dial | None = None
    sketch: Sketch | None = None
    right_if: tuple[Condition, ...] = Field(
        default=(), max_length=6, description="Of a step with choices, a dial or a sketch."
    )
    run: StepRun | None = None
    measures: dict[Reference, Measure] = Field(default_factory=dict, max_length=8)
    saw: tuple[Saw, ...] = Field(default=(), max_length=4, description="The first whose conditions hold is shown.")
    look: Words | None = Field(default=None, description="Where to look first after a wrong answer.")
    why: tuple[Words, ...] = Field(default=(), max_length=3)
    cause: Words | None = Field(default=None, description="The cause in large type, where an observer diverges.")

    @model_validator(mode="after")
    def _measures_are_known(self) -> Self:
        answers = [condition for answer in self.answers for condition in answer.right_if]
        for condition in (*answers, *self.right_if, *(c for saw in self.saw for c in saw.when)):
            if condition.measure not in self.measures:
                hint = suggestion(condition.measure, self.measures)
                raise refuse("course.measure.unknown", field="measures", value=condition.measure, remedy=hint)
        sites = [answer.site for answer in self.answers if answer.site is not None]
        if sites and (len(set(sites)) < len(self.answers) or self.show.picture != "plant"):
            raise refuse("course.sites", field="answers", value=sites)
        if self.run is None and (self.answers or self.choices or self.dial or self.sketch):
            raise refuse("course.step.runs-nothing", field="run", value=None)
        if self.run is not None and self.start is None:
            raise refuse("course.step.starts-nowhere", field="start", value=None)
        return self


class CourseLesson(Strict):
    """A lesson: experiments, and steps that run them."""

    model_config = example(
        id="what-you-cannot-see",
        number=1,
        minutes=9,
        title={"en": "What you cannot see", "zh": "看不见的水位"},
        outcome={"en": "Say how a copy of a plant finds a level.", "zh": "说明副本如何找到水位。"},
        experiments={"alone": {"plant": "two-tanks", "horizon": 120.0, "step": 0.1}},
        steps=[
            {
                "title": _HEADING,
                "say": [{"en": "Two tanks.", "zh": "两个水箱。"}],
                "start": {"experiment": "alone"},
            }
        ],
    )

    id: Identifier
    number: int = Field(default=0, ge=0, le=99, strict=True, description="Its place in the course; 0: none.")
    minutes: int = Field(ge=1, le=60, strict=True)
    title: Words
    outcome: Words = Field(description="What one can do afterwards.")
    experiments: dict[Identifier, Experiment] = Field(min_length=1, max_length=8)
    steps: tuple[CourseStep, ...] = Field(min_length=1, max_length=12)

    @model_validator(mode="after")
    def _starts_are_known(self) -> Self:
        if self.steps[0].start is None:
            raise refuse("course.start.missing", field="steps", value=self.id)
        for step in self.steps:
            if step.start is not None and step.start.experiment not in self.experiments:
                hint = suggestion(step.start.experiment, self.experiments)
                raise refuse("course.start.unknown", field="steps", value=step.start.experiment, remedy=hint)
        return self
