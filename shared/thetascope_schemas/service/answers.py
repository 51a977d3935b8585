"""Answers of the REST interface other than specs and runs: lists, forms, equations, sessions.

The routes build these answers as plain data. The models document them in OpenAPI, and the types of the page are
generated from there (`tools/page_types.py`). A test validates the real answers against the models.
"""

from typing import Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Number, Strict
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.learning.questions import Words

TimeKind = Literal["continuous", "discrete"]


class PlantLine(Strict):
    """A plant in a list."""

    id: str
    title: str
    description: str
    source: str
    time: TimeKind
    states: int
    outputs: int
    channels: tuple[str, ...] = Field(description="Names of the fault channels.")
    href: str


class PlantList(Strict):
    """The plants of the library."""

    plants: tuple[PlantLine, ...]


class ExperimentLine(Strict):
    """An experiment in a list."""

    id: str
    title: str
    description: str
    source: str
    plant: str = Field(description="Id of the plant.")
    horizon: Number
    step: Number
    observers: tuple[str, ...] = Field(description="Labels of the observers.")
    href: str


class ExperimentList(Strict):
    """The experiments of the library."""

    experiments: tuple[ExperimentLine, ...]


class RecordLine(Strict):
    """A record in a list."""

    id: str
    name: str
    size: int = Field(description="Bytes of the file.")
    changed: Number = Field(description="Seconds since 1970 of the last change of its plant or mapping.")
    links: dict[str, str]


class RecordList(Strict):
    """The records of a client."""

    records: tuple[RecordLine, ...]


class GainForm(Strict):
    """A gain of an observer: its meaning, default and bounds."""

    name: str
    meaning: str
    default: Number | tuple[Number, ...] | None = Field(
        description="Default; null: it depends on the plant and its noise."
    )
    low: Number | None = Field(description="Smallest permitted value; null: no bound.")
    high: Number | None = Field(description="Largest permitted value; null: no bound.")
    positive: bool = Field(description="Whether every value must be greater than 0.")
    size: str | None = Field(
        description="Length of a column, or number of rows of a matrix (n, m, p, …); null for a number."
    )
    columns: str | None = Field(
        None, description="Number of columns of a matrix (n, m, p, …); null for a number or a column."
    )
    symbol: str
    unit: str
    live: bool = Field(description="Whether a change during a run has an effect.")


class OptionForm(Strict):
    """A structural option of an observer: another value gives other equations."""

    name: str
    meaning: str
    kind: str
    default: JsonValue
    choices: tuple[str, ...]
    low: int
    high: int


class ObserverKind(Strict):
    """A kind of observer with its gains and options."""

    id: str
    title: str
    source: str
    summary: str
    when: str = Field(description="When to take it: the end of a sentence.")
    time: str
    estimates_theta: bool
    takes_channels: bool = Field(description="Whether faults of the plant can be chosen for it.")
    residuals: bool = Field(description="Whether it has residuals that name a fault; above 1 is an alarm.")
    chooses: bool = Field(
        description="Whether it takes, by default, only the faults of a plant that it can tell apart."
    )
    gains: tuple[GainForm, ...]
    options: tuple[OptionForm, ...]


class FormField(Strict):
    """A field of a fault or signal, described for a form."""

    name: str
    type: str = Field(description="JSON type, or choice.")
    required: bool
    nullable: bool
    description: str
    default: JsonValue = None
    minimum: Number | None = None
    above: Number | None = Field(default=None, description="Exclusive lower bound.")
    maximum: Number | None = None
    choices: tuple[str, ...] | None = None


class FaultForm(Strict):
    """A fault shape with its fields."""

    shape: str
    on: Literal["channel", "output"]
    description: str
    fields: tuple[FormField, ...]
    example: dict[str, JsonValue]


class SignalForm(Strict):
    """A kind of signal with its fields."""

    kind: str
    description: str
    fields: tuple[FormField, ...]
    example: dict[str, JsonValue]


class Catalogue(Strict):
    """Plants, experiments, kinds of observers, and the forms of faults and signals."""

    plants: tuple[PlantLine, ...]
    experiments: tuple[ExperimentLine, ...]
    observers: tuple[ObserverKind, ...]
    faults: tuple[FaultForm, ...]
    signals: tuple[SignalForm, ...]


class EquationChannel(Strict):
    """A fault channel in the equations of a plant."""

    name: str
    title: str
    kind: str
    unit: str


class EquationLine(Strict):
    """One equation of a plant as MathML."""

    name: str
    unit: str
    description: str
    math: str


class PlantEquations(Strict):
    """The equations of a plant, with its faults."""

    id: str
    title: str
    source: str
    time: TimeKind
    channels: tuple[EquationChannel, ...]
    states: tuple[EquationLine, ...]
    definitions: tuple[EquationLine, ...]
    outputs: tuple[EquationLine, ...]
    controllers: tuple[EquationLine, ...]


class NumberedEquation(Strict):
    """One equation of an observer as MathML, with its number in the paper."""

    number: str
    math: str


class WhereLine(Strict):
    """A symbol of an observer's equations and its meaning."""

    math: str
    text: str


class ObserverEquations(Strict):
    """The equations of one kind of observer."""

    title: str
    source: str
    equations: tuple[NumberedEquation, ...]
    where: tuple[WhereLine, ...]


class Equations(Strict):
    """The equations of a plant and of kinds of observers."""

    plant: PlantEquations
    observers: dict[str, ObserverEquations]


class PlantSizes(Strict):
    """Dimensions of a plant."""

    states: int
    inputs: int
    outputs: int
    channels: int


class StructuralGroup(Strict):
    """Faults and states that no input distinguishes."""

    channels: tuple[str, ...]
    states: tuple[str, ...]
    text: str


class StructuralObservability(Strict):
    """The structural rank of states and faults."""

    decided: bool
    rank: int | None
    size: int
    state_rank: int | None
    states: int
    not_identifiable: tuple[str, ...]
    groups: tuple[StructuralGroup, ...]
    text: str


class PossibleObserver(Strict):
    """Whether a kind of observer can be built for a plant, and the reason if not."""

    kind: str
    title: str
    possible: bool
    why: str


class PlantCheck(Strict):
    """The result of checking a plant."""

    id: str
    valid: Literal[True]
    time: TimeKind
    sizes: PlantSizes
    channels: tuple[str, ...]
    Phi: tuple[tuple[str, ...], ...]
    Psi: tuple[tuple[str, ...], ...]
    affine: dict[str, bool]
    observability: StructuralObservability
    observers: tuple[PossibleObserver, ...]


class GainLabels(Strict):
    """Labels of a gain that is a column or a matrix."""

    rows: tuple[str, ...] = Field(description="Labels of the rows: states, outputs, channels or coordinates.")
    columns: tuple[str, ...] = Field((), description="Labels of the columns; empty for a column gain.")


class PresentGains(Strict):
    """Every gain of every observer of an experiment, by label and name."""

    gains: dict[str, dict[str, Number | tuple[Number, ...] | tuple[tuple[Number, ...], ...]]]
    labels: dict[str, dict[str, GainLabels]] = Field(
        default_factory=dict, description="Labels of gains that are columns or matrices, by observer and gain."
    )


class FigureLine(Strict):
    """A figure of a run."""

    name: str
    title: str
    href: str


class FigureList(Strict):
    """The figures of a run."""

    figures: tuple[FigureLine, ...]


class PlotlyFigure(Strict):
    """One figure as Plotly's JSON, its arrays as base64."""

    data: tuple[dict[str, JsonValue], ...]
    layout: dict[str, JsonValue]


class SessionOpened(Strict):
    """A new session. The token grants control."""

    id: str
    token: str
    parent: str | None
    links: dict[str, str]


class SessionState(Strict):
    """The state of a session, and its experiment with all faults and timed commands up to now."""

    id: str
    spec: Experiment
    row: int
    t: Number
    playing: bool
    speed: Number | None
    viewers: int
    ended: bool
    parent: str | None
    links: dict[str, str]


class LessonQuestion(Strict):
    """A question, and the commands of a live session that show its answer, without ids."""

    question: Words
    do: tuple[dict[str, JsonValue], ...]


class LessonPlan(Strict):
    """The questions of the lesson about one experiment."""

    id: str
    questions: tuple[LessonQuestion, ...]


class LessonList(Strict):
    """All lessons."""

    lessons: tuple[LessonPlan, ...]


class CourseLine(Strict):
    """A lesson of the course without its steps."""

    id: str
    number: int
    minutes: int
    title: Words
    outcome: Words
    steps: int


class CourseList(Strict):
    """The lessons of the course in their order."""

    lessons: tuple[CourseLine, ...]
