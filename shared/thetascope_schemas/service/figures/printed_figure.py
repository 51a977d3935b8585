"""A figure for print: its options, and its description."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import MAX_TIME, Strict, example
from thetascope_schemas.texts.refusal import refuse

PrintFormat = Literal["pdf", "svg", "png", "tex", "json"]
LineLook = Literal[
    "line", "dashes", "dash-dot", "dots", "thin-grey", "long-dashes", "dash-dot-dot", "thick-grey", "grey-dashes",
    "grey-dash-dot",
]  # fmt: skip
Key = Annotated[str, Field(min_length=1, max_length=200)]
Seconds = Annotated[float, Field(ge=0, le=MAX_TIME)]


class PrintSettings(Strict):
    """The options of a figure for print. Curves and panels are named as in its description, format `json`."""

    model_config = example(format="pdf", width=8.5, font="times", size=8, colour="grey", legend="inside")

    format: PrintFormat = Field(
        default="pdf", description="pdf, svg, png (600 dpi), tex (TikZ with its data), or json: the description."
    )
    width: float = Field(default=8.5, ge=3, le=21, description="Width in cm.")
    height: float | None = Field(default=None, ge=2, le=29.7, description="Height in cm; by default by the panels.")
    font: Literal["times", "sans", "serif"] = Field(
        default="times", description="times: STIX, which fits Times; sans: DejaVu Sans; serif: DejaVu Serif."
    )
    size: float = Field(default=8, ge=4, le=16, description="Size of the type in pt.")
    colour: Literal["colour", "grey", "black"] = Field(
        default="grey", description="Line styles differ in each; grey and black do without colours."
    )
    legend: Literal["inside", "above", "none"] = "inside"
    start: Seconds | None = Field(default=None, description="First time in s.")
    end: Seconds | None = Field(default=None, description="Last time in s.")
    curves: tuple[Key, ...] = Field(default=(), max_length=40, description="Keys of the curves to draw; default: all.")
    panels: tuple[Annotated[int, Field(ge=1, le=200)], ...] = Field(
        default=(), max_length=40, description="Numbers of the panels to draw, the first is 1; default: all."
    )
    styles: tuple[Annotated[str, Field(pattern=r"^.{1,200}=[a-z-]{1,20}$")], ...] = Field(
        default=(), max_length=40, description="Line styles as curve=style, for example adaptive=dash-dot."
    )
    lang: str | None = Field(
        default=None, max_length=35, description="Language of the words in the figure, en or zh; default: en."
    )

    @model_validator(mode="after")
    def _span(self) -> Self:
        if self.start is not None and self.end is not None and self.start >= self.end:
            raise refuse("print.span", "end", self.end, start=self.start, end=self.end)
        return self


class OverlaidPrintSettings(PrintSettings):
    """The options of the curves of several runs for print."""

    model_config = example(ids="bd47ec8d7cf57768,edb759b816289dd0", format="pdf", width=8.5)

    ids: str = Field(max_length=400, description="Ids of two to six runs, separated by commas.")
    observer: str | None = Field(default=None, max_length=40, description="Label of the observer; default: the first.")
    less: bool = Field(default=False, description="Whether curves are the differences from the first run.")


class PrintedCurve(Strict):
    """One curve that the figure can show: the same quantity of the same observer in all panels."""

    key: str
    label: str = Field(description="Text of the legend.")
    style: LineLook
    drawn: bool


class PrintedPanel(Strict):
    """One panel that the figure can show."""

    number: int
    label: str
    drawn: bool


class PrintedFigure(Strict):
    """The description of a figure for print."""

    title: str
    caption: str = Field(description="A caption with the id of the run.")
    command: str = Field(description="The command that draws the figure again.")
    filename: str
    width: float = Field(description="Width in cm.")
    height: float = Field(description="Height in cm.")
    curves: tuple[PrintedCurve, ...]
    panels: tuple[PrintedPanel, ...]
    styles: tuple[LineLook, ...] = Field(description="All line styles.")
    type_size: float = Field(description="Size of the type in pt.")
    thinnest: float = Field(description="Width of the thinnest line in pt.")
    apart: bool = Field(description="Whether all curves differ without colour.")
    span: tuple[float, float] = Field(description="First and last time of the run in s.")
